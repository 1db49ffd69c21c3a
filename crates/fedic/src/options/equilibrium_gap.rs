//! Settings of a regularization by the equilibrium gap.

use super::elasticity::PlaneStress;

/// Regularization by the equilibrium gap: internal forces of linear elasticity are small where no load acts.
///
/// No load acts at nodes inside the mesh, nor at the nodes of free edges that are named here. All other nodes of the boundary may be
/// loaded: the displacement along them is not regularized. The length is given by
/// [`Options::regularization_length`](crate::Options).
///
/// # Examples
///
/// ```
/// use fedic::{EquilibriumGap, PlaneStress};
///
/// let gap = EquilibriumGap { law: PlaneStress::isotropic(0.3)?, free_nodes: vec![3, 4, 5] };
/// # Ok::<(), fedic::OptionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct EquilibriumGap {
    /// Law of the material.
    pub law: PlaneStress,
    /// Nodes of the boundary at which no load acts.
    pub free_nodes: Vec<usize>,
}
