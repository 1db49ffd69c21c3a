//! Cache-line-aligned buffers, backed by huge pages when large, and prefetch hints.

mod aligned_buffer;
mod prefetch;

pub use aligned_buffer::AlignedBuffer;
pub use bytemuck::Pod;
pub use prefetch::prefetch;

/// Bytes in a cache line.
pub const CACHE_LINE: usize = 64;
