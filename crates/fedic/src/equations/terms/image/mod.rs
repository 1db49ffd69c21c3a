//! Image term of one observation: the squared grey-level residual between the reference and the deformed image.

mod adapt;
pub(crate) mod adaptive;
pub(crate) mod light;
pub(crate) mod robust;

use fedic_image::Interpolator;
use fedic_mesh::{MAX_NODES, Mesh};

use crate::equations::basis::Basis;
use crate::equations::normal_equations::{CellEquations, CellShare, NormalEquations};
use crate::equations::term::{CellAgreement, Term, TermReport};
use crate::equations::terms::image::adaptive::{Adaptive, Found};
use crate::interpolation::cell_prefetch::CellPrefetch;
use crate::kernels::cell_matrix::CellMatrix;
use crate::kernels::node_sums::add_node_sums;
use crate::kernels::residual::{GreyLevels, weighted_residuals};
use crate::observation::cell_context::{CellContext, linear_sensitivity};
use crate::observation::deformed_pass::{Exclusion, interior_of, read_deformed};
use crate::observation::material_filter::{MaterialFilter, corrected_moments};
use crate::observation::observe::{Observation, add_node_blocks};
use crate::observation::photometry::{GainOffset, Moments};
use crate::observation::used_points::{UsedPoints, saturated_from};
use crate::observation::workspace::Workspace;
use crate::parallel::for_each_in_order;
use crate::projection::cell_projection::CellProjection;
use crate::projection::polynomial_basis::PolynomialBasis;
use crate::projection::projected_points::{ProjectedPoint, project_nodes};
use crate::{Brightness, Error, Monitor, SolveError};

/// Motion in pixels up to which the polynomials of the cells are not compared with the camera again.
const UNCHECKED_MOTION: f64 = 1.0;

/// The image term of one observation and one deformed image.
pub(crate) struct ImageTerm<'a, const D: usize> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) observation: &'a Observation<D>,
    pub(crate) deformed: &'a Interpolator,
    pub(crate) brightness: Brightness,
    /// Corrects the smoothing of the reference image for the deformation; `None` if the images are not smoothed.
    filter: Option<&'a MaterialFilter<D>>,
    /// Cells that the term is restricted to; `None` for all.
    subset: Option<&'a [usize]>,
    /// Gain and offset over the mesh, as found last. Grey levels are counted from the origin of the observation.
    gain_offset: GainOffset,
    /// Nodes at the displacement assembled last.
    nodes: Vec<ProjectedPoint>,
    polynomials: AcceptedPolynomials,
    /// Grey level from which on a point of the deformed image is saturated.
    saturated: Option<f32>,
    /// Standard deviation of the smoothing of the deformed image, in pixels.
    smoothing: f64,
    used_points: UsedPoints,
    /// Light as a field and robust weights.
    adaptive: Adaptive<'a>,
    /// Block of each node on the diagonal of the Hessian assembled last; `None` before the first.
    node_blocks: Option<Vec<[[f64; D]; D]>>,
}

/// Cells whose polynomial was found accurate, and the motion since.
#[derive(Default)]
struct AcceptedPolynomials {
    /// Found in the last pass.
    found: Vec<bool>,
    /// Valid for the next pass, if the motion is small.
    valid: Option<Vec<bool>>,
    /// Pixels moved since the polynomials were compared with the camera.
    motion: f64,
}

/// Settings of one pass over the cells.
#[derive(Clone, Copy)]
struct Pass<'a, const D: usize> {
    with_hessian: bool,
    filter: Option<&'a MaterialFilter<D>>,
}

/// Result of one cell.
struct CellResult<S> {
    share: S,
    /// Sum of `w r^2`.
    squares: f64,
    moments: Moments,
    agreement: CellAgreement,
    accepted: bool,
    /// Points without weight, if there are any.
    unused: Option<Box<[bool]>>,
    /// Weight of the points before their robust weights.
    weight: f64,
    found: Found,
}

impl<'a, const D: usize> ImageTerm<'a, D> {
    /// The term over all cells, without change of brightness to begin with.
    pub(crate) fn new(
        mesh: &'a Mesh,
        observation: &'a Observation<D>,
        deformed: &'a Interpolator,
        brightness: Brightness,
    ) -> Self {
        Self {
            mesh,
            observation,
            deformed,
            brightness,
            filter: None,
            subset: None,
            gain_offset: GainOffset::IDENTITY,
            nodes: Vec::new(),
            polynomials: AcceptedPolynomials::default(),
            saturated: None,
            smoothing: 0.0,
            used_points: UsedPoints::default(),
            adaptive: Adaptive::new(None, None),
            node_blocks: None,
        }
    }

    /// Smooths both images by the same filter on the material.
    pub(crate) fn with_filter(mut self, filter: Option<&'a MaterialFilter<D>>) -> Self {
        self.filter = filter;
        self.smoothing = filter.map_or(0.0, MaterialFilter::smoothing);
        self
    }

    /// Leaves out the saturated points of a deformed image that reaches this full scale.
    pub(crate) fn with_full_scale(mut self, full_scale: Option<f32>) -> Self {
        self.saturated = full_scale.map(saturated_from);
        self
    }

    /// Restricts the term to some cells.
    pub(crate) fn restricted_to(mut self, cells: &'a [usize]) -> Self {
        self.subset = Some(cells);
        self
    }

    /// Gain and offset over the mesh, as found last, of grey levels counted from zero.
    pub(crate) fn gain_offset(&self) -> GainOffset {
        self.gain_offset.counted_from_zero(f64::from(self.observation.grey_origin))
    }

    /// Block of each node on the diagonal of the Hessian over the points used last.
    pub(crate) fn node_blocks(&self) -> &[[[f64; D]; D]] {
        self.node_blocks.as_deref().unwrap_or(&self.observation.node_blocks)
    }

    /// Estimates gain and offset over the mesh from some of its cells.
    ///
    /// Those over all cells are known only at the end of a pass. A pass uses those found before, and the right-hand side is brought
    /// to those of the pass to first order.
    ///
    /// # Errors
    ///
    /// [`Error::Cancelled`] if `monitor` asks to stop.
    pub(crate) fn estimate_gain_offset(
        &mut self,
        displacement: &[[f64; D]],
        cells: &[usize],
        monitor: &dyn Monitor,
    ) -> Result<(), Error> {
        self.gain_offset = GainOffset::IDENTITY;
        if matches!(self.brightness, Brightness::None | Brightness::Element) {
            return Ok(());
        }
        let nodes = project_nodes(self.mesh, self.observation.camera.as_ref(), Some(displacement));
        let mut moments = Moments::default();
        for_each_in_order(
            cells.iter().copied(),
            monitor,
            |workspace: &mut Workspace<D>, index, cell| {
                let next = CellPrefetch::new(self.deformed, self.mesh, cells.get(index + 1).copied(), &nodes);
                let projection = CellProjection::new(self.mesh, cell, &nodes, self.observation.camera.as_ref());
                let context = self.context(cell, projection);
                read_deformed(
                    self.observation,
                    self.deformed,
                    workspace,
                    &context,
                    self.exclusion(cell, &nodes),
                    next.as_ref(),
                )
                .moments
            },
            |_, cell| moments.add(&cell),
        )?;
        self.gain_offset = self.found_gain_offset(&moments);
        Ok(())
    }

    /// Evaluates the term at a displacement, for its report and its gain and offset alone.
    ///
    /// # Errors
    ///
    /// Those of [`Term::assemble`].
    pub(crate) fn evaluate(
        &mut self,
        displacement: &[[f64; D]],
        basis: &dyn Basis<D>,
        monitor: &dyn Monitor,
    ) -> Result<TermReport, Error> {
        self.assemble(displacement, basis, &mut basis.equations(false), monitor)
    }

    fn exclusion(&self, cell: usize, nodes: &[ProjectedPoint]) -> Exclusion<'_> {
        let size = [self.deformed.width(), self.deformed.height()];
        let of_cell = self.mesh.cell(cell).nodes.iter().map(|&node| &nodes[node as usize]);
        Exclusion {
            saturated: self.saturated,
            points: self.used_points.excluded(cell),
            interior: interior_of(size, self.smoothing, of_cell),
        }
    }

    fn context<'b>(&'b self, cell: usize, projection: CellProjection<'b, D>) -> CellContext<'b, D> {
        CellContext {
            cell,
            cell_type: self.mesh.cell(cell).cell_type,
            quadrature: &self.observation.quadrature,
            camera: self.observation.camera.as_ref(),
            projection,
        }
    }

    fn found_gain_offset(&self, moments: &Moments) -> GainOffset {
        match self.brightness {
            Brightness::None | Brightness::Element => GainOffset::IDENTITY,
            // The grey levels were corrected by the field before.
            _ if self.adaptive.light.is_some() => GainOffset::IDENTITY,
            _ => moments.gain_offset(f64::from(self.observation.grey_origin)),
        }
    }

    /// Gain and offset, of grey levels counted from the origin, of a cell with these moments.
    fn gain_offset_of_cell(&self, moments: &Moments) -> GainOffset {
        match self.brightness {
            Brightness::Element => moments.gain_offset(f64::from(self.observation.grey_origin)),
            _ if self.adaptive.light.is_some() => GainOffset::IDENTITY,
            _ => self.gain_offset,
        }
    }

    /// Change of the right-hand side, to first order, from one gain and offset to another.
    ///
    /// The right-hand side is linear in the gain, through the deformed image, and in the offset. The deformed image is nearly the
    /// reference image seen through the first gain and offset.
    fn photometric_change(&self, from: GainOffset, to: GainOffset) -> Vec<f64> {
        let gain = (to.gain - from.gain) / from.gain;
        let offset = to.offset - from.offset - gain * from.offset;
        let [of_gain, of_offset] = &self.observation.photometric;
        of_gain.iter().zip(of_offset).map(|(image, one)| gain * image + offset * one).collect()
    }

    /// Reads a cell of the deformed image and sums over its points.
    fn evaluate_cell(
        &self,
        workspace: &mut Workspace<D>,
        index: usize,
        cell: usize,
        nodes: &[ProjectedPoint],
        Pass { with_hessian, filter }: Pass<'_, D>,
    ) -> CellResult<CellEquations<D>> {
        let (mesh, observation) = (self.mesh, self.observation);
        let camera = observation.camera.as_ref();
        let (next, projection) = match self.subset {
            None => {
                let accepted = self.polynomials.valid.as_deref();
                (Some(cell + 1), workspace.projections.project(mesh, cell, nodes, camera, accepted))
            }
            Some(cells) => (cells.get(index + 1).copied(), CellProjection::new(mesh, cell, nodes, camera)),
        };
        let next = CellPrefetch::new(self.deformed, mesh, next, nodes);
        let context = self.context(cell, projection);
        let exclusion = self.exclusion(cell, nodes);
        let read = read_deformed(observation, self.deformed, workspace, &context, exclusion, next.as_ref());
        let adapted = (!self.adaptive.is_empty()).then(|| self.adapted(workspace, &context, &read));
        let are_weights_own = read.unused.is_some() || adapted.is_some();
        let (mut moments, found) =
            adapted.map_or((read.moments, Found::default()), |adapted| (adapted.moments, adapted.found));
        let of_reference = observation.moments[cell].weight;
        let part = if are_weights_own && of_reference > 0.0 { moments.weight / of_reference } else { 1.0 };
        let correction = filter.and_then(|filter| filter.cell(mesh, cell, nodes));
        correction.iter().for_each(|correction| moments = corrected_moments(moments, correction, part));
        next.iter().for_each(CellPrefetch::prefetch_lower_half);
        let origin = f64::from(observation.grey_origin);
        let gain_offset = self.gain_offset_of_cell(&moments);
        let GainOffset { gain, offset } = gain_offset.counted_from_zero(origin);
        let samples = observation.samples.cell(cell);
        let basis = PolynomialBasis::of(context.cell_type);
        let mut sums = [[0.0; D]; MAX_NODES];
        let mut squares = 0.0;
        let mut matrix = with_hessian.then(|| CellMatrix::zeros(context.cell_type.num_nodes()));
        let jacobian = observation.jacobians[cell].as_ref();
        if jacobian.is_none() {
            observation.exact_sensitivities(mesh, workspace, cell);
        }
        let Workspace { projector, points: buffers, weighted, .. } = workspace;
        let weights = if are_weights_own { Some(&*buffers.weights) } else { samples.weights };
        context.for_each_chunk(&mut projector.shapes, |chunk, points| {
            let weights = weights.map_or(chunk.ones(), |weights| &weights[points.clone()]);
            if let Some(jacobian) = jacobian {
                let gradient = samples.gradient.part(points.clone());
                let q = buffers.q.each_mut().map(|q| &mut q[points.clone()]);
                linear_sensitivity(chunk, jacobian, samples.step, gradient, q);
            }
            let grey_levels = GreyLevels {
                reference: &samples.value[points.clone()],
                deformed: &buffers.grey[points.clone()],
                weights,
                gain_offset: [gain as f32, offset as f32],
            };
            let weighted = &mut weighted[..chunk.padded()];
            squares += weighted_residuals(grey_levels, weighted);
            let q = buffers.q.each_ref().map(|q| &q[points.clone()]);
            add_node_sums(basis.shape_monomials(), chunk, q, weighted, &mut sums);
            if let Some(matrix) = &mut matrix {
                matrix.add(chunk, q, weights);
            }
        });
        sums.as_flattened_mut().iter_mut().for_each(|sum| *sum *= samples.scale);
        matrix.iter_mut().for_each(|matrix| matrix.scale(samples.scale));
        squares *= samples.scale;
        if let Some(correction) = correction {
            for (sum, correction) in sums.as_flattened_mut().iter_mut().zip(correction.sums.as_flattened()) {
                *sum += part * correction;
            }
            squares = (squares - part * correction.squares).max(0.0);
        }
        let (scatter, correlation) = moments.regression(squares, gain_offset, origin);
        let agreement = CellAgreement {
            residual: (squares / moments.weight).sqrt(),
            scatter,
            correlation,
            used: read.moments.weight / observation.full_weights[cell],
            weighed: found.weighed,
            is_dropped: self.adaptive.is_dropped(cell),
            is_partial: read.unused.is_some(),
        };
        if agreement.is_dropped {
            (sums, squares, moments) = ([[0.0; D]; MAX_NODES], 0.0, Moments::default());
            matrix.iter_mut().for_each(|matrix| matrix.scale(0.0));
        }
        CellResult {
            share: CellEquations { sums, matrix },
            squares,
            moments,
            agreement,
            accepted: context.projection.polynomial.is_some(),
            weight: read.moments.weight,
            unused: read.unused,
            found,
        }
    }
}

impl<const D: usize> Term<D> for ImageTerm<'_, D> {
    fn assemble(
        &mut self,
        displacement: &[[f64; D]],
        basis: &dyn Basis<D>,
        equations: &mut NormalEquations,
        monitor: &dyn Monitor,
    ) -> Result<TermReport, Error> {
        let nodes = project_nodes(self.mesh, self.observation.camera.as_ref(), Some(displacement));
        let filter = match self.filter {
            Some(filter) if filter.prepare(self.mesh, self.observation, basis.stretch(), monitor)? => Some(filter),
            _ => None,
        };
        let pass = Pass { with_hessian: equations.hessian.is_some(), filter };
        let num_cells = self.subset.map_or(self.mesh.num_cells(), <[usize]>::len);
        let mut report = TermReport { cells: Vec::with_capacity(num_cells), ..TermReport::default() };
        let (mut accepted, mut unused) = (Vec::with_capacity(num_cells), Vec::with_capacity(num_cells));
        let mut node_blocks = pass.with_hessian.then(|| vec![[[0.0; D]; D]; self.mesh.num_nodes()]);
        let mut moments = Moments::default();
        let mut all = self.adaptive.all_found();
        let cell_at = |index: usize| self.subset.map_or(index, |cells| cells[index]);
        for_each_in_order(
            0..num_cells,
            monitor,
            |workspace: &mut Workspace<D>, index, _| {
                let cell = cell_at(index);
                let CellResult { share, squares, moments, agreement, accepted, unused, weight, found } =
                    self.evaluate_cell(workspace, index, cell, &nodes, pass);
                let of_cell = self.mesh.cell(cell).nodes;
                let blocks = share
                    .matrix
                    .as_ref()
                    .map(|matrix| (0..of_cell.len()).map(|a| matrix.node_block(a)).collect::<Vec<_>>());
                let share: (CellShare<D>, _) = (basis.reduce(of_cell, share), blocks);
                CellResult { share, squares, moments, agreement, accepted, unused, weight, found }
            },
            |index, result| {
                let cell = cell_at(index);
                let (share, blocks) = &result.share;
                basis.add_cell(cell, share, equations);
                if let (Some(sums), Some(blocks)) = (&mut node_blocks, blocks) {
                    add_node_blocks(self.mesh.cell(cell).nodes, blocks.iter().copied(), sums);
                }
                moments.add(&result.moments);
                report.cost += result.squares;
                report.cells.push(result.agreement);
                accepted.push(result.accepted);
                unused.push(result.unused);
                self.adaptive.add(&mut all, cell, result.found, result.weight);
            },
        )?;
        report.weight = moments.weight;
        let found = self.found_gain_offset(&moments);
        if self.subset.is_none() {
            if moments.weight == 0.0 {
                return Err(SolveError::LeftView.into());
            }
            if moments.is_flat_g(f64::from(self.observation.grey_origin)) {
                return Err(Error::Flat { which: "deformed", std: moments.std_g() });
            }
            self.used_points.update(unused, pass.with_hessian);
            self.adaptive.take(all, pass.with_hessian)?;
            if self.brightness == Brightness::Global {
                basis.add_material_vector(-1.0, &self.photometric_change(self.gain_offset, found), equations);
            }
        }
        if node_blocks.is_some() {
            self.node_blocks = node_blocks;
        }
        self.gain_offset = found;
        self.polynomials.found = accepted;
        self.nodes = nodes;
        Ok(report)
    }

    fn needs_hessian(&self) -> bool {
        self.used_points.needs_hessian() || self.adaptive.needs_hessian()
    }

    fn has_changed(&self) -> bool {
        self.used_points.changed_since_hessian() || self.adaptive.has_changed()
    }

    fn pixel_lengths(&mut self, increment: &[[f64; D]]) -> Option<Vec<f64>> {
        let length = |(node, increment): (&ProjectedPoint, &[f64; D])| {
            let [du, dv] = node.jacobian.map(|row| row.iter().zip(increment).map(|(j, s)| j * s).sum::<f64>());
            (du * du + dv * dv).sqrt()
        };
        let lengths: Vec<f64> = self.nodes.iter().zip(increment).map(length).collect();
        let largest = lengths.iter().copied().fold(0.0, f64::max);
        self.polynomials.advance(largest);
        self.used_points.advance(largest);
        self.adaptive.advance(largest);
        Some(lengths)
    }
}

impl AcceptedPolynomials {
    /// Takes note of a motion of the nodes by at most this many pixels.
    fn advance(&mut self, motion: f64) {
        self.motion = if self.valid.is_some() { self.motion + motion } else { motion };
        self.valid = (self.motion <= UNCHECKED_MOTION).then(|| std::mem::take(&mut self.found));
    }
}
