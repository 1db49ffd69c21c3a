//! Penalty on the equilibrium gap: the internal forces of linear elasticity where no load acts.
//!
//! `K` is the stiffness matrix of the mesh, whose rows give the internal forces `K U` at the nodes. The penalty is the sum of their
//! squares, each divided by the area that its node stands for, over the nodes at which no load acts: `R = K^T D K` with `D = 1 / area`
//! there and zero elsewhere. It is close to the integral of the squared force per area, whatever the size of the cells.
//!
//! Source: F. Hild, S. Roux, "Comparison of local and global approaches to digital image correlation", Exp. Mech. 52 (2012), with other
//! weights of the nodes. Fields in equilibrium cost nothing. The forces are those of small strains: the displacement is taken in axes
//! that turn with the mean rotation, see [`Penalty`](super::penalty::Penalty).

mod rows;
mod stiffness;

use fedic_camera::Camera;
use fedic_sparse::SymmetricMatrix;

use self::rows::ForceRows;
use super::halved_waves::{Energies, HalvedWaves, PenalisedWaves, Polarization};
use crate::equations::dofs::Dofs;
use crate::parallel::for_each_in_order;
use crate::{Error, Monitor, OptionError, PLANE};

/// Matrix of the squared internal forces, and what shear waves cost.
#[derive(Debug, Clone)]
pub(crate) struct Gap {
    /// `R`.
    pub(crate) matrix: SymmetricMatrix,
    /// For each node, whether its internal force is penalised.
    pub(crate) penalised: Vec<bool>,
    pub(crate) waves: PenalisedWaves,
}

impl Gap {
    /// Assembles the matrix on the pattern of `dofs`, whose stars must be coupled, for shear waves of `length` pixels as the camera sees
    /// them.
    ///
    /// # Errors
    ///
    /// [`OptionError::Invalid`] if a free node is not at the boundary, no node is left at which no load acts, a cell is parallel to `z`,
    /// or the length is too long for the mesh; [`Error::Cancelled`] if `monitor` asks to stop.
    pub(crate) fn new(
        dofs: &Dofs<PLANE>,
        camera: &dyn Camera,
        gap: &crate::EquilibriumGap,
        length: f64,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let (mesh, pattern) = (&dofs.mesh, &dofs.pattern);
        let boundary = mesh.boundary_nodes();
        let penalised = without_load(dofs, &boundary, &gap.free_nodes)?;
        let rows = ForceRows::new(dofs, gap.law.stiffness(), monitor)?;
        let waves = HalvedWaves::new(dofs, camera, length, Polarization::Shear)?;
        let fields = waves.fields::<PLANE>();
        let mut matrix = SymmetricMatrix::zeros(pattern);
        let (mut energies, mut area) = (Energies::default(), 0.0);
        for_each_in_order(
            0..mesh.num_nodes(),
            monitor,
            |(): &mut (), _, node| {
                let entries = penalised[node].then(|| rows.squared(node));
                (entries, fields.each_ref().map(|fields| rows.mean_square(node, fields)))
            },
            |node, (entries, of_node)| {
                area += rows.area(node);
                if let Some(entries) = entries {
                    matrix.add_cell(pattern, mesh.num_cells() + node, &entries);
                    energies.add(rows.area(node), of_node, !boundary[node]);
                }
            },
        )?;
        let energies = energies.over(area);
        Ok(Self { matrix, penalised, waves: waves.costing(energies) })
    }
}

/// For each node, whether no load acts on it: nodes inside the mesh, and those of the boundary that are free.
fn without_load(dofs: &Dofs<PLANE>, boundary: &[bool], free_nodes: &[usize]) -> Result<Vec<bool>, OptionError> {
    let mut free = vec![false; dofs.num_user_nodes()];
    for &node in free_nodes {
        let refuse = || OptionError::invalid("free", "nodes of the mesh", &format!("node {node}"));
        *free.get_mut(node).ok_or_else(refuse)? = true;
    }
    let mut without_load = dofs.restrict_by(&free);
    if let Some(inside) = (0..boundary.len()).find(|&node| without_load[node] && !boundary[node]) {
        let node = dofs.user_nodes(vec![inside]);
        return Err(OptionError::invalid("free", "nodes of the boundary", &format!("node {}", node[0])));
    }
    without_load.iter_mut().zip(boundary).for_each(|(without_load, boundary)| *without_load |= !boundary);
    if without_load.contains(&true) {
        return Ok(without_load);
    }
    let expected = "a mesh with nodes inside it, or edges that are named as free, for the equilibrium gap";
    Err(OptionError::invalid("regularization", expected, &"a mesh all of whose nodes may be loaded"))
}

#[cfg(test)]
mod tests;
