//! Random cameras shared by the tests.

// Every test file compiles its own copy and uses a part of it.
#![allow(dead_code)]

use fedic_camera::{
    BrownDistortion, Distortion, FrontParallel, InverseSplineDistortion, Pinhole, SplineDistortion, SplineField,
    rotation_from_vector,
};
use proptest::prelude::*;

/// A lens with all seven coefficients, as strong as real ones or somewhat stronger.
pub(crate) fn any_lens() -> impl Strategy<Value = BrownDistortion> {
    let radial = [-0.3..0.3, -0.2..0.2, -0.1..0.1];
    let small = || [-0.02..0.02, -0.02..0.02];
    (radial, small(), small())
        .prop_map(|(radial, decentering, prism)| BrownDistortion::new(radial, decentering, prism).unwrap())
}

/// A field of a few intervals with independent coefficients, steep as no lens is, that covers most of the view.
pub(crate) fn any_field() -> impl Strategy<Value = SplineField> {
    (1_usize..7, 1_usize..6).prop_flat_map(|(nx, ny)| {
        let step = 0.1 / nx.max(ny) as f64;
        proptest::collection::vec([-step..step, -step..step], (nx + 3) * (ny + 3))
            .prop_map(move |coefficients| SplineField::new([-0.35, -0.2, 0.3, 0.25], [nx, ny], coefficients).unwrap())
    })
}

/// A lens of any of the three kinds.
pub(crate) fn any_distortion() -> impl Strategy<Value = Distortion> {
    prop_oneof![
        any_lens().prop_map(Distortion::from),
        any_field().prop_map(|field| SplineDistortion::new(field).into()),
        any_field().prop_map(|field| InverseSplineDistortion::new(field).into()),
    ]
}

/// A camera about 2 units in front of the plane `Z = 0` and tilted by up to half a radian about each axis.
pub(crate) fn any_pose_pinhole() -> impl Strategy<Value = Pinhole> {
    let focal = [800.0..4000.0, 800.0..4000.0];
    let centre = [200.0..1200.0, 200.0..1200.0];
    let rotation = [-0.5..0.5, -0.5..0.5, -3.0..3.0];
    let translation = [-0.3..0.3, -0.3..0.3, 1.5..3.0];
    (focal, centre, rotation, translation, 1.3..1.8).prop_map(|(focal, centre, rotation, translation, skew)| {
        let pinhole = Pinhole::new(focal, centre, rotation_from_vector(rotation), translation).unwrap();
        pinhole.with_skew_angle(skew).unwrap()
    })
}

/// The same, most of them behind a lens that distorts.
pub(crate) fn any_pinhole() -> impl Strategy<Value = Pinhole> {
    (any_pose_pinhole(), proptest::option::of(any_distortion())).prop_map(|(pinhole, lens)| match lens {
        Some(lens) => pinhole.with_distortion(lens),
        None => pinhole,
    })
}

/// The same, with Brown's model if any: one whose coefficients can all be estimated.
pub(crate) fn any_brown_pinhole() -> impl Strategy<Value = Pinhole> {
    (any_pose_pinhole(), proptest::option::of(any_lens())).prop_map(|(pinhole, lens)| match lens {
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
