//! Calibration on the specimen: accuracy, independence of the number of threads, undetermined parameters.

#![allow(clippy::unwrap_used, missing_docs)]

use fedic::{
    BrownDistortion, CellType, Error, Image, Mesh, Monitor, MotionKind, OptionError, Parameter, Pinhole,
    SelfCalibration, SelfCalibrationError, SelfCalibrationOptions, calibrate_on_specimen, rectangle_mesh,
    rotation_from_vector, unproject,
};
use fedic_synthetic::Speckle;

const K1: f64 = -0.25;
const CENTRE: [f64; 2] = [83.0, 57.0];
const MOTIONS: [[f64; 2]; 3] = [[31.0, -14.0], [-22.0, 26.0], [6.0, -33.0]];

fn camera(k1: f64, centre: [f64; 2]) -> Pinhole {
    let looking_down = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
    let camera = Pinhole::new([300.0; 2], centre, looking_down, [0.0, 0.0, 300.0]).unwrap();
    camera.with_distortion(BrownDistortion::new([k1, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap())
}

/// Image of the specimen after a motion, not rounded.
fn image([x, y]: [f64; 2]) -> Image {
    let (camera, speckle) = (camera(K1, CENTRE), Speckle::new(6.0, 0.5, 8).unwrap());
    let pixels = (0..160 * 120).map(|k| unproject(&camera, [(k % 160) as f64, (k / 160) as f64], 0.0).unwrap());
    let greys = pixels.map(|[px, py, _]| (30.0 + 190.0 * speckle.value([px - x, py - y])) as f32);
    Image::new(160, 120, greys.collect()).unwrap()
}

fn mesh() -> Mesh {
    rectangle_mesh([-80.0, -60.0, 80.0, 60.0], 10.0, CellType::Quad).unwrap()
}

fn calibrate(
    motions: &[[f64; 2]],
    parameters: &[Parameter],
    options: &SelfCalibrationOptions,
    monitor: &dyn Monitor,
) -> Result<SelfCalibration, Error> {
    let images: Vec<Image> = std::iter::once(&[0.0; 2]).chain(motions).map(|&motion| image(motion)).collect();
    let views: Vec<_> = images.iter().map(Image::view).collect();
    let start: Vec<_> = motions.iter().map(|[x, y]| [x + 0.4, y - 0.4]).collect();
    calibrate_on_specimen(&views, &mesh(), &camera(0.0, [79.5, 59.5]), parameters, &start, options, monitor)
}

const LENS: [Parameter; 3] = [Parameter::K1, Parameter::Cx, Parameter::Cy];

#[test]
fn lens_centre_and_motions_are_recovered() {
    for motion in [MotionKind::Translation, MotionKind::InPlane, MotionKind::Spatial] {
        let options = SelfCalibrationOptions::default().motion(motion).smoothing(0.0);
        let found = calibrate(&MOTIONS, &LENS, &options, &()).unwrap();
        assert!(found.converged, "{:?}", found.history);
        let k1 = found.camera.distortion().unwrap().brown().unwrap().radial()[0];
        assert!((k1 / K1 - 1.0).abs() < 2e-3, "{motion:?}: {k1}");
        for (found, true_value) in found.camera.principal_point().into_iter().zip(CENTRE) {
            assert!((found - true_value).abs() < 0.1, "{motion:?}: {found} for {true_value}");
        }
        for (found, [x, y]) in found.motions.iter().zip(MOTIONS) {
            let [dx, dy, _, rx, ry, rz] = [found[0] - x, found[1] - y, found[2], found[3], found[4], found[5]];
            assert!(dx.abs() < 0.02 && dy.abs() < 0.02, "{motion:?}: {found:?}");
            assert!(rx.abs() < 2e-3 && ry.abs() < 2e-3 && rz.abs() < 1e-4, "{motion:?}: {found:?}");
        }
    }
}

#[test]
fn known_translations_determine_the_scale() {
    let options = SelfCalibrationOptions::default().known_translations(true);
    let images: Vec<Image> = std::iter::once(&[0.0; 2]).chain(&MOTIONS).map(|&motion| image(motion)).collect();
    let views: Vec<_> = images.iter().map(Image::view).collect();
    let start = camera(K1, CENTRE).moved_by(&[Parameter::Fx, Parameter::Tz], &[6.0, -3.0]).unwrap();
    let parameters = [Parameter::Fx, Parameter::Tz];
    let found = calibrate_on_specimen(&views, &mesh(), &start, &parameters, &MOTIONS, &options, &()).unwrap();
    assert!(found.converged);
    // fy and the scale fy / tz are correct at the start and stay so: hence fx and tz too.
    assert!((found.camera.focal()[0] - 300.0).abs() < 0.1, "{:?}", found.camera);
    assert!((found.camera.translation()[2] - 300.0).abs() < 0.1, "{:?}", found.camera);
    assert_eq!(found.motion_deviations[0][..2], [0.0; 2]);
    assert!(found.motion_deviations[0][5] > 0.0);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let bits = |num_threads| -> Vec<u64> {
        let options = SelfCalibrationOptions::default().num_threads(num_threads);
        let found = calibrate(&MOTIONS, &LENS, &options, &()).unwrap();
        let lens = found.camera.distortion().unwrap().brown().unwrap().radial()[0];
        let motions = found.motions.iter().chain(&found.motion_deviations).flatten();
        let iterations = found.history.iter().flat_map(|i| [&i.correction, &i.residual_rms]);
        let numbers = motions.chain(iterations).chain(&found.covariance).chain([&lens, &found.noise]);
        numbers.map(|number| number.to_bits()).collect()
    };
    let alone = bits(Some(1));
    for num_threads in [Some(1), Some(2), Some(4), None] {
        assert_eq!(bits(num_threads), alone, "{num_threads:?} threads");
    }
}

fn refused(motions: &[[f64; 2]], parameters: &[Parameter]) -> String {
    calibrate(motions, parameters, &SelfCalibrationOptions::default(), &()).unwrap_err().to_string()
}

#[test]
fn undetermined_parameters_are_named() {
    use Parameter::{Cx, D2, Fx, Fy, K1, Tx, Tz};
    for (parameters, message) in [
        (&[K1, Cx, D2][..], "do not tell cx, d2 apart"),
        (&[K1, Fx, Fy], "a plane whose motions are unknown has no scale: hold fx, fy and tz"),
        (&[K1, Tz], "do not determine tz; a plane whose motions are unknown has no scale"),
        (&[K1, Tx], "do not determine tx; no image shows where the specimen is in its plane"),
    ] {
        let error = refused(&MOTIONS, parameters);
        assert!(error.contains(message), "{parameters:?}: {error}");
    }
}

#[test]
fn a_specimen_at_rest_is_refused() {
    let error = refused(&[[0.0, 0.0], [0.3, -0.2]], &LENS);
    assert!(error.contains("moves by no more than 0.") && error.contains("two directions"), "{error}");
}

#[test]
fn images_that_do_not_match_are_named() {
    let other: Vec<f32> = (0_u32..160 * 120).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as f32).collect();
    let images = [image([0.0; 2]), image(MOTIONS[0]), Image::new(160, 120, other).unwrap()];
    let views: Vec<_> = images.iter().map(Image::view).collect();
    let options = SelfCalibrationOptions::default();
    let start = [MOTIONS[0], [5.0, 5.0]];
    let error = calibrate_on_specimen(&views, &mesh(), &camera(K1, CENTRE), &[Parameter::K1], &start, &options, &());
    let error = error.unwrap_err();
    assert!(matches!(error, Error::SelfCalibration(SelfCalibrationError::Unmatched { image: 2, .. })), "{error}");
    assert!(error.to_string().contains("moved image number 2 (from 1)"));
    let far = [MOTIONS[0], [1e4, 0.0]];
    let error = calibrate_on_specimen(&views, &mesh(), &camera(K1, CENTRE), &[Parameter::K1], &far, &options, &());
    assert_eq!(error.unwrap_err(), SelfCalibrationError::Unseen { image: 2 }.into());
}

#[test]
fn bad_input_is_refused() {
    let images = [image([0.0; 2]), image(MOTIONS[0])];
    let views: Vec<_> = images.iter().map(Image::view).collect();
    let small = Image::new(20, 20, vec![1.0; 400]).unwrap();
    let flat = Image::new(160, 120, vec![7.0; 160 * 120]).unwrap();
    let calibrate = |views: &[_], parameters: &[Parameter], start: &[[f64; 2]], options: SelfCalibrationOptions| {
        let camera = camera(K1, CENTRE);
        calibrate_on_specimen(views, &mesh(), &camera, parameters, start, &options, &()).unwrap_err().to_string()
    };
    let (k1, options) = ([Parameter::K1], SelfCalibrationOptions::default);
    assert!(calibrate(&views[..1], &k1, &[], options()).contains("got 1 images and 0 finite translations"));
    assert!(calibrate(&views, &k1, &[[f64::NAN, 0.0]], options()).contains("finite translations"));
    assert!(calibrate(&views, &[], &MOTIONS[..1], options()).contains("got none"));
    assert!(calibrate(&views, &[k1[0]; 2], &MOTIONS[..1], options()).contains("k1 is named twice"));
    assert!(calibrate(&[views[0], small.view()], &k1, &MOTIONS[..1], options()).contains("20 x 20"));
    assert!(calibrate(&[flat.view(); 2], &k1, &MOTIONS[..1], options()).contains("flat where the mesh lies"));
    let noise = options().noise(Some(-1.0));
    assert!(calibrate(&views, &k1, &MOTIONS[..1], noise).contains("noise must be zero or a positive"));
    let density = options().density(0.0);
    assert!(calibrate(&views, &k1, &MOTIONS[..1], density).contains("density must be"));
    assert!(matches!("sideways".parse::<MotionKind>(), Err(OptionError::Invalid { option: "motion", .. })));
}

#[test]
fn a_calibration_can_be_cancelled() {
    struct Stop;
    impl Monitor for Stop {
        fn cancelled(&self) -> bool {
            true
        }
    }
    let cancelled = calibrate(&MOTIONS, &LENS, &SelfCalibrationOptions::default(), &Stop);
    assert_eq!(cancelled.unwrap_err(), Error::Cancelled);
}
