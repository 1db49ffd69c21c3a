//! The lens models and their list.

mod brown;
mod inverse_spline;
mod spline;

pub use brown::BrownDistortion;
pub use inverse_spline::InverseSplineDistortion;
pub use spline::SplineDistortion;

/// The list of the lens models: passes `Variant(Type: kind)` of each to a macro.
///
/// The kind is `coefficients` for a lens of a few numbers, which implements `Default`, or `field` for a lens that is made
/// from a [`SplineField`](crate::SplineField).
///
/// # Examples
///
/// ```
/// macro_rules! count {
///     ($($variant:ident($lens:ident: $kind:ident)),+ $(,)?) => { [$(stringify!($lens)),+].len() };
/// }
/// assert_eq!(fedic_camera::for_each_lens!(count), fedic_camera::Distortion::MODELS.len());
/// ```
#[macro_export]
macro_rules! for_each_lens {
    ($($callback:tt)+) => {
        $($callback)+! {
            Brown(BrownDistortion: coefficients),
            Spline(SplineDistortion: field),
            InverseSpline(InverseSplineDistortion: field),
        }
    };
}
