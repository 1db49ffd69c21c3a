//! What depends on the mesh alone: its nodes, the pattern of the system and the symbolic factorisation.

use std::sync::OnceLock;

use fedic_mesh::Mesh;
use fedic_sparse::{Cholesky, Factor, Pattern, SparseError, SymmetricMatrix};

use crate::equations::tikhonov::Laplacian;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::{COMPONENTS, SolveError};

/// The mesh without unused nodes, and its system.
#[derive(Debug, Clone)]
pub(crate) struct System {
    pub(crate) mesh: Mesh,
    pub(crate) pattern: Pattern,
    cholesky: Cholesky,
    /// Index in the user's mesh of each node kept.
    kept: Vec<u32>,
    num_user_nodes: usize,
    laplacian: OnceLock<Laplacian>,
}

impl System {
    pub(crate) fn new(user_mesh: &Mesh) -> Result<Self, SolveError> {
        let (mesh, kept) = user_mesh.compact();
        let pattern = Pattern::new(mesh.num_nodes(), COMPONENTS, mesh.cells().map(|cell| cell.nodes));
        let cholesky = Cholesky::of_mesh(&pattern, mesh.points())
            .map_err(|_| SolveError::TooLarge { dofs: pattern.num_dofs() })?;
        Ok(Self { mesh, pattern, cholesky, kept, num_user_nodes: user_mesh.num_nodes(), laplacian: OnceLock::new() })
    }

    /// The matrix that smooths the displacement, assembled when first needed.
    pub(crate) fn laplacian(&self) -> &Laplacian {
        self.laplacian.get_or_init(|| Laplacian::new(&self.mesh, &self.pattern))
    }

    /// Adds what the nodes of a cell receive to a vector of all unknowns.
    pub(crate) fn add_to_nodes(&self, cell: usize, sums: &[[f64; COMPONENTS]], vector: &mut [f64]) {
        let nodes = vector.as_chunks_mut::<COMPONENTS>().0;
        for (&node, sums) in self.pattern.cell(cell).iter().zip(sums) {
            nodes[node as usize].iter_mut().zip(sums).for_each(|(b, sum)| *b += sum);
        }
    }

    /// Factorises a Hessian, `compact` if the factor is to be kept and to be small; where it is singular, names the nodes.
    pub(crate) fn factorize(
        &self,
        matrix: &SymmetricMatrix,
        compact: bool,
        quadrature: &CellQuadrature,
    ) -> Result<Factor, SolveError> {
        let factor = if compact { self.cholesky.factorize_compact(matrix) } else { self.cholesky.factorize(matrix) };
        factor.map_err(|error| {
            let dofs = match error {
                SparseError::Singular { dofs } => dofs,
                SparseError::NonFinite => (0..self.pattern.num_dofs()).collect(),
                SparseError::TooLarge { dofs } => return SolveError::TooLarge { dofs },
            };
            let mut nodes: Vec<usize> = dofs.into_iter().map(|dof| dof / COMPONENTS).collect();
            nodes.dedup();
            self.undetermined(nodes, quadrature)
        })
    }

    /// Refuses a mesh with nodes all of whose cells are flat; `is_flat` says so of each cell.
    pub(crate) fn check_texture(&self, is_flat: &[bool], quadrature: &CellQuadrature) -> Result<(), SolveError> {
        let mut textured = vec![false; self.mesh.num_nodes()];
        for (cell, &flat) in self.mesh.cells().zip(is_flat) {
            if !flat {
                cell.nodes.iter().for_each(|&node| textured[node as usize] = true);
            }
        }
        let nodes: Vec<usize> = (0..textured.len()).filter(|&node| !textured[node]).collect();
        if nodes.is_empty() { Ok(()) } else { Err(self.undetermined(nodes, quadrature)) }
    }

    /// The error that names nodes (increasing) and the poorest of their cells.
    fn undetermined(&self, nodes: Vec<usize>, quadrature: &CellQuadrature) -> SolveError {
        let touches =
            |cell: usize| self.mesh.cell(cell).nodes.iter().any(|&node| nodes.binary_search(&(node as usize)).is_ok());
        let poorest = (0..self.mesh.num_cells())
            .filter(|&cell| touches(cell))
            .min_by_key(|&cell| quadrature.range(cell).len())
            .unwrap_or_default();
        SolveError::Singular {
            points: quadrature.range(poorest).len(),
            unknowns: self.mesh.cell(poorest).nodes.len() * COMPONENTS,
            nodes: self.user_nodes(nodes),
        }
    }

    /// Indices in the user's mesh of nodes of this one.
    pub(crate) fn user_nodes(&self, nodes: Vec<usize>) -> Vec<usize> {
        nodes.into_iter().map(|node| self.kept[node] as usize).collect()
    }

    /// A field on the user's nodes, restricted to those a cell uses.
    pub(crate) fn restrict(&self, field: &[[f64; COMPONENTS]]) -> Result<Vec<[f64; COMPONENTS]>, SolveError> {
        let refuse = |found| Err(SolveError::InvalidStart { expected: self.num_user_nodes, found });
        if field.len() != self.num_user_nodes {
            return refuse(format!("{} entries were given", field.len()));
        }
        let kept: Vec<_> = self.kept.iter().map(|&node| field[node as usize]).collect();
        match kept.iter().position(|u| !u.iter().all(|c| c.is_finite())) {
            Some(node) => refuse(format!("that of node {} is not finite", self.kept[node])),
            None => Ok(kept),
        }
    }

    /// A field on the used nodes, extended by NaN to the user's others.
    pub(crate) fn extend(&self, field: &[[f64; COMPONENTS]]) -> Vec<[f64; COMPONENTS]> {
        let mut all = vec![[f64::NAN; COMPONENTS]; self.num_user_nodes];
        for (&node, value) in self.kept.iter().zip(field) {
            all[node as usize] = *value;
        }
        all
    }
}
