pub(crate) mod simd;
