//! Blocks of points in structure-of-arrays layout, and fused multiply-add.

/// Points per block: enough to amortise each step over a block, few enough for the level 1 cache.
pub(crate) const BLOCK: usize = 32;

/// One number per point of a block.
pub(crate) type Lane = [f32; BLOCK];

/// An instruction set, with or without a fused multiply-add.
pub(crate) trait Fusing: Copy {
    /// True if a product and a sum are rounded together.
    const FUSED: bool;
}

/// Portable code.
impl Fusing for pulp::Scalar {
    const FUSED: bool = false;
}

#[cfg(target_arch = "x86_64")]
impl Fusing for pulp::x86::V3 {
    const FUSED: bool = true;
}

/// `a b + c`, with one rounding if the processor has an instruction for it.
#[inline(always)]
pub(crate) fn fused<S: Fusing>(a: f32, b: f32, c: f32) -> f32 {
    if S::FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// Aligned to a cache line, so that no vector of its lanes straddles two lines.
#[repr(align(64))]
pub(crate) struct Aligned<T>(pub(crate) T);
