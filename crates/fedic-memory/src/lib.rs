//! Cache-line-aligned buffers, backed by huge pages when large, the memory that is left, and prefetch hints.

mod aligned_buffer;
mod available;
mod prefetch;

pub use aligned_buffer::AlignedBuffer;
pub use available::is_available;
pub use bytemuck::Pod;
pub use prefetch::prefetch;

/// Bytes in a cache line.
pub const CACHE_LINE: usize = 64;
