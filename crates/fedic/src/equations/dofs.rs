//! Nodal unknowns of a mesh: sparsity pattern, symbolic factorisation, and the map to the nodes of the user's mesh.

use std::collections::BTreeSet;

use fedic_mesh::Mesh;
use fedic_sparse::{Cholesky, Factor, Pattern, SparseError, SpdSolver, SymmetricMatrix};

use crate::equations::patches::{Patch, parts, patches};
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::{Error, SolveError};

/// The mesh without unused nodes, collapsed quadrilaterals being triangles, and its unknowns: `D` at each node.
#[derive(Debug, Clone)]
pub(crate) struct Dofs<const D: usize> {
    pub(crate) mesh: Mesh,
    pub(crate) pattern: Pattern,
    /// Patches of the mesh, if a penalty couples nodes of several cells.
    pub(crate) patches: Vec<Patch>,
    /// Groups of nodes that are coupled, after the cells in the pattern: those of each patch, or the star of each node, which are the
    /// nodes of its cells, increasing.
    pub(crate) groups: Vec<Vec<u32>>,
    cholesky: Cholesky,
    /// Index in the user's mesh of each node kept.
    kept: Vec<u32>,
    num_user_nodes: usize,
}

impl<const D: usize> Dofs<D> {
    /// Orders the unknowns of a mesh and factorises their pattern.
    ///
    /// # Errors
    ///
    /// [`SolveError::TooLarge`] if the factor does not fit in memory.
    pub(crate) fn new(user_mesh: &Mesh) -> Result<Self, SolveError> {
        let (mesh, kept) = user_mesh.collapsed_as_triangles().compact();
        Self::of_compact(mesh, kept, user_mesh.num_nodes(), Vec::new(), Vec::new())
    }

    /// Does what [`new`](Self::new) does, with the nodes of each patch coupled as those of each cell are.
    ///
    /// # Errors
    ///
    /// Those of [`new`](Self::new).
    pub(crate) fn with_patches(user_mesh: &Mesh) -> Result<Self, SolveError> {
        let (mesh, kept) = user_mesh.collapsed_as_triangles().compact();
        let patches = patches(&mesh);
        let groups = patches.iter().map(|patch| patch.nodes.clone()).collect();
        Self::of_compact(mesh, kept, user_mesh.num_nodes(), patches, groups)
    }

    /// Does what [`new`](Self::new) does, with the nodes of the cells around each node coupled as those of each cell are.
    ///
    /// # Errors
    ///
    /// Those of [`new`](Self::new).
    pub(crate) fn with_stars(user_mesh: &Mesh) -> Result<Self, SolveError> {
        let (mesh, kept) = user_mesh.collapsed_as_triangles().compact();
        let (patches, stars) = (patches(&mesh), stars(&mesh));
        Self::of_compact(mesh, kept, user_mesh.num_nodes(), patches, stars)
    }

    fn of_compact(
        mesh: Mesh,
        kept: Vec<u32>,
        num_user_nodes: usize,
        patches: Vec<Patch>,
        groups: Vec<Vec<u32>>,
    ) -> Result<Self, SolveError> {
        let coupled = mesh.cells().map(|cell| cell.nodes).chain(groups.iter().map(Vec::as_slice));
        let pattern = Pattern::new(mesh.num_nodes(), D, coupled);
        let cholesky =
            Cholesky::new(&pattern, mesh.points()).map_err(|_| SolveError::TooLarge { dofs: pattern.num_dofs() })?;
        Ok(Self { mesh, pattern, patches, groups, cholesky, kept, num_user_nodes })
    }

    /// Factorises a Hessian, in single precision if `compact`.
    ///
    /// # Errors
    ///
    /// [`SolveError::Singular`], which names the nodes, or [`SolveError::TooLarge`].
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
                SparseError::TooLarge { dofs } => return SolveError::TooLarge { dofs },
                _ => (0..self.pattern.num_dofs()).collect(),
            };
            let mut nodes: Vec<usize> = dofs.into_iter().map(|dof| dof / D).collect();
            nodes.dedup();
            self.undetermined(nodes, quadrature)
        })
    }

    /// Factorises a matrix that is known to be positive definite.
    ///
    /// # Errors
    ///
    /// [`SolveError::TooLarge`] if the factor does not fit in memory.
    pub(crate) fn factorize_known(&self, matrix: &SymmetricMatrix) -> Result<Factor, SolveError> {
        self.cholesky.factorize(matrix).map_err(|_| SolveError::TooLarge { dofs: self.pattern.num_dofs() })
    }

    /// Refuses a mesh with nodes all of whose cells are flat, as given by `is_flat` for each cell.
    ///
    /// # Errors
    ///
    /// [`SolveError::Singular`], which names the nodes.
    pub(crate) fn check_texture(&self, is_flat: &[bool], quadrature: &CellQuadrature) -> Result<(), SolveError> {
        let textured = self.textured(is_flat);
        let nodes: Vec<usize> = (0..textured.len()).filter(|&node| !textured[node]).collect();
        if nodes.is_empty() { Ok(()) } else { Err(self.undetermined(nodes, quadrature)) }
    }

    /// Refuses a mesh with nodes all of whose cells are flat, as given by `is_flat` for each cell, unless `is_continued` says that a
    /// penalty continues the displacement to the node.
    ///
    /// # Errors
    ///
    /// [`SolveError::FlatEdge`], which names the nodes.
    pub(crate) fn check_texture_of_edges(&self, is_flat: &[bool], is_continued: &[bool]) -> Result<(), SolveError> {
        let textured = self.textured(is_flat);
        let nodes: Vec<usize> = (0..textured.len()).filter(|&node| !textured[node] && !is_continued[node]).collect();
        if nodes.is_empty() { Ok(()) } else { Err(SolveError::FlatEdge { nodes: self.user_nodes(nodes) }) }
    }

    /// Whether each node has a cell that is not flat.
    fn textured(&self, is_flat: &[bool]) -> Vec<bool> {
        let mut textured = vec![false; self.mesh.num_nodes()];
        for (cell, &flat) in self.mesh.cells().zip(is_flat) {
            if !flat {
                cell.nodes.iter().for_each(|&node| textured[node as usize] = true);
            }
        }
        textured
    }

    /// Refuses a mesh with parts, whose cells share no patch, all of whose cells are flat, as given by `is_flat` for each cell.
    ///
    /// # Errors
    ///
    /// [`SolveError::FlatPart`], which names the nodes.
    pub(crate) fn check_texture_of_parts(&self, is_flat: &[bool]) -> Result<(), SolveError> {
        let parts = parts(self.mesh.num_cells(), &self.patches);
        let mut textured = vec![false; self.mesh.num_cells()];
        parts.iter().zip(is_flat).filter(|(_, flat)| !**flat).for_each(|(&part, _)| textured[part] = true);
        let flat = (0..parts.len()).filter(|&cell| !textured[parts[cell]]);
        let nodes: BTreeSet<usize> =
            flat.flat_map(|cell| self.mesh.cell(cell).nodes).map(|&node| node as usize).collect();
        if nodes.is_empty() {
            return Ok(());
        }
        Err(SolveError::FlatPart { nodes: self.user_nodes(nodes.into_iter().collect()) })
    }

    /// The error that names nodes, in increasing order, and the cell with the fewest points among theirs.
    fn undetermined(&self, nodes: Vec<usize>, quadrature: &CellQuadrature) -> SolveError {
        let touches =
            |cell: usize| self.mesh.cell(cell).nodes.iter().any(|&node| nodes.binary_search(&(node as usize)).is_ok());
        let poorest = (0..self.mesh.num_cells())
            .filter(|&cell| touches(cell))
            .min_by_key(|&cell| quadrature.range(cell).len())
            .unwrap_or_default();
        SolveError::Singular {
            points: quadrature.range(poorest).len(),
            unknowns: self.mesh.cell(poorest).nodes.len() * D,
            nodes: self.user_nodes(nodes),
        }
    }

    /// Indices in the user's mesh of some nodes.
    pub(crate) fn user_nodes(&self, nodes: Vec<usize>) -> Vec<usize> {
        nodes.into_iter().map(|node| self.kept[node] as usize).collect()
    }

    /// Replaces node numbers of this mesh in an error by those of the user's mesh.
    pub(crate) fn in_user_nodes(&self, error: Error) -> Error {
        match error {
            Error::Solve(SolveError::Diverged { iteration, nodes, correction }) => {
                SolveError::Diverged { iteration, nodes: self.user_nodes(nodes), correction }.into()
            }
            other => other,
        }
    }

    /// The mesh on the points of another one of the user's, with the same cells; `None` if it has others.
    pub(crate) fn on_points_of(&self, user_mesh: &Mesh) -> Option<Mesh> {
        let (mesh, kept) = user_mesh.collapsed_as_triangles().compact();
        let same =
            user_mesh.num_nodes() == self.num_user_nodes && kept == self.kept && mesh.cells().eq(self.mesh.cells());
        same.then_some(mesh)
    }

    /// Values at the nodes kept, of one for each node of the user's mesh.
    pub(crate) fn restrict_by<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.kept.iter().map(|&node| values[node as usize]).collect()
    }

    /// Number of nodes of the user's mesh.
    pub(crate) fn num_user_nodes(&self) -> usize {
        self.num_user_nodes
    }

    /// Restricts a field on the nodes of the user's mesh to the nodes kept.
    ///
    /// # Errors
    ///
    /// [`SolveError::InvalidStart`] if it does not have one finite value per node.
    pub(crate) fn restrict(&self, field: &[[f64; D]]) -> Result<Vec<[f64; D]>, SolveError> {
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

    /// Extends a value for each node to all nodes of the user's mesh.
    pub(crate) fn extend_by<T: Copy>(&self, values: &[T], missing: T) -> Vec<T> {
        let mut all = vec![missing; self.num_user_nodes];
        self.kept.iter().zip(values).for_each(|(&node, value)| all[node as usize] = *value);
        all
    }

    /// Extends a field to all nodes of the user's mesh, by NaN.
    pub(crate) fn extend(&self, field: &[[f64; D]]) -> Vec<[f64; D]> {
        self.extend_by(field, [f64::NAN; D])
    }
}

/// For each node the nodes of its cells, increasing.
fn stars(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut stars = vec![Vec::new(); mesh.num_nodes()];
    for cell in mesh.cells() {
        cell.nodes.iter().for_each(|&node| stars[node as usize].extend_from_slice(cell.nodes));
    }
    for star in &mut stars {
        star.sort_unstable();
        star.dedup();
        star.shrink_to_fit();
    }
    stars
}
