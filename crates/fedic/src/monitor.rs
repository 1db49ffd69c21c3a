//! The caller's view of a running correlation: how far it is, and the way to stop it.

/// What a correlation is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Preparing the reference image: interpolation, quadrature points, Hessian.
    Prepare,
    /// An iteration on a reduced image of the pyramid.
    Pyramid,
    /// An iteration on the images at full resolution.
    Solve,
}

/// A step of a correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What has just been done.
    pub stage: Stage,
    /// Level of the pyramid, 0 for the full resolution.
    pub level: usize,
    /// Iteration on that level, from 1; 0 while preparing.
    pub iteration: usize,
    /// Largest nodal correction in pixels of the full resolution.
    pub correction: f64,
    /// Standard deviation of the residual in grey levels.
    pub residual_rms: f64,
}

/// Told of every iteration, and asked many times a second whether to go on.
pub trait Monitor: Sync {
    /// Called after each iteration.
    fn progress(&self, _progress: &Progress) {}

    /// Whether to stop as soon as possible.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Watches nothing and never stops.
impl Monitor for () {}
