//! Calibration on the specimen: accuracy, independence of the number of threads, undetermined parameters.

#![allow(clippy::unwrap_used, missing_docs)]

use fedic::{
    BrownDistortion, CellType, Error, Image, Mesh, Monitor, MotionKind, OptionError, Parameter, Parametric, Pinhole,
    SelfCalibration, SelfCalibrationError, SelfCalibrationOptions, SpecimenImages, calibrate_on_specimen,
    calibrate_on_specimen_with, rectangle_mesh, rotation_from_vector, unproject,
};
use fedic_synthetic::Speckle;

const K1: f64 = -0.25;
const CENTRE: [f64; 2] = [83.0, 57.0];
const TRANSLATIONS: [[f64; 2]; 3] = [[31.0, -14.0], [-22.0, 26.0], [6.0, -33.0]];

fn camera(k1: f64, centre: [f64; 2]) -> Pinhole {
    let looking_down = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
    let camera = Pinhole::new([300.0; 2], centre, looking_down, [0.0, 0.0, 300.0]).unwrap();
    camera.with_distortion(BrownDistortion::new([k1, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap())
}

/// Image of the translated specimen, not rounded.
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
    translations: &[[f64; 2]],
    parameters: &[Parameter],
    options: &SelfCalibrationOptions,
    monitor: &dyn Monitor,
) -> Result<SelfCalibration, Error> {
    let images: Vec<Image> = std::iter::once(&[0.0; 2]).chain(translations).map(|&t| image(t)).collect();
    let start: Vec<_> = translations.iter().map(|[x, y]| [x + 0.4, y - 0.4]).collect();
    let input = SpecimenImages {
        images: &images.iter().map(Image::view).collect::<Vec<_>>(),
        mesh: &mesh(),
        camera: &camera(0.0, [79.5, 59.5]),
        parameters,
        translations: &start,
    };
    calibrate_on_specimen_with(&input, options, monitor)
}

const LENS: [Parameter; 3] = [Parameter::Lens("k1"), Parameter::Cx, Parameter::Cy];

#[test]
fn lens_centre_and_motions_are_recovered() {
    for motion in [MotionKind::Translation, MotionKind::InPlane, MotionKind::Spatial] {
        let options = SelfCalibrationOptions::default().motion(motion).smoothing(0.0);
        let found = calibrate(&TRANSLATIONS, &LENS, &options, &()).unwrap();
        assert!(found.converged, "{:?}", found.history);
        let k1 = found.camera.distortion().unwrap().coefficient("k1").unwrap();
        assert!((k1 / K1 - 1.0).abs() < 2e-3, "{motion:?}: {k1}");
        for (found, true_value) in found.camera.principal_point().into_iter().zip(CENTRE) {
            assert!((found - true_value).abs() < 0.1, "{motion:?}: {found} for {true_value}");
        }
        for (found, [x, y]) in found.motions.iter().zip(TRANSLATIONS) {
            let [dx, dy, _, rx, ry, rz] = [found[0] - x, found[1] - y, found[2], found[3], found[4], found[5]];
            assert!(dx.abs() < 0.02 && dy.abs() < 0.02, "{motion:?}: {found:?}");
            assert!(rx.abs() < 2e-3 && ry.abs() < 2e-3 && rz.abs() < 1e-4, "{motion:?}: {found:?}");
        }
    }
}

#[test]
fn known_translations_determine_the_scale() {
    let options = SelfCalibrationOptions::default().known_translations(true);
    let images: Vec<Image> = std::iter::once(&[0.0; 2]).chain(&TRANSLATIONS).map(|&t| image(t)).collect();
    let start = camera(K1, CENTRE).perturbed([(Parameter::Fx, 6.0), (Parameter::Tz, -3.0)]).unwrap();
    let input = SpecimenImages {
        images: &images.iter().map(Image::view).collect::<Vec<_>>(),
        mesh: &mesh(),
        camera: &start,
        parameters: &[Parameter::Fx, Parameter::Tz],
        translations: &TRANSLATIONS,
    };
    let found = calibrate_on_specimen(&input, &options).unwrap();
    assert!(found.converged);
    // fy and the scale fy / tz are exact initially and stay so: fx and tz are exact, too.
    assert!((found.camera.focal()[0] - 300.0).abs() < 0.1, "{:?}", found.camera);
    assert!((found.camera.translation()[2] - 300.0).abs() < 0.1, "{:?}", found.camera);
    assert_eq!(found.motion_standard_deviations[0][..2], [0.0; 2]);
    assert!(found.motion_standard_deviations[0][5] > 0.0);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let bits = |num_threads| -> Vec<u64> {
        let options = SelfCalibrationOptions::default().num_threads(num_threads);
        let found = calibrate(&TRANSLATIONS, &LENS, &options, &()).unwrap();
        let lens = found.camera.distortion().unwrap().coefficient("k1").unwrap();
        let motions = found.motions.iter().chain(&found.motion_standard_deviations).flatten();
        let iterations = found.history.iter().flat_map(|i| [&i.correction, &i.residual_rms]);
        let values = motions.chain(iterations).chain(&found.covariance).chain([&lens, &found.noise]);
        values.map(|value| value.to_bits()).collect()
    };
    let expected = bits(Some(1));
    for num_threads in [Some(1), Some(2), Some(4), None] {
        assert_eq!(bits(num_threads), expected, "{num_threads:?} threads");
    }
}

fn error_message(translations: &[[f64; 2]], parameters: &[Parameter]) -> String {
    calibrate(translations, parameters, &SelfCalibrationOptions::default(), &()).unwrap_err().to_string()
}

#[test]
fn undetermined_parameters_are_named() {
    use Parameter::{Cx, Fx, Fy, Tx, Tz};
    let [k1, d2] = ["k1", "d2"].map(Parameter::Lens);
    for (parameters, message) in [
        (&[k1, Cx, d2][..], "do not tell cx, d2 apart"),
        (&[k1, Fx, Fy], "a plane with unknown motions does not determine the scale: fix fx, fy and tz"),
        (&[k1, Tz], "do not determine tz; a plane with unknown motions does not determine the scale"),
        (&[k1, Tx], "do not determine tx; no image shows where the specimen is in its plane"),
    ] {
        let error = error_message(&TRANSLATIONS, parameters);
        assert!(error.contains(message), "{parameters:?}: {error}");
    }
}

#[test]
fn a_specimen_at_rest_is_an_error() {
    let error = error_message(&[[0.0, 0.0], [0.3, -0.2]], &LENS);
    assert!(error.contains("moves by no more than 0.") && error.contains("two directions"), "{error}");
}

#[test]
fn images_that_do_not_match_are_named() {
    let other: Vec<f32> = (0_u32..160 * 120).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as f32).collect();
    let images = [image([0.0; 2]), image(TRANSLATIONS[0]), Image::new(160, 120, other).unwrap()];
    let views: Vec<_> = images.iter().map(Image::view).collect();
    let options = SelfCalibrationOptions::default();
    let (mesh, camera) = (mesh(), camera(K1, CENTRE));
    let calibrate = |translations: &[[f64; 2]]| {
        let (mesh, camera) = (&mesh, &camera);
        let input = SpecimenImages { images: &views, mesh, camera, parameters: &[Parameter::Lens("k1")], translations };
        calibrate_on_specimen(&input, &options).unwrap_err()
    };
    let error = calibrate(&[TRANSLATIONS[0], [5.0, 5.0]]);
    assert!(matches!(error, Error::SelfCalibration(SelfCalibrationError::Unmatched { image: 2, .. })), "{error}");
    assert!(error.to_string().contains("moved image number 2 (from 1)"));
    let error = calibrate(&[TRANSLATIONS[0], [1e4, 0.0]]);
    assert_eq!(error, SelfCalibrationError::Unseen { image: 2 }.into());
}

#[test]
fn invalid_input_is_an_error() {
    let images = [image([0.0; 2]), image(TRANSLATIONS[0])];
    let views: Vec<_> = images.iter().map(Image::view).collect();
    let small = Image::new(20, 20, vec![1.0; 400]).unwrap();
    let flat = Image::new(160, 120, vec![7.0; 160 * 120]).unwrap();
    let (mesh, camera) = (mesh(), camera(K1, CENTRE));
    let calibrate = |images: &[_], parameters: &[Parameter], translations: &[_], options: SelfCalibrationOptions| {
        let input = SpecimenImages { images, mesh: &mesh, camera: &camera, parameters, translations };
        calibrate_on_specimen(&input, &options).unwrap_err().to_string()
    };
    let (k1, options) = ([Parameter::Lens("k1")], SelfCalibrationOptions::default);
    assert!(calibrate(&views[..1], &k1, &[], options()).contains("got 1 images and 0 translations"));
    assert!(calibrate(&views, &k1, &[[f64::NAN, 0.0]], options()).contains("1 translations, not all finite"));
    assert!(calibrate(&views, &[], &TRANSLATIONS[..1], options()).contains("got none"));
    assert!(calibrate(&views, &[k1[0]; 2], &TRANSLATIONS[..1], options()).contains("k1 is named twice"));
    assert!(calibrate(&[views[0], small.view()], &k1, &TRANSLATIONS[..1], options()).contains("20 x 20"));
    assert!(calibrate(&[flat.view(); 2], &k1, &TRANSLATIONS[..1], options()).contains("flat where the mesh lies"));
    let noise = options().noise(Some(-1.0));
    assert!(calibrate(&views, &k1, &TRANSLATIONS[..1], noise).contains("noise must be zero or a positive"));
    let density = options().density(0.0);
    assert!(calibrate(&views, &k1, &TRANSLATIONS[..1], density).contains("density must be"));
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
    let cancelled = calibrate(&TRANSLATIONS, &LENS, &SelfCalibrationOptions::default(), &Stop);
    assert_eq!(cancelled.unwrap_err(), Error::Cancelled);
}
