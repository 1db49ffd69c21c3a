//! The covariance of the displacement, predicted by a correlator.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use fedic_image::ImageView;

use super::Correlator;
use crate::observation::image_source::view_of;
use crate::options::{NOISE, OptionType};
use crate::results::covariance::{Covariance, ReferenceCovariance};
use crate::results::solution::Information;
use crate::threads::in_pool;
use crate::{Error, Monitor, PLANE};

/// What the covariances of the frames are carried from, kept once it is prepared.
#[derive(Default)]
pub(super) struct Prepared {
    /// With all points used.
    full: OnceLock<Arc<ReferenceCovariance>>,
    /// With the last other points used.
    last: Mutex<Option<(Vec<Information>, Arc<ReferenceCovariance>)>>,
}

impl Prepared {
    fn find(&self, information: Option<&[Information]>) -> Option<Arc<ReferenceCovariance>> {
        let Some(information) = information else { return self.full.get().cloned() };
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        last.as_ref().filter(|(of, _)| of == information).map(|(_, found)| Arc::clone(found))
    }

    fn keep(&self, information: Option<&[Information]>, found: &Arc<ReferenceCovariance>) {
        match information {
            // Another thread may have made the same meanwhile.
            None => _ = self.full.set(Arc::clone(found)),
            Some(of) => {
                let entry = Some((of.to_vec(), Arc::clone(found)));
                *self.last.lock().unwrap_or_else(PoisonError::into_inner) = entry;
            }
        }
    }
}

impl Correlator {
    /// Covariance of the displacement due to the noise of the images, near a displacement (`None` for none).
    ///
    /// `noise` is the standard deviation, in grey levels, of the noise of one image as recorded, before any smoothing: white from
    /// pixel to pixel, and the same in both images. `information` is that of a [`Solution`](crate::Solution); `None` if all are used.
    ///
    /// The covariance is `2 noise^2 A^-1 B A^-1`. `A` is the Hessian, the penalty of a regularization included.
    /// `B = sum (w^2 / p) h h^T` over the quadrature points, of weight `w` and standing for `p` pixels, with
    /// `h = N^T J_P^T grad f` of the reference image smoothed twice, since `A` and the noise of the right-hand side are smoothed once
    /// each. A point counts for no more pixels than an evaluation of the image averages: 1.25 through the interpolation, `4 pi s^2`
    /// through a smoothing of standard deviation `s`. Along the border of the mesh the smoothing gathers less noise.
    ///
    /// Only the scatter at convergence is predicted: neither the bias of interpolation and noise, nor that of a mesh too coarse for
    /// the field. The prediction is too large for [`Gradient::FiniteDifference`](crate::Gradient), as the sensitivity of the residual
    /// is that of the analytic gradient; too large with a smoothing as wide as a tenth of the cells, over which shape functions are
    /// taken as constant; and too small if the noise is not small beside the gradient of the reference image, to which it adds.
    ///
    /// At a displacement with the gradient `F` the covariance is `F C F^T`, and the noise of the deformed image is averaged over `det F`
    /// times as many pixels: a factor for each node, as if `det F` were the same in all cells that its displacement depends on.
    ///
    /// The cost is that of at most two factorisations and two selected inversions, about six factorisations, once for the reference
    /// image and the points used: the correlator keeps what it has found for all of them, and for the last other `information`. Another
    /// displacement or noise then takes milliseconds.
    ///
    /// # Errors
    ///
    /// [`Error`] if `noise` is negative or not finite, or the reference image cannot be viewed again; [`Error::Cancelled`] if `monitor`
    /// asks to stop.
    ///
    /// # Panics
    ///
    /// If there is information, but not of each cell.
    pub fn covariance(
        &self,
        noise: f64,
        displacement: Option<&[[f64; PLANE]]>,
        information: Option<&[Information]>,
        monitor: &dyn Monitor,
    ) -> Result<Covariance, Error> {
        assert!(information.is_none_or(|cells| cells.len() == self.dofs.mesh.num_cells()), "information of each cell");
        let at_rest = vec![[0.0; PLANE]; self.dofs.mesh.num_nodes()];
        let displacement = displacement.map(|field| self.dofs.restrict(field)).transpose()?.unwrap_or(at_rest);
        noise.check("noise", Some(NOISE))?;
        let reference = self.reference_covariance(information, monitor)?;
        Ok(in_pool(self.threads(), || Covariance::carried(reference, noise, displacement))?)
    }

    /// What the covariance is carried from; prepared if it is not kept.
    fn reference_covariance(
        &self,
        information: Option<&[Information]>,
        monitor: &dyn Monitor,
    ) -> Result<Arc<ReferenceCovariance>, Error> {
        if let Some(found) = self.covariances.find(information) {
            return Ok(found);
        }
        let prepare = |reference: ImageView<'_>| {
            ReferenceCovariance::prepare(&self.dofs, &self.level, reference, &self.options, information, monitor)
        };
        let found = Arc::new(in_pool(self.threads(), || view_of(self.reference.as_ref(), prepare))???);
        self.covariances.keep(information, &found);
        Ok(found)
    }
}
