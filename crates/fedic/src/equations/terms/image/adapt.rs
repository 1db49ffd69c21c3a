//! Light and robust weights of an image term.

use crate::equations::terms::image::ImageTerm;
use crate::equations::terms::image::adaptive::{AdaptedCell, Adaptive};
use crate::equations::terms::image::light::{LightField, LightSystem};
use crate::equations::terms::image::robust::{CellNeighbours, RobustWeights};
use crate::interpolation::cell_prefetch::CellPrefetch;
use crate::observation::cell_context::CellContext;
use crate::observation::deformed_pass::{DeformedCell, read_deformed};
use crate::observation::photometry::Moments;
use crate::observation::workspace::Workspace;
use crate::parallel::for_each_in_order;
use crate::projection::cell_projection::CellProjection;
use crate::projection::projected_points::{ProjectedPoint, project_nodes};
use crate::{Error, Monitor, Robust};

impl<'a, const D: usize> ImageTerm<'a, D> {
    /// Light as a field and weights of the points, as found last.
    pub(crate) fn adaptive(&self) -> &Adaptive<'a> {
        &self.adaptive
    }

    /// Robust weights of the points of all cells as found last; absent in cells without outliers.
    pub(crate) fn into_weights(self) -> Vec<Option<Box<[f32]>>> {
        self.adaptive.into_weights()
    }

    /// Leaves out some cells from now on, and returns whether the frame is to be measured again.
    pub(crate) fn drop_cells(&mut self, cells: impl IntoIterator<Item = usize>) -> bool {
        self.adaptive.drop_cells(cells)
    }

    /// Makes the light a field, starting from gain and offset over the mesh as found last, and weighs the points by their residual.
    ///
    /// # Errors
    ///
    /// [`Error::Cancelled`] if `monitor` asks to stop; [`SolveError::TooLarge`] if the light does not fit in memory.
    pub(crate) fn adapt(
        &mut self,
        displacement: &[[f64; D]],
        light: Option<&'a LightSystem>,
        robust: Option<(Robust, &'a CellNeighbours)>,
        monitor: &dyn Monitor,
    ) -> Result<(), Error> {
        let mut all = Moments::default();
        self.observation.moments.iter().for_each(|cell| all.add(cell));
        let contrast = all.std_f();
        let light = light.map(|system| LightField::uniform(system, contrast, self.gain_offset()));
        let robust = robust.map(|(function, neighbours)| RobustWeights::new(function, neighbours, contrast));
        let nodes = project_nodes(self.mesh, self.observation.camera.as_ref(), Some(displacement));
        self.adaptive = Adaptive::new(light, None);
        if self.adaptive.light.is_some() {
            self.find(&nodes, monitor)?;
        }
        if robust.is_some() {
            // The scale of the residuals is that after the correction by the light.
            (self.adaptive.robust, self.adaptive.keeps_light) = (robust, true);
            self.find(&nodes, monitor)?;
            self.adaptive.keeps_light = false;
        }
        Ok(())
    }

    /// Finds light and scales in one pass over the deformed image, without the equations.
    fn find(&mut self, nodes: &[ProjectedPoint], monitor: &dyn Monitor) -> Result<(), Error> {
        let mut all = self.adaptive.all_found();
        for_each_in_order(
            0..self.mesh.num_cells(),
            monitor,
            |workspace: &mut Workspace<D>, _, cell| {
                let next = CellPrefetch::new(self.deformed, self.mesh, Some(cell + 1), nodes);
                let projection = CellProjection::new(self.mesh, cell, nodes, self.observation.camera.as_ref());
                let context = self.context(cell, projection);
                let exclusion = self.exclusion(cell, nodes);
                let read =
                    read_deformed(self.observation, self.deformed, workspace, &context, exclusion, next.as_ref());
                (self.adapted(workspace, &context, &read).found, read.moments.weight)
            },
            |cell, (found, weight)| self.adaptive.add(&mut all, cell, found, weight),
        )?;
        Ok(self.adaptive.take(all, false)?)
    }

    pub(super) fn adapted(
        &self,
        workspace: &mut Workspace<D>,
        context: &CellContext<'_, D>,
        deformed: &DeformedCell,
    ) -> AdaptedCell {
        let nodes = self.mesh.cell(context.cell).nodes;
        let gain_offset = |moments: &Moments| self.gain_offset_of_cell(moments);
        self.adaptive.read(self.observation, workspace, (context, nodes), deformed, gain_offset)
    }
}
