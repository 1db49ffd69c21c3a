pub(crate) mod covariance;
pub(crate) mod residual_map;
pub(crate) mod solution;
