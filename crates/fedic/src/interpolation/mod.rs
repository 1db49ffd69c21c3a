pub(crate) mod cell_prefetch;
pub(crate) mod image_sampler;
