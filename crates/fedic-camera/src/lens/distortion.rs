//! A lens of any model.

use super::coefficients::{CoefficientGroup, names};
use super::domain::{Domain, Plane};
use super::model::Lens;
use super::models::*;
use super::spline_field::SplineField;
use crate::CameraError;
use crate::newton::Jacobian2;

/// A computation that is compiled for each lens model, see [`Distortion::visit`].
pub trait LensVisitor {
    /// Result of the computation.
    type Output;

    /// Runs the computation with a lens.
    fn visit(self, lens: &impl Lens) -> Self::Output;
}

/// Name and coefficients of a lens model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct ModelSummary {
    /// Name of the model in camera files and calibrations.
    pub name: &'static str,
    /// Groups of coefficients.
    pub groups: &'static [CoefficientGroup],
}

/// Defines [`Distortion`] from the list of the lens models.
macro_rules! define_distortion {
    ($($variant:ident($lens:ident: $kind:ident)),+ $(,)?) => {
        /// A lens of any model: an enum, so that the calls are dispatched statically.
        ///
        /// Its methods are those of [`Lens`].
        #[derive(Debug, Clone, PartialEq)]
        #[non_exhaustive]
        pub enum Distortion {
            $(#[doc = concat!("A [`", stringify!($lens), "`].")] $variant($lens),)+
        }

        $(
            impl From<$lens> for Distortion {
                fn from(lens: $lens) -> Self {
                    Self::$variant(lens)
                }
            }
        )+

        impl Distortion {
            /// All lens models, in the order of the list.
            pub const MODELS: &'static [ModelSummary] = &[$(ModelSummary { name: $lens::MODEL, groups: $lens::GROUPS }),+];

            /// Runs a computation that is compiled for each lens model: one dispatch for many points.
            #[inline]
            pub fn visit<V: LensVisitor>(&self, visitor: V) -> V::Output {
                match self {
                    $(Self::$variant(lens) => visitor.visit(lens),)+
                }
            }

            /// See [`Lens::MODEL`].
            pub fn model(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $lens::MODEL,)+
                }
            }

            /// See [`Lens::GROUPS`].
            pub fn groups(&self) -> &'static [CoefficientGroup] {
                match self {
                    $(Self::$variant(_) => $lens::GROUPS,)+
                }
            }

            /// See [`Lens::distort`].
            #[inline]
            pub fn distort(&self, point: [f64; 2]) -> [f64; 2] {
                match self {
                    $(Self::$variant(lens) => lens.distort(point),)+
                }
            }

            /// See [`Lens::distort_with_jacobian`].
            #[inline]
            pub fn distort_with_jacobian(&self, point: [f64; 2]) -> ([f64; 2], Jacobian2) {
                match self {
                    $(Self::$variant(lens) => lens.distort_with_jacobian(point),)+
                }
            }

            /// See [`Lens::undistort`].
            pub fn undistort(&self, distorted: [f64; 2]) -> Option<[f64; 2]> {
                match self {
                    $(Self::$variant(lens) => lens.undistort(distorted),)+
                }
            }

            /// See [`Lens::folds_within`].
            pub fn folds_within(&self, point: [f64; 2]) -> bool {
                match self {
                    $(Self::$variant(lens) => lens.folds_within(point),)+
                }
            }

            /// See [`Lens::domain`].
            pub fn domain(&self) -> Option<Domain> {
                match self {
                    $(Self::$variant(lens) => lens.domain(),)+
                }
            }

            /// See [`Lens::bounding_box`].
            ///
            /// # Errors
            ///
            /// [`CameraError`] if the lens is not limited to a domain, or folds at its border.
            pub fn bounding_box(&self, plane: Plane) -> Result<[f64; 4], CameraError> {
                match self {
                    $(Self::$variant(lens) => lens.bounding_box(plane),)+
                }
            }

            /// See [`Lens::covers`].
            pub fn covers(&self, point: [f64; 2]) -> bool {
                match self {
                    $(Self::$variant(lens) => lens.covers(point),)+
                }
            }

            /// See [`Lens::is_piecewise`].
            pub fn is_piecewise(&self) -> bool {
                match self {
                    $(Self::$variant(lens) => lens.is_piecewise(),)+
                }
            }

            /// See [`Lens::field`].
            pub fn field(&self) -> Option<&SplineField> {
                match self {
                    $(Self::$variant(lens) => lens.field(),)+
                }
            }

            /// See [`Lens::extended`].
            #[must_use]
            pub fn extended(&self) -> Self {
                match self {
                    $(Self::$variant(lens) => lens.extended().into(),)+
                }
            }

            /// See [`Lens::coefficients`].
            pub fn coefficients(&self) -> &[f64] {
                match self {
                    $(Self::$variant(lens) => lens.coefficients(),)+
                }
            }

            /// See [`Lens::with_coefficients`].
            ///
            /// # Errors
            ///
            /// [`CameraError`] if the number of coefficients is wrong or one of them is not finite.
            pub fn with_coefficients(&self, coefficients: &[f64]) -> Result<Self, CameraError> {
                match self {
                    $(Self::$variant(lens) => lens.with_coefficients(coefficients).map(Self::from),)+
                }
            }

            /// See [`Lens::coefficient_derivative`].
            #[inline]
            pub fn coefficient_derivative(&self, point: [f64; 2], index: usize) -> [f64; 2] {
                match self {
                    $(Self::$variant(lens) => lens.coefficient_derivative(point, index),)+
                }
            }
        }
    };
}

crate::for_each_lens!(define_distortion);

impl Distortion {
    /// Names of the coefficients, in the order of [`coefficients`](Self::coefficients).
    pub fn coefficient_names(&self) -> impl Iterator<Item = &'static str> + use<> {
        names(self.groups())
    }

    /// Value of the coefficient of this name, if the model has it.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{BrownDistortion, Distortion};
    /// let lens: Distortion = BrownDistortion::new([-0.2, 0.05, 0.0], [1e-3, 0.0], [0.0; 2])?.into();
    /// assert_eq!((lens.coefficient("k2"), lens.coefficient("k9")), (Some(0.05), None));
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn coefficient(&self, name: &str) -> Option<f64> {
        let index = self.coefficient_names().position(|known| known == name)?;
        self.coefficients().get(index).copied()
    }
}
