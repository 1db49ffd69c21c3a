//! Modes of a reduced basis: displacement fields of unit parameters.

/// Displacement fields that depend on a few parameters.
pub(crate) trait Modes<const D: usize>: Sync {
    /// Number of parameters.
    fn len(&self) -> usize;

    /// Prepares the modes for a step from this displacement. Modes that are linear in the parameters need nothing.
    fn linearize(&mut self, _displacement: &[[f64; D]]) {}

    /// Component `component` of the displacement of `node` for a unit value of `parameter`.
    fn value(&self, node: usize, component: usize, parameter: usize) -> f64;

    /// Increment of the displacement of `node` for a step of the parameters: the linear combination of the modes, unless the field
    /// is nonlinear in them.
    fn increment(&self, node: usize, step: &[f64]) -> [f64; D] {
        let mut increment = [0.0; D];
        for (parameter, step) in step.iter().enumerate() {
            (0..D).for_each(|c| increment[c] += step * self.value(node, c, parameter));
        }
        increment
    }
}
