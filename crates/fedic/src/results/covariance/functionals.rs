//! Covariance of functions of the displacement: at points, of strains to first order, and of any linear function.

use fedic_mesh::{Locator, MAX_NODES, StrainMeasure, shape_values, surface_gradients};
use fedic_sparse::SpdFactor;
use rayon::prelude::*;

use crate::equations::deformation::Tensor;
use crate::results::covariance::{Covariance, ReferenceCovariance};
use crate::{Error, Monitor, PLANE};

/// Number of functions solved for at once.
const BATCH: usize = 16;
/// Components of a strain.
const STRAIN: usize = 3;

/// Weights of the nodes in a linear function of the displacement.
type Weights = Vec<(u32, [f64; PLANE])>;

impl Covariance {
    /// Covariance of the strain at the centre of each cell, to first order in the noise: `e_11`, `e_22`, `e_12` along the local axes of
    /// the surface. NaN if a node of the cell is not determined.
    pub fn cell_strains(&self, measure: StrainMeasure) -> Vec<[[f64; STRAIN]; STRAIN]> {
        let mesh = self.mesh();
        let of_cell = |index: usize| {
            let cell = mesh.cell(index);
            let weights = self.strain_weights(index, cell.cell_type.reference_centre(), measure);
            self.of_cell(cell.nodes, &weights).unwrap_or([[f64::NAN; STRAIN]; STRAIN])
        };
        (0..mesh.num_cells()).into_par_iter().map(of_cell).collect()
    }

    /// Covariance of linear functions of the displacement of the nodes of a cell; `None` if a node is not determined.
    fn of_cell(&self, nodes: &[u32], weights: &[[[f64; PLANE]; STRAIN]; MAX_NODES]) -> Option<[[f64; STRAIN]; STRAIN]> {
        let mut carried = *weights;
        for (of_node, &node) in carried.iter_mut().zip(nodes) {
            of_node.iter_mut().for_each(|weight| *weight = self.carry(node, *weight));
        }
        let mut covariance = [[0.0; STRAIN]; STRAIN];
        for (a, (&row, left)) in nodes.iter().zip(&carried).enumerate() {
            for (b, (&column, right)) in nodes.iter().zip(&carried).enumerate().take(a + 1) {
                let [[xx, xy], [yx, yy]] = self.reference.block(row, column)?;
                let half = left.map(|[x, y]| [x * xx + y * yx, x * xy + y * yy]);
                for s in 0..STRAIN {
                    for t in 0..STRAIN {
                        let product = half[s][0] * right[t][0] + half[s][1] * right[t][1];
                        covariance[s][t] += product;
                        if b < a {
                            covariance[t][s] += product;
                        }
                    }
                }
            }
        }
        Some(covariance)
    }

    /// Derivative of the strain at a reference point of a cell with respect to the displacement of each of its nodes.
    fn strain_weights(
        &self,
        index: usize,
        at: [f64; 2],
        measure: StrainMeasure,
    ) -> [[[f64; PLANE]; STRAIN]; MAX_NODES] {
        let mesh = self.mesh();
        let cell = mesh.cell(index);
        let surface = surface_gradients(cell.cell_type, &mesh.cell_points(index), at);
        let gradient = surface.of_vectors(cell.nodes.iter().map(|&node| self.displacement[node as usize]));
        let derivative = measure.derivative(&gradient);
        // With respect to the slope of each component of the displacement, from those along the axes of the surface.
        let mut of_slopes = [[[0.0; 2]; PLANE]; STRAIN];
        for (slopes, derivative) in of_slopes.iter_mut().zip(&derivative) {
            for (axis, [first, second]) in surface.axes.iter().zip(derivative) {
                for (slope, along) in slopes.iter_mut().zip(axis) {
                    slope[0] += along * first;
                    slope[1] += along * second;
                }
            }
        }
        let mut weights = [[[0.0; PLANE]; STRAIN]; MAX_NODES];
        for (weights, [first, second]) in weights.iter_mut().zip(surface.shape).take(cell.nodes.len()) {
            for (weight, slope) in weights.as_flattened_mut().iter_mut().zip(of_slopes.as_flattened()) {
                *weight = slope[0] * first + slope[1] * second;
            }
        }
        weights
    }

    /// Covariance of the displacement at points of the `(x, y)` plane, one by one; NaN outside the mesh.
    ///
    /// # Errors
    ///
    /// [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn at_points(&self, points: &[[f64; 2]], monitor: &dyn Monitor) -> Result<Vec<Tensor<PLANE>>, Error> {
        let mesh = self.mesh();
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

    /// Covariance of the mean strain over points of the `(x, y)` plane, as that of [`cell_strains`](Self::cell_strains); NaN if a point
    /// lies outside the mesh.
    ///
    /// # Errors
    ///
    /// [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn mean_strain(
        &self,
        points: &[[f64; 2]],
        measure: StrainMeasure,
        monitor: &dyn Monitor,
    ) -> Result<[[f64; STRAIN]; STRAIN], Error> {
        let mesh = self.mesh();
        let locator = Locator::new(mesh);
        let mut functions: [Weights; STRAIN] = Default::default();
        for &point in points {
            let Some((cell, at)) = locator.find(point) else { return Ok([[f64::NAN; STRAIN]; STRAIN]) };
            let weights = self.strain_weights(cell, at, measure);
            for (s, function) in functions.iter_mut().enumerate() {
                let of_point = |weights: &[[f64; PLANE]; STRAIN]| weights[s].map(|weight| weight / points.len() as f64);
                function.extend(mesh.cell(cell).nodes.iter().zip(&weights).map(|(&node, w)| (node, of_point(w))));
            }
        }
        let block = self.blocks_of(&functions, STRAIN, monitor)?.pop().unwrap_or_default();
        Ok(std::array::from_fn(|i| std::array::from_fn(|j| block[i * STRAIN + j])))
    }

    /// Covariance of linear functions of the displacement, row after row; each is given by a weight of every component of every node.
    ///
    /// # Errors
    ///
    /// [`SolveError::InvalidStart`](crate::SolveError::InvalidStart) if a function does not have one finite weight per component and
    /// node; [`Error::Cancelled`] if `monitor` asks to stop.
    pub fn of_functions(&self, functions: &[&[[f64; PLANE]]], monitor: &dyn Monitor) -> Result<Vec<f64>, Error> {
        let sparse = |weights: &&[[f64; PLANE]]| -> Result<Weights, Error> {
            let kept = self.reference.dofs.restrict(weights)?;
            let entries = kept.into_iter().enumerate().filter(|(_, weight)| *weight != [0.0; PLANE]);
            Ok(entries.map(|(node, weight)| (node as u32, weight)).collect())
        };
        let functions = functions.iter().map(sparse).collect::<Result<Vec<_>, Error>>()?;
        let count = functions.len().max(1);
        Ok(self.blocks_of(&functions, count, monitor)?.pop().unwrap_or_default())
    }

    /// Covariance of each group of `size` functions, row after row.
    fn blocks_of(&self, functions: &[Weights], size: usize, monitor: &dyn Monitor) -> Result<Vec<Vec<f64>>, Error> {
        let near: Vec<_> = functions.par_chunks(size).map(|group| self.block_of_neighbours(group)).collect();
        let groups = functions.chunks(size).zip(&near);
        let others: Vec<&Weights> = groups.filter(|(_, found)| found.is_none()).flat_map(|(group, _)| group).collect();
        let mut solved = self.solved_blocks(&others, size, monitor)?.into_iter();
        Ok(near.into_iter().filter_map(|found| found.or_else(|| solved.next())).collect())
    }

    /// Covariance of functions of nodes that all share cells with one another, from their known blocks; `None` if some do not.
    fn block_of_neighbours(&self, group: &[Weights]) -> Option<Vec<f64>> {
        let mut nodes: Vec<u32> = group.iter().flatten().map(|&(node, _)| node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let pairs = || nodes.iter().enumerate().flat_map(|(i, &a)| nodes[i..].iter().map(move |&b| (a, b)));
        if nodes.len() > MAX_NODES || !pairs().all(|(a, b)| self.reference.share_a_cell(a, b)) {
            return None;
        }
        let carry =
            |weights: &Weights| weights.iter().map(|&(node, weight)| (node, self.carry(node, weight))).collect();
        let carried: Vec<Weights> = group.iter().map(carry).collect();
        let product = |left: &Weights, right: &Weights| -> Option<f64> {
            let mut sum = 0.0;
            for &(row, [x, y]) in left {
                for &(column, [u, v]) in right {
                    let [[xx, xy], [yx, yy]] = self.reference.block(row, column)?;
                    sum += (x * xx + y * yx) * u + (x * xy + y * yy) * v;
                }
            }
            Some(sum)
        };
        let places = (0..group.len()).flat_map(|i| (0..group.len()).map(move |j| (i.min(j), i.max(j))));
        Some(places.map(|(i, j)| product(&carried[i], &carried[j]).unwrap_or(f64::NAN)).collect())
    }

    /// Covariance of each group of `size` functions, row after row, by solutions of the system.
    fn solved_blocks(
        &self,
        functions: &[&Weights],
        size: usize,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Vec<f64>>, Error> {
        if functions.is_empty() {
            return Ok(Vec::new());
        }
        let ReferenceCovariance { dofs, noise, undetermined, .. } = self.reference.as_ref();
        let (pattern, num_dofs) = (&dofs.pattern, dofs.pattern.num_dofs());
        let factor = self.reference.factor()?;
        let per_batch = (BATCH / size).max(1) * size;
        let batches = functions.par_chunks(per_batch).map(|batch| {
            if monitor.cancelled() {
                return Err(Error::Cancelled);
            }
            let mut columns = vec![0.0; batch.len() * num_dofs];
            for (column, weights) in columns.chunks_exact_mut(num_dofs).zip(batch) {
                for &(node, weight) in *weights {
                    let entries = column[node as usize * PLANE..][..PLANE].iter_mut();
                    entries.zip(self.carry(node, weight)).for_each(|(entry, own)| *entry += own);
                }
            }
            factor.solve_sequentially(&mut columns);
            let mut blocks = Vec::new();
            for (group, weights) in columns.chunks(size * num_dofs).zip(batch.chunks(size)) {
                let solutions: Vec<&[f64]> = group.chunks_exact(num_dofs).collect();
                let gathered: Vec<Vec<f64>> = solutions.iter().map(|x| noise.multiply(pattern, x)).collect();
                let is_known = |weights: &&Weights| weights.iter().all(|&(node, _)| !undetermined[node as usize]);
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
