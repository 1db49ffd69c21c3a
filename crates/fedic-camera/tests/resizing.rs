//! Cameras of regions of an image and of binned images.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{any_front_parallel, any_pinhole, any_point};
use fedic_camera::{CameraError, ImageFrame, Parameter, Parametric, Pinhole, Resizable, rotation_from_vector};
use proptest::prelude::*;

/// Compares the image points of a region and of binned images with those of the image.
fn check(camera: &impl Resizable, point: [f64; 3], origin: [u32; 2], n: u32) -> Result<(), TestCaseError> {
    let ([u, v], jacobian) = camera.project_with_jacobian(point);
    let region = camera.cropped(origin, [300, 200]).unwrap();
    let binned = camera.binned(n).unwrap();
    prop_assert_eq!(region.image_size(), Some([300, 200]));
    prop_assert_eq!(binned.image_size(), camera.image_size().map(|size| size.map(|pixels| pixels / n)));
    let k = f64::from(n);
    let cases = [
        (region.project_with_jacobian(point), [u - f64::from(origin[0]), v - f64::from(origin[1])], 1.0),
        (binned.project_with_jacobian(point), [(u + 0.5) / k - 0.5, (v + 0.5) / k - 0.5], 1.0 / k),
    ];
    for ((pixel, derivatives), expected, scale) in cases {
        prop_assert_eq!(pixel[0].is_nan(), expected[0].is_nan());
        for i in 0..2 {
            prop_assert!(pixel[i].is_nan() || (pixel[i] - expected[i]).abs() <= 1e-9 * (1.0 + expected[i].abs()));
            for d in 0..3 {
                let wanted = scale * jacobian[i][d];
                prop_assert!(wanted.is_nan() || (derivatives[i][d] - wanted).abs() <= 1e-9 * (1.0 + wanted.abs()));
            }
        }
    }
    prop_assert_eq!(region.covers(point), camera.covers(point));
    prop_assert_eq!(binned.covers(point), camera.covers(point));
    Ok(())
}

proptest! {
    #[test]
    fn regions_and_binned_images_show_the_same_points(
        pinhole in any_pinhole(),
        front in any_front_parallel(),
        point in any_point(),
        origin in [0..900_u32, 0..700_u32],
        n in 1..9_u32,
    ) {
        let size = Some([1201, 902]);
        check(&pinhole.with_image_size(size).unwrap(), point, origin, n)?;
        check(&front.with_image_size(None).unwrap(), point, origin, n)?;
        check(&ImageFrame::new(0.7, [3.0, -4.0]).unwrap().with_image_size(size).unwrap(), point, origin, n)?;
    }
}

#[test]
fn regions_outside_the_image_and_empty_images_are_refused() {
    let camera = ImageFrame.with_image_size(Some([640, 480])).unwrap();
    assert!(camera.cropped([540, 400], [100, 80]).is_ok());
    assert_eq!(
        camera.cropped([541, 400], [100, 80]),
        Err(CameraError::OutsideImage { origin: [541, 400], size: [100, 80], image: [640, 480] })
    );
    assert!(camera.cropped([u32::MAX, 0], [u32::MAX, 1]).is_err());
    assert_eq!(camera.cropped([0, 0], [0, 80]), Err(CameraError::EmptyImage { size: [0, 80] }));
    assert_eq!(camera.binned(481), Err(CameraError::EmptyImage { size: [1, 0] }));
    assert!(matches!(camera.binned(0), Err(CameraError::NotPositive { .. })));
    assert!(matches!(camera.with_image_size(Some([3, 0])), Err(CameraError::EmptyImage { .. })));
}

#[test]
fn other_parameters_keep_the_size_of_the_image() {
    let upright = rotation_from_vector([0.0; 3]);
    let camera = Pinhole::new([900.0; 2], [320.0, 240.0], upright, [0.0, 0.0, 2.0]).unwrap();
    let camera = camera.with_image_size(Some([640, 480])).unwrap();
    assert_eq!(camera.perturbed([(Parameter::Fx, 1.0)]).unwrap().image_size(), Some([640, 480]));
    let front = fedic_camera::FrontParallel::new(2.0, [0.0; 2]).unwrap().with_image_size(Some([7, 5])).unwrap();
    assert_eq!(front.perturbed([(Parameter::Angle, 0.1)]).unwrap().image_size(), Some([7, 5]));
    assert_ne!(front, front.with_image_size(None).unwrap());
}
