pub(crate) mod level;
pub(crate) mod photometry;
pub(crate) mod quantized_gradient;
pub(crate) mod reference_pass;
pub(crate) mod reference_samples;
pub(crate) mod workspace;
