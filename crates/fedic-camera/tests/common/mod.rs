//! Random lenses and cameras shared by the tests.

// Every test file compiles its own copy and uses a part of it.
#![allow(dead_code)]

use fedic_camera::lens::{Lens, *};
use fedic_camera::{FrontParallel, Pinhole, for_each_lens, rotation_from_vector};
use proptest::prelude::*;
use proptest::strategy::Union;

/// The lens models with random lenses of each: a new entry of the list is tested without a change here.
pub(crate) fn lens_models() -> Vec<(&'static str, BoxedStrategy<Distortion>)> {
    macro_rules! any {
        (coefficients, $lens:ident) => {
            any_coefficients::<$lens>()
        };
        (field, $lens:ident) => {
            any_field().prop_map(|field| $lens::new(field).into()).boxed()
        };
    }
    macro_rules! models {
        ($($variant:ident($lens:ident: $kind:ident)),+ $(,)?) => { vec![$(($lens::MODEL, any!($kind, $lens))),+] };
    }
    for_each_lens!(models)
}

/// A lens of few coefficients, each up to 0.05.
fn any_coefficients<L: Lens + Default + Into<Distortion> + 'static>() -> BoxedStrategy<Distortion> {
    let count = L::GROUPS.iter().map(|group| group.coefficients.len()).sum::<usize>();
    proptest::collection::vec(-0.05..0.05, count)
        .prop_map(|coefficients| L::default().with_coefficients(&coefficients).unwrap().into())
        .boxed()
}

/// A lens of any model.
pub(crate) fn any_distortion() -> impl Strategy<Value = Distortion> {
    Union::new(lens_models().into_iter().map(|(_, lenses)| lenses))
}

/// A lens of Brown's model with all seven coefficients, as strong as real ones or somewhat stronger.
pub(crate) fn any_brown() -> impl Strategy<Value = BrownDistortion> {
    let radial = [-0.3..0.3, -0.2..0.2, -0.1..0.1];
    let small = || [-0.02..0.02, -0.02..0.02];
    (radial, small(), small())
        .prop_map(|(radial, decentering, prism)| BrownDistortion::new(radial, decentering, prism).unwrap())
}

/// A field of a few intervals with independent coefficients, steeper than those of real lenses, over most of the view.
pub(crate) fn any_field() -> impl Strategy<Value = SplineField> {
    (1_usize..7, 1_usize..6).prop_flat_map(|(nx, ny)| {
        let step = 0.1 / nx.max(ny) as f64;
        proptest::collection::vec([-step..step, -step..step], (nx + 3) * (ny + 3))
            .prop_map(move |coefficients| SplineField::new([-0.35, -0.2, 0.3, 0.25], [nx, ny], coefficients).unwrap())
    })
}

/// A camera about 2 units in front of the plane `Z = 0`, tilted by up to half a radian about each axis.
pub(crate) fn any_undistorted_pinhole() -> impl Strategy<Value = Pinhole> {
    let focal = [800.0..4000.0, 800.0..4000.0];
    let centre = [200.0..1200.0, 200.0..1200.0];
    let rotation = [-0.5..0.5, -0.5..0.5, -3.0..3.0];
    let translation = [-0.3..0.3, -0.3..0.3, 1.5..3.0];
    (focal, centre, rotation, translation, 1.3..1.8).prop_map(|(focal, centre, rotation, translation, skew)| {
        let pinhole = Pinhole::new(focal, centre, rotation_from_vector(rotation), translation).unwrap();
        pinhole.with_skew_angle(skew).unwrap()
    })
}

/// A camera without a lens, with a strong Brown lens, or with a lens of any model.
pub(crate) fn any_pinhole() -> impl Strategy<Value = Pinhole> {
    let lens = Union::new([any_distortion().boxed(), any_brown().prop_map(Distortion::from).boxed()]);
    (any_undistorted_pinhole(), proptest::option::weighted(0.8, lens)).prop_map(|(pinhole, lens)| match lens {
        Some(lens) => pinhole.with_distortion(lens),
        None => pinhole,
    })
}

pub(crate) fn any_front_parallel() -> impl Strategy<Value = FrontParallel> {
    (1.0..1000.0, [-500.0..1500.0, -500.0..1500.0], prop_oneof![Just(0.0), -4.0..4.0])
        .prop_map(|(scale, origin, angle)| FrontParallel::new(scale, origin).unwrap().with_angle(angle).unwrap())
}

/// A world point that these cameras see.
pub(crate) fn any_point() -> impl Strategy<Value = [f64; 3]> {
    [-0.4..0.4, -0.4..0.4, -0.1..0.1]
}

/// Step and tolerance of [`derivative`] for smooth functions, and for piecewise ones: at the border of a spline's domain
/// its second derivative jumps.
pub(crate) const SMOOTH: (f64, f64) = (1e-3, 3e-10);
pub(crate) const PIECEWISE: (f64, f64) = (1e-6, 1e-5);

/// Derivative of `f` at 0 by central differences of fourth order.
pub(crate) fn derivative(step: f64, f: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let [far_back, back, forward, far] = [-2.0, -1.0, 1.0, 2.0].map(|k| f(k * step));
    [0, 1].map(|r| (8.0 * (forward[r] - back[r]) - (far[r] - far_back[r])) / (12.0 * step))
}

/// Distance of two points.
pub(crate) fn distance([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a - c).hypot(b - d)
}
