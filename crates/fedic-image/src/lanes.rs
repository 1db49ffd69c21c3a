//! Points side by side: one number of each of the points of a block.

/// Points per block: enough to amortise each step over a block, few enough for the level 1 cache.
pub(crate) const BLOCK: usize = 32;

/// One number per point of a block.
pub(crate) type Lane = [f32; BLOCK];

/// An instruction set.
pub(crate) trait Fusing: Copy {
    /// Whether products and sums are rounded together.
    const FUSED: bool;
}

/// Any processor.
impl Fusing for pulp::Scalar {
    const FUSED: bool = false;
}

#[cfg(target_arch = "x86_64")]
impl Fusing for pulp::x86::V3 {
    const FUSED: bool = true;
}

/// `a b + c`, with one rounding where the processor has an instruction for it.
#[inline(always)]
pub(crate) fn fused<S: Fusing>(a: f32, b: f32, c: f32) -> f32 {
    if S::FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// Lanes that begin where a cache line does: no vector of them lies across two lines.
#[repr(align(64))]
pub(crate) struct Aligned<T>(pub(crate) T);
