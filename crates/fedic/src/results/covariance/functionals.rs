//! Covariance of linear functions of the displacement: at points, of displacement gradients, and any other.

use fedic_mesh::{Locator, shape_values, surface_gradients};
use fedic_sparse::SpdFactor;
use rayon::prelude::*;

use crate::equations::deformation::Tensor;
use crate::results::covariance::Covariance;
use crate::{Error, Monitor, PLANE};

/// Number of functions solved for at once.
const BATCH: usize = 16;
/// Components of the displacement gradient: derivatives of the first component along both axes, then of the second.
pub(crate) const GRADIENT: usize = PLANE * 2;

/// Weights of the nodes in a linear function of the displacement.
type Weights = Vec<(u32, [f64; PLANE])>;

impl Covariance {
    /// Covariance of the displacement gradient at the centre of each cell: `du/dx`, `du/dy`, `dv/dx`, `dv/dy` along the local axes of
    /// the surface. NaN if a node of the cell is not determined.
    pub fn cell_gradients(&self) -> Vec<[[f64; GRADIENT]; GRADIENT]> {
        let mesh = &self.dofs.mesh;
        let of_cell = |index: usize| {
            let cell = mesh.cell(index);
            let slopes = surface_gradients(cell.cell_type, &mesh.cell_points(index), cell.cell_type.reference_centre());
            let mut covariance = [[0.0; GRADIENT]; GRADIENT];
            for (a, &row) in cell.nodes.iter().enumerate() {
                for (b, &column) in cell.nodes.iter().enumerate() {
                    let block = self.block(row, column);
                    for (p, sums) in covariance.iter_mut().enumerate() {
                        for (q, sum) in sums.iter_mut().enumerate() {
                            *sum += slopes.shape[a][p % 2] * block[p / 2][q / 2] * slopes.shape[b][q % 2];
                        }
                    }
                }
            }
            covariance
        };
        (0..mesh.num_cells()).into_par_iter().map(of_cell).collect()
    }

    /// Covariance of the displacement at points of the `(x, y)` plane, one by one; NaN outside the mesh.
    ///
    /// # Errors
    ///
    /// [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn at_points(&self, points: &[[f64; 2]], monitor: &dyn Monitor) -> Result<Vec<Tensor<PLANE>>, Error> {
        let mesh = &self.dofs.mesh;
        let locator = Locator::new(mesh);
        let mut functions: Vec<Weights> = Vec::with_capacity(PLANE * points.len());
        let found: Vec<_> = points.iter().map(|&point| locator.find(point)).collect();
        for &(cell, at) in found.iter().flatten() {
            let cell = mesh.cell(cell);
            let shapes = shape_values(cell.cell_type, at);
            for c in 0..PLANE {
                let weight = |shape: f64| std::array::from_fn(|d| if d == c { shape } else { 0.0 });
                functions.push(cell.nodes.iter().zip(shapes).map(|(&node, shape)| (node, weight(shape))).collect());
            }
        }
        let mut blocks = self.blocks_of(&functions, PLANE, monitor)?.into_iter();
        let nan = [[f64::NAN; PLANE]; PLANE];
        let of_point = |found: &Option<_>| match found.as_ref().and_then(|_| blocks.next()) {
            Some(block) => std::array::from_fn(|i| std::array::from_fn(|j| block[i * PLANE + j])),
            None => nan,
        };
        Ok(found.iter().map(of_point).collect())
    }

    /// Covariance of the mean displacement gradient over points of the `(x, y)` plane, in the order of
    /// [`cell_gradients`](Self::cell_gradients); NaN if a point lies outside the mesh.
    ///
    /// # Errors
    ///
    /// [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn mean_gradient(
        &self,
        points: &[[f64; 2]],
        monitor: &dyn Monitor,
    ) -> Result<[[f64; GRADIENT]; GRADIENT], Error> {
        let mesh = &self.dofs.mesh;
        let locator = Locator::new(mesh);
        let mut functions: [Weights; GRADIENT] = Default::default();
        for &point in points {
            let Some((cell, at)) = locator.find(point) else { return Ok([[f64::NAN; GRADIENT]; GRADIENT]) };
            let nodes = mesh.cell_points(cell);
            let cell = mesh.cell(cell);
            let slopes = surface_gradients(cell.cell_type, &nodes, at).shape;
            for (p, function) in functions.iter_mut().enumerate() {
                let weight =
                    |slope: f64| std::array::from_fn(|d| if d == p / 2 { slope / points.len() as f64 } else { 0.0 });
                function.extend(cell.nodes.iter().zip(slopes).map(|(&node, slope)| (node, weight(slope[p % 2]))));
            }
        }
        let block = self.blocks_of(&functions, GRADIENT, monitor)?.pop().unwrap_or_default();
        Ok(std::array::from_fn(|i| std::array::from_fn(|j| block[i * GRADIENT + j])))
    }

    /// Covariance of linear functions of the displacement, row after row; each is given by a weight of every component of every node.
    ///
    /// # Errors
    ///
    /// [`SolveError::InvalidStart`](crate::SolveError::InvalidStart) if a function does not have one finite weight per component and
    /// node; [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn of_functions(&self, functions: &[&[[f64; PLANE]]], monitor: &dyn Monitor) -> Result<Vec<f64>, Error> {
        let sparse = |weights: &&[[f64; PLANE]]| -> Result<Weights, Error> {
            let kept = self.dofs.restrict(weights)?;
            let entries = kept.into_iter().enumerate().filter(|(_, weight)| *weight != [0.0; PLANE]);
            Ok(entries.map(|(node, weight)| (node as u32, weight)).collect())
        };
        let functions = functions.iter().map(sparse).collect::<Result<Vec<_>, Error>>()?;
        let count = functions.len().max(1);
        Ok(self.blocks_of(&functions, count, monitor)?.pop().unwrap_or_default())
    }

    /// Covariance of each group of `size` functions, row after row.
    fn blocks_of(&self, functions: &[Weights], size: usize, monitor: &dyn Monitor) -> Result<Vec<Vec<f64>>, Error> {
        let (pattern, num_dofs) = (&self.dofs.pattern, self.dofs.pattern.num_dofs());
        let factor = self.factor()?;
        let per_batch = (BATCH / size).max(1) * size;
        let batches = functions.par_chunks(per_batch).map(|batch| {
            if monitor.cancelled() {
                return Err(Error::Cancelled);
            }
            let mut columns = vec![0.0; batch.len() * num_dofs];
            for (column, weights) in columns.chunks_exact_mut(num_dofs).zip(batch) {
                for &(node, weight) in weights {
                    // An increment of the displacement is that of the reference configuration, carried by the gradient.
                    let gradient = &self.gradients[node as usize];
                    for (j, entry) in column[node as usize * PLANE..][..PLANE].iter_mut().enumerate() {
                        *entry += (0..PLANE).map(|i| gradient[i][j] * weight[i]).sum::<f64>();
                    }
                }
            }
            factor.solve_sequentially(&mut columns);
            let mut blocks = Vec::new();
            for (group, weights) in columns.chunks(size * num_dofs).zip(batch.chunks(size)) {
                let solutions: Vec<&[f64]> = group.chunks_exact(num_dofs).collect();
                let gathered: Vec<Vec<f64>> = solutions.iter().map(|x| self.noise.multiply(pattern, x)).collect();
                let is_known = |weights: &Weights| weights.iter().all(|&(node, _)| !self.undetermined[node as usize]);
                let known: Vec<bool> = weights.iter().map(is_known).collect();
                let entry = |i: usize, j: usize| -> f64 {
                    let product = solutions[i].iter().zip(&gathered[j]).map(|(x, y)| x * y).sum();
                    if known[i] && known[j] { product } else { f64::NAN }
                };
                blocks.push(
                    (0..solutions.len())
                        .flat_map(|i| (0..solutions.len()).map(move |j| (i, j)))
                        .map(|(i, j)| entry(i.min(j), i.max(j)))
                        .collect(),
                );
            }
            Ok(blocks)
        });
        Ok(batches.collect::<Result<Vec<_>, Error>>()?.concat())
    }
}
