//! What an image term finds from the residuals themselves: the light as a field and the robust weights of the points.
//!
//! Both are found anew in each pass from the residuals of the pass before, and frozen once the displacement hardly moves.

use crate::SolveError;
use crate::equations::term::WeighedCell;
use crate::equations::terms::image::light::{LightField, LightShare, LightSums};
use crate::equations::terms::image::robust::{CellResiduals, RobustWeights};
use crate::kernels::cell_matrix::CellMatrix;
use crate::kernels::node_sums::add_node_sums;
use crate::kernels::polynomial::pixel_coordinates;
use crate::kernels::residual::{GreyLevels, weighted_residuals};
use crate::observation::cell_context::CellContext;
use crate::observation::deformed_pass::{DeformedCell, cell_moments};
use crate::observation::observe::Observation;
use crate::observation::photometry::{GainOffset, Moments};
use crate::observation::workspace::Workspace;
use crate::projection::polynomial_basis::PolynomialBasis;

/// Correction in pixels below which weights and light are frozen.
const FROZEN_CORRECTION: f64 = 0.02;
/// Change of the light, in units of the contrast, below which it is frozen.
const FROZEN_LIGHT: f64 = 2e-3;
/// Correction in pixels below which the weights become stricter, and number of passes after which they do anyway.
const SMALL_CORRECTION: f64 = 0.2;
const STRICTER_AFTER: usize = 6;
/// Number of passes after which they are frozen, however large the corrections are.
const FROZEN_AFTER: usize = 12;
/// Change of the share of the weight that is kept from which on a new Hessian is assembled.
const CHANGE_OF_KEPT: f64 = 0.01;

/// Light and weights of the points of one deformed image.
pub(crate) struct Adaptive<'a> {
    pub(crate) light: Option<LightField<'a>>,
    pub(crate) robust: Option<RobustWeights<'a>>,
    /// Whether the light stays as it is although the weights do not.
    pub(super) keeps_light: bool,
    frozen: bool,
    passes: usize,
    light_change: f64,
    /// Cells that were damaged in the last pass.
    damaged: Vec<usize>,
    /// Number of cells left out when the weights were frozen.
    dropped: usize,
    /// Share of the weight of all points that was kept in the last pass, and in that which assembled the last Hessian.
    kept: f64,
    kept_in_hessian: f64,
    /// Whether the last Hessian has the frozen weights.
    is_hessian_final: bool,
}

/// One cell read with the light and the weights.
pub(crate) struct AdaptedCell {
    /// Moments with the weights, of the deformed image after the correction by the light.
    pub(crate) moments: Moments,
    /// What the next pass depends on.
    pub(crate) found: Found,
}

/// What is found of a cell for the next pass.
#[derive(Default)]
pub(crate) struct Found {
    pub(crate) weighed: Option<WeighedCell>,
    weights: Option<Box<[f32]>>,
    residuals: Option<CellResiduals>,
    light: Option<LightShare>,
}

/// What is found over all cells for the next pass.
pub(crate) struct AllFound {
    light: Option<LightSums>,
    residuals: Vec<CellResiduals>,
    weights: Vec<Option<Box<[f32]>>>,
    damaged: Vec<usize>,
    kept: f64,
    weight: f64,
}

impl<'a> Adaptive<'a> {
    pub(crate) fn new(light: Option<LightField<'a>>, robust: Option<RobustWeights<'a>>) -> Self {
        Self {
            light,
            robust,
            keeps_light: false,
            frozen: false,
            passes: 0,
            light_change: 0.0,
            damaged: Vec::new(),
            dropped: 0,
            kept: 1.0,
            kept_in_hessian: 1.0,
            is_hessian_final: false,
        }
    }

    /// Robust weights of the points of all cells as found last; absent in cells without outliers.
    pub(crate) fn into_weights(self) -> Vec<Option<Box<[f32]>>> {
        self.robust.map(RobustWeights::into_weights).unwrap_or_default()
    }

    /// Whether there is neither light nor weights to be found.
    pub(crate) fn is_empty(&self) -> bool {
        self.light.is_none() && self.robust.is_none()
    }

    fn fits_light(&self) -> bool {
        self.light.is_some() && !self.frozen && !self.keeps_light
    }

    pub(crate) fn is_dropped(&self, cell: usize) -> bool {
        self.robust.as_ref().is_some_and(|robust| robust.is_dropped(cell))
    }

    /// Leaves out some cells from now on. If there are new ones, or were when the weights were frozen, finds the weights anew and
    /// returns true.
    pub(crate) fn drop_cells(&mut self, cells: impl IntoIterator<Item = usize>) -> bool {
        let Some(robust) = &mut self.robust else { return false };
        let dropped = robust.drop_cells(cells) + std::mem::take(&mut self.dropped);
        if dropped > 0 {
            (self.frozen, self.passes, self.is_hessian_final) = (false, 0, false);
        }
        dropped > 0
    }

    /// Whether a new Hessian is to be assembled.
    pub(crate) fn needs_hessian(&self) -> bool {
        self.is_stale() || (self.kept - self.kept_in_hessian).abs() > CHANGE_OF_KEPT
    }

    /// Whether light and weights still change, or the last Hessian has other weights.
    pub(crate) fn has_changed(&self) -> bool {
        !self.is_empty() && (!self.frozen || self.is_stale())
    }

    fn is_stale(&self) -> bool {
        let is_active = self.robust.as_ref().is_some_and(RobustWeights::is_active);
        self.frozen && !self.is_hessian_final && (is_active || self.kept_in_hessian < 1.0)
    }

    /// Takes note of the largest correction, in pixels.
    pub(crate) fn advance(&mut self, correction: f64) {
        self.passes += 1;
        let may_tighten = correction <= SMALL_CORRECTION || self.passes >= STRICTER_AFTER;
        let is_strict = self.robust.as_ref().is_none_or(RobustWeights::is_strict);
        let is_near = is_strict && correction <= FROZEN_CORRECTION && self.light_change <= FROZEN_LIGHT;
        if !self.frozen && (is_near || self.passes >= FROZEN_AFTER) {
            self.frozen = true;
            // Few points of damaged cells determine little: with them the iterations need not end.
            if let Some(robust) = &mut self.robust {
                self.dropped = robust.drop_cells(std::mem::take(&mut self.damaged));
            }
        }
        if may_tighten && let Some(robust) = &mut self.robust {
            robust.tighten();
        }
    }

    /// Corrects the grey levels of a cell, in `workspace.points.grey`, by the light, and writes the weights of its points to
    /// `workspace.points.weights`. `gain_offset` gives gain and offset from moments, without light.
    pub(crate) fn read<const D: usize>(
        &self,
        observation: &Observation<D>,
        workspace: &mut Workspace<D>,
        (context, nodes): (&CellContext<'_, D>, &[u32]),
        deformed: &DeformedCell,
        gain_offset: impl Fn(&Moments) -> GainOffset,
    ) -> AdaptedCell {
        let (cell, count) = (context.cell, context.count());
        let samples = observation.samples.cell(cell);
        let origin = observation.grey_origin;
        let Workspace { projector, points: buffers, .. } = workspace;
        let (shapes, pixel) = (&mut projector.shapes, &mut projector.pixel);
        if deformed.unused.is_none() {
            match samples.weights {
                Some(weights) => buffers.weights.copy_from_slice(weights),
                None => buffers.weights[..count].fill(1.0),
            }
        }
        if let Some(light) = &self.light {
            let inverse = (1.0 / light.unit()) as f32;
            let over_cell = light.over_cell(context.cell_type, nodes);
            context.for_each_chunk(shapes, |chunk, points| {
                let [gain, offset] = pixel.each_mut().map(|row| &mut row[..chunk.padded()]);
                pixel_coordinates(chunk, &over_cell, gain, offset);
                let (grey, scaled) = (&mut buffers.grey[points.clone()], &mut buffers.scaled[points]);
                for (((grey, scaled), gain), offset) in grey.iter_mut().zip(scaled).zip(gain).zip(offset) {
                    *scaled = *grey * inverse;
                    *grey = *gain * *scaled + *offset;
                }
            });
        }
        let gain_offset = if self.light.is_some() {
            GainOffset::IDENTITY
        } else {
            gain_offset(&deformed.moments).counted_from_zero(f64::from(origin))
        };
        let mut found = Found::default();
        if let Some(robust) = &self.robust {
            let (gain, offset) = (gain_offset.gain as f32, gain_offset.offset as f32);
            let residuals = &mut buffers.residual[..count];
            for ((r, f), g) in residuals.iter_mut().zip(samples.value).zip(buffers.grey.iter()) {
                *r = f - (gain * g + offset);
            }
            let base = &buffers.weights[..count];
            let mut new = None;
            if !self.frozen {
                found.residuals = Some(robust.residuals_of(cell, residuals, base));
                new = robust.of_residuals(cell, residuals, base);
            }
            let weights = if self.frozen { robust.last(cell) } else { new.as_deref() };
            found.weighed = robust.effect(cell, residuals, base, weights);
            if let Some(weights) = weights {
                buffers.weights.iter_mut().zip(weights).for_each(|(own, weight)| *own *= weight);
            }
            found.weights = new;
        }
        let weights = Some(&*buffers.weights);
        let weight = buffers.weights[..count].iter().copied().map(f64::from).sum::<f64>();
        let level = f64::from(origin);
        let [f, ff] = cell_moments(context, shapes, samples.value, weights, weight, level);
        let [g, gg] = cell_moments(context, shapes, &buffers.grey, weights, weight, level);
        let [weight, f, ff, g, gg] = [weight, f, ff, g, gg].map(|sum| samples.scale * sum);
        if self.fits_light() && !self.is_dropped(cell) {
            let shape = PolynomialBasis::of(context.cell_type).shape_monomials();
            let weighted = &mut workspace.weighted;
            let mut share = LightShare { sums: Default::default(), matrix: CellMatrix::zeros(nodes.len()) };
            context.for_each_chunk(shapes, |chunk, points| {
                let q = [&buffers.scaled[points.clone()], chunk.ones()];
                let weights = &buffers.weights[points.clone()];
                share.matrix.add(chunk, q, weights);
                let reference = &samples.value[points];
                // The residual against a zero image is the grey level.
                let grey = GreyLevels { reference, deformed: reference, weights, gain_offset: [0.0; 2] };
                let weighted = &mut weighted[..chunk.padded()];
                weighted_residuals(grey, weighted);
                add_node_sums(shape, chunk, q, weighted, &mut share.sums);
            });
            share.matrix.scale(samples.scale);
            share.sums.as_flattened_mut().iter_mut().for_each(|sum| *sum *= samples.scale);
            found.light = Some(share);
        }
        AdaptedCell { moments: Moments { weight, f, ff, g, gg }, found }
    }

    /// Sums without any cell.
    pub(crate) fn all_found(&self) -> AllFound {
        let light = self.light.as_ref().filter(|_| self.fits_light()).map(|light| light.system().sums());
        AllFound { light, residuals: Vec::new(), weights: Vec::new(), damaged: Vec::new(), kept: 0.0, weight: 0.0 }
    }

    /// Adds what is found of the next cell, of this weight before its points were weighed.
    pub(crate) fn add(&self, all: &mut AllFound, cell: usize, found: Found, weight: f64) {
        if self.is_empty() {
            return;
        }
        if let (Some(sums), Some(share), Some(light)) = (&mut all.light, &found.light, &self.light) {
            light.system().add(sums, cell, share);
        }
        let kept = if self.is_dropped(cell) { 0.0 } else { found.weighed.map_or(1.0, |weighed| weighed.kept) };
        if self.robust.as_ref().is_some_and(|robust| kept < robust.min_kept()) {
            all.damaged.push(cell);
        }
        all.weight += weight;
        all.kept += kept * weight;
        all.residuals.extend(found.residuals);
        all.weights.push(found.weights);
    }

    /// Takes what was found in a pass, and whether it assembled a Hessian.
    ///
    /// # Errors
    ///
    /// [`SolveError::TooLarge`] if the light does not fit in memory.
    pub(crate) fn take(&mut self, all: AllFound, with_hessian: bool) -> Result<(), SolveError> {
        self.kept = if all.weight > 0.0 { all.kept / all.weight } else { 1.0 };
        if with_hessian {
            self.kept_in_hessian = self.kept;
            self.is_hessian_final = self.frozen;
        }
        if self.frozen {
            return Ok(());
        }
        if let (Some(light), Some(sums)) = (&mut self.light, all.light) {
            self.light_change = light.fit(sums)?;
        }
        self.damaged = all.damaged;
        if let Some(robust) = &mut self.robust {
            robust.rescale(&all.residuals);
            robust.keep(all.weights);
        }
        Ok(())
    }
}
