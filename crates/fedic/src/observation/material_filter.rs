//! The smoothing of the deformed image, seen in the reference configuration.
//!
//! Smoothing the deformed image by a Gaussian of variance `s^2` is smoothing the reference image by the covariance
//! `C = s^2 F^-1 F^-T`, where `F` is the deformation gradient in the image. A reference image smoothed by `s^2` differs from that by
//! `1/2 A:grad grad f + 1/8 (A:grad grad)^2 f + ...` with `A = C - s^2 I`. Sums of these derivatives over each cell, formed once,
//! bring the equations of any deformed image to the same filter on the material.

use std::sync::{Arc, OnceLock};

use fedic_image::{ImageView, Interpolation, Interpolator};
use fedic_memory::AlignedBuffer;
use fedic_mesh::{MAX_NODES, Mesh};

use crate::kernels::node_sums::add_node_sums;
use crate::observation::cell_context::{CellContext, ImagePoints, linear_sensitivity};
use crate::observation::image_source::{ImageSource, view_of};
use crate::observation::observe::Observation;
use crate::observation::photometry::Moments;
use crate::observation::workspace::Workspace;
use crate::parallel::for_each_in_order;
use crate::projection::polynomial_basis::PolynomialBasis;
use crate::projection::projected_points::{ProjectedPoint, project_nodes};
use crate::{Error, Monitor};

/// Relative change of length from which on the filters are told apart. Below, the error is at most 1.4e-4 px rms at the nodes of quads of
/// 20 px, and 2.1e-4 px at those of quad9 of 32 px.
const MIN_STRETCH: f64 = 2.5e-3;
/// Largest norm of `A`, in units of `s^2`, for which the series is used.
const MAX_CHANGE: f64 = 1.5;
/// Square of the wavenumber, in radians per pixel, at which the second term of the series stands for the third as well: that of a
/// wave of 5.5 px, among the shortest that speckle holds.
const SQUARED_WAVENUMBER: f64 = 1.3;
const SECOND: usize = 3;
const FOURTH: usize = 5;
/// Derivatives of the reference image: the second ones, then the fourth ones.
const DERIVATIVES: usize = SECOND + FOURTH;
/// Vectors of the right-hand side: for each second derivative times 1, `xi` and `eta`, and for each fourth derivative.
const VECTORS: usize = 3 * SECOND + FOURTH;

/// The correction for one reference image, made when first needed.
pub(crate) struct MaterialFilter<const D: usize> {
    smoothing: f64,
    source: Arc<dyn ImageSource>,
    prepared: OnceLock<Prepared<D>>,
}

struct Prepared<const D: usize> {
    /// The nodes at the reference position.
    nodes: Vec<ProjectedPoint>,
    cells: Vec<CellSums<D>>,
}

/// Sums over the points of a cell.
struct CellSums<const D: usize> {
    /// Sums of `w N^T q` times a derivative, by node.
    vectors: [Vec<[f32; D]>; VECTORS],
    /// Sums of `w` times a derivative.
    levels: [f64; DERIVATIVES],
    /// Sums of `w` times the grey level, counted from the origin, and a derivative.
    with_level: [f64; DERIVATIVES],
    /// Sums of `w` times a second derivative and any derivative.
    products: [[f64; DERIVATIVES]; SECOND],
}

/// The correction of the sums of one cell.
pub(crate) struct CellCorrection<const D: usize> {
    /// To be added to the right-hand side, by node.
    pub(crate) sums: [[f64; D]; MAX_NODES],
    /// To be subtracted from the sum of the squared residuals.
    pub(crate) squares: f64,
    /// To be added to the sum of the reference grey levels and to that of their squares.
    pub(crate) moments: [f64; 2],
}

impl<const D: usize> MaterialFilter<D> {
    /// The correction for an image smoothed by this standard deviation, in pixels.
    pub(crate) fn new(smoothing: f64, source: Arc<dyn ImageSource>) -> Self {
        Self { smoothing, source, prepared: OnceLock::new() }
    }

    /// Standard deviation of the smoothing, in pixels.
    pub(crate) fn smoothing(&self) -> f64 {
        self.smoothing
    }

    /// Prepares the correction if a field of this relative change of length needs it, and returns whether it does.
    ///
    /// # Errors
    ///
    /// [`Error`] if the reference image cannot be viewed again, or `monitor` asks to stop.
    pub(crate) fn prepare(
        &self,
        mesh: &Mesh,
        observation: &Observation<D>,
        stretch: f64,
        monitor: &dyn Monitor,
    ) -> Result<bool, Error> {
        if stretch < MIN_STRETCH {
            return Ok(false);
        }
        if self.prepared.get().is_none() {
            let prepare = |reference: ImageView<'_>| {
                let nodes = project_nodes::<D>(mesh, observation.camera.as_ref(), None);
                let image = Interpolator::smoothed(reference, Interpolation::Bspline5, self.smoothing)?;
                let pass = Pass { mesh, observation, image: &image, nodes: &nodes };
                let mut cells = Vec::with_capacity(mesh.num_cells());
                for_each_in_order(
                    0..mesh.num_cells(),
                    monitor,
                    |workspace: &mut Workspace<D>, cell, _| pass.sum(workspace, cell),
                    |_, sums| cells.push(sums),
                )?;
                Ok::<_, Error>(Prepared { nodes, cells })
            };
            // Another thread may make the same meanwhile.
            let _ = self.prepared.set(view_of(self.source.as_ref(), prepare)??);
        }
        Ok(true)
    }

    /// Correction of the sums of a cell, to be multiplied by the part of its weight that is used. `displaced` are the nodes of the
    /// mesh at the displacement. `None` if the correction was not prepared.
    pub(crate) fn cell(&self, mesh: &Mesh, cell: usize, displaced: &[ProjectedPoint]) -> Option<CellCorrection<D>> {
        let prepared = self.prepared.get()?;
        let [constant, along_xi, along_eta] = self.changes(mesh, cell, &prepared.nodes, displaced);
        let sums = &prepared.cells[cell];
        let [a, b, c] = constant;
        let second = |[a, b, c]: [f64; 3]| [0.5 * a, b, 0.5 * c];
        let norm = (a * a + 2.0 * b * b + c * c).sqrt().copysign(a + c);
        let third = (1.0 - SQUARED_WAVENUMBER * norm / 6.0).max(0.0);
        let fourth = [a * a, 4.0 * a * b, 2.0 * a * c + 4.0 * b * b, 4.0 * b * c, c * c].map(|x| third * x / 8.0);
        let by_monomial = [constant, along_xi, along_eta].map(second);
        let factors = by_monomial.as_flattened().iter().chain(&fourth);
        let mut correction = CellCorrection { sums: [[0.0; D]; MAX_NODES], squares: 0.0, moments: [0.0; 2] };
        for (factor, vector) in factors.zip(&sums.vectors) {
            for (sum, entry) in correction.sums.iter_mut().zip(vector) {
                (0..D).for_each(|d| sum[d] += factor * f64::from(entry[d]));
            }
        }
        let second = by_monomial[0];
        let all: [f64; DERIVATIVES] = std::array::from_fn(|k| if k < SECOND { second[k] } else { fourth[k - SECOND] });
        let product = |sums: &[f64; DERIVATIVES]| all.iter().zip(sums).map(|(e, sum)| e * sum).sum::<f64>();
        // The square of the change of the grey level, but for that of its second term.
        let twice: [f64; DERIVATIVES] = std::array::from_fn(|k| if k < SECOND { all[k] } else { 2.0 * all[k] });
        for (row, e) in sums.products.iter().zip(second) {
            correction.squares += e * row.iter().zip(twice).map(|(sum, e)| sum * e).sum::<f64>();
        }
        correction.squares = correction.squares.max(0.0);
        correction.moments = [product(&sums.levels), 2.0 * product(&sums.with_level) + correction.squares];
        Some(correction)
    }

    /// Change `A = C - s^2 I` of the filter over a cell: the components `uu`, `uv`, `vv` of its linear fit in `1`, `xi`, `eta`.
    fn changes(
        &self,
        mesh: &Mesh,
        cell: usize,
        at_rest: &[ProjectedPoint],
        displaced: &[ProjectedPoint],
    ) -> [[f64; 3]; 3] {
        let cell = mesh.cell(cell);
        let basis = PolynomialBasis::of(cell.cell_type);
        let variance = self.smoothing * self.smoothing;
        let mut changes = [[0.0; 3]; 3];
        for (a, fit) in basis.jacobian[..cell.nodes.len()].iter().enumerate() {
            let [from, to] = [at_rest, displaced].map(|nodes| pixel_tangents(basis, cell.nodes, a, nodes));
            let change = relative_change(from, to).map(|entry| variance * entry);
            for (sum, factor) in changes.iter_mut().zip(fit) {
                (0..3).for_each(|k| sum[k] += factor * change[k]);
            }
        }
        changes
    }
}

/// Derivatives of the image point along `xi` and `eta` at node `a` of a cell: rows `u` and `v`.
fn pixel_tangents(basis: &PolynomialBasis, nodes: &[u32], a: usize, projected: &[ProjectedPoint]) -> [[f64; 2]; 2] {
    let mut tangents = [[0.0; 2]; 3];
    for (&node, slopes) in nodes.iter().zip(&basis.gradients[a]) {
        let world = &projected[node as usize].world;
        for (tangent, x) in tangents.iter_mut().zip(world) {
            (0..2).for_each(|direction| tangent[direction] += slopes[direction] * x);
        }
    }
    projected[nodes[a] as usize].jacobian.map(|row| {
        [0, 1].map(|direction| row.iter().zip(&tangents).map(|(slope, tangent)| slope * tangent[direction]).sum())
    })
}

/// `F^-1 F^-T - I`, the components `uu`, `uv`, `vv`, for a map with these tangents before and after; zero where it is folded.
fn relative_change(from: [[f64; 2]; 2], to: [[f64; 2]; 2]) -> [f64; 3] {
    let [[a, b], [c, d]] = to;
    let det = a * d - b * c;
    // F^-1 = from to^-1
    let inverse = from.map(|[x, y]| [(x * d - y * c) / det, (y * a - x * b) / det]);
    let dot = |p: usize, q: usize| inverse[p][0] * inverse[q][0] + inverse[p][1] * inverse[q][1];
    let change = [dot(0, 0) - 1.0, dot(0, 1), dot(1, 1) - 1.0];
    let norm = (change[0].powi(2) + 2.0 * change[1].powi(2) + change[2].powi(2)).sqrt();
    if !norm.is_finite() {
        return [0.0; 3];
    }
    let scale = (MAX_CHANGE / norm).min(1.0);
    change.map(|entry| scale * entry)
}

/// Input of the pass over the cells.
struct Pass<'a, const D: usize> {
    mesh: &'a Mesh,
    observation: &'a Observation<D>,
    image: &'a Interpolator,
    nodes: &'a [ProjectedPoint],
}

impl<const D: usize> Pass<'_, D> {
    fn sum(&self, workspace: &mut Workspace<D>, cell: usize) -> CellSums<D> {
        let (mesh, observation) = (self.mesh, self.observation);
        let camera = observation.camera.as_ref();
        let context = CellContext {
            cell,
            cell_type: mesh.cell(cell).cell_type,
            quadrature: &observation.quadrature,
            camera,
            projection: workspace.projections.project(mesh, cell, self.nodes, camera, None),
        };
        workspace.points.resize(context.count());
        let derivatives = self.derivatives(workspace, &context);
        let jacobian = observation.jacobians[cell].as_ref();
        if jacobian.is_none() {
            observation.exact_sensitivities(mesh, workspace, cell);
        }
        let samples = observation.samples.cell(cell);
        let shape = PolynomialBasis::of(context.cell_type).shape_monomials();
        let mut vectors = [[[0.0; D]; MAX_NODES]; VECTORS];
        let (mut levels, mut with_level) = ([0.0; DERIVATIVES], [0.0; DERIVATIVES]);
        let mut products = [[0.0; DERIVATIVES]; SECOND];
        let Workspace { projector, points: buffers, weighted: by_monomial, .. } = workspace;
        let mut factors = AlignedBuffer::zeros(by_monomial.len());
        context.for_each_chunk(&mut projector.shapes, |chunk, points| {
            if let Some(jacobian) = jacobian {
                let gradient = samples.gradient.part(points.clone());
                let q = buffers.q.each_mut().map(|q| &mut q[points.clone()]);
                linear_sensitivity(chunk, jacobian, samples.step, gradient, q);
            }
            let q = buffers.q.each_ref().map(|q| &q[points.clone()]);
            let weights = samples.weights.map_or(chunk.ones(), |weights| &weights[points.clone()]);
            let rows = derivatives.each_ref().map(|row| &row[points.clone()]);
            let factors = &mut factors[..chunk.padded()];
            for (k, row) in rows.into_iter().enumerate() {
                multiply(row, weights, factors);
                levels[k] += dot(factors, chunk.ones());
                with_level[k] += dot(factors, &samples.value[points.clone()]);
                if k >= SECOND {
                    add_node_sums(shape, chunk, q, factors, &mut vectors[2 * SECOND + k]);
                    continue;
                }
                products[k].iter_mut().zip(rows).for_each(|(sum, row)| *sum += dot(factors, row));
                add_node_sums(shape, chunk, q, factors, &mut vectors[k]);
                for m in 1..=2 {
                    let by_monomial = &mut by_monomial[..chunk.padded()];
                    multiply(factors, chunk.monomial(m), by_monomial);
                    add_node_sums(shape, chunk, q, by_monomial, &mut vectors[m * SECOND + k]);
                }
            }
        });
        let (scale, origin) = (samples.scale, f64::from(observation.grey_origin));
        let count = mesh.cell(cell).nodes.len();
        CellSums {
            vectors: vectors.map(|vector| vector[..count].iter().map(|sum| sum.map(|x| (scale * x) as f32)).collect()),
            levels: levels.map(|sum| scale * sum),
            with_level: std::array::from_fn(|k| scale * (with_level[k] - origin * levels[k])),
            products: products.map(|row| row.map(|sum| scale * sum)),
        }
    }

    /// Derivatives of the reference image at the points of a cell; zero outside the image.
    fn derivatives(
        &self,
        workspace: &mut Workspace<D>,
        context: &CellContext<'_, D>,
    ) -> [AlignedBuffer<f32>; DERIVATIVES] {
        let padded = workspace.points.grey.len();
        let mut rows: [AlignedBuffer<f32>; DERIVATIVES] = std::array::from_fn(|_| AlignedBuffer::zeros(padded));
        let (mut near_u, mut near_v) = (Vec::new(), Vec::new());
        context.for_each_projection(&mut workspace.projector, |image_points, points| {
            let (u, v): (&[f64], &[f64]) = match image_points {
                ImagePoints::Near { origin: [column, row], u, v } => {
                    near_u.clear();
                    near_v.clear();
                    near_u.extend(u.iter().map(|&u| f64::from(u) + column as f64));
                    near_v.extend(v.iter().map(|&v| f64::from(v) + row as f64));
                    (&near_u, &near_v)
                }
                ImagePoints::Exact(batch) => batch.pixels().into(),
            };
            let mut parts = rows.each_mut().map(|row| &mut row[points.clone()]).into_iter();
            let second = std::array::from_fn::<_, SECOND, _>(|_| parts.next().unwrap_or_default());
            let fourth = std::array::from_fn::<_, FOURTH, _>(|_| parts.next().unwrap_or_default());
            self.image.second_derivatives(u, v, second);
            self.image.fourth_derivatives(u, v, fourth);
        });
        for row in &mut rows {
            row.iter_mut().filter(|entry| entry.is_nan()).for_each(|entry| *entry = 0.0);
        }
        rows
    }
}

/// Writes the products of two rows.
fn multiply(a: &[f32], b: &[f32], out: &mut [f32]) {
    out.iter_mut().zip(a.iter().zip(b)).for_each(|(out, (a, b))| *out = a * b);
}

/// Sum of the products of two rows.
fn dot(a: &[f32], b: &[f32]) -> f64 {
    let mut lanes = [0.0_f32; 8];
    let [(a, rest_a), (b, rest_b)] = [a, b].map(|row| row.as_chunks::<8>());
    for (a, b) in a.iter().zip(b) {
        lanes.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    let rest = rest_a.iter().zip(rest_b).map(|(a, b)| f64::from(a * b)).sum::<f64>();
    lanes.into_iter().map(f64::from).sum::<f64>() + rest
}

/// Adds the correction of a cell, of which this part of the weight is used, to the moments of the images over it.
pub(crate) fn corrected_moments<const D: usize>(
    moments: Moments,
    correction: &CellCorrection<D>,
    part: f64,
) -> Moments {
    let [f, ff] = correction.moments.map(|sum| part * sum);
    Moments { f: moments.f + f, ff: moments.ff + ff, ..moments }
}
