//! What the images say of each unknown, and what they don't.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::self_calibration::error::{self, SelfCalibrationError};
use crate::self_calibration::motion::RIGID;
use crate::self_calibration::problem::{Problem, State};
use crate::self_calibration::sums::Sums;

/// Part of the effect of a parameter that must not be absorbed by the texture, and least eigenvalue of the normal matrix
/// scaled to a diagonal of ones.
const LEAST_VISIBLE: f64 = 1e-14;
const LEAST_EIGENVALUE: f64 = 1e-7;
/// Components of the direction of such an eigenvalue that are named, relative to the largest.
const NAMED: f64 = 0.1;
/// A standard deviation that moves a point by more than this part of the image's diagonal determines nothing.
const LARGEST_DEVIATION: f64 = 0.5;

pub(crate) const HOLD: &str =
    "hold one of them (leave it out of the parameters), or add images of the specimen moved elsewhere";
const HOLD_ONE: &str =
    "hold it (leave it out of the parameters), or add images of the specimen moved further and elsewhere";
const HOLD_SCALE: &str = "a plane whose motions are unknown has no scale: hold fx, fy and tz, or give the true translations (known_translations)";
const HOLD_PLACE: &str = "no image shows where the specimen is in its plane: hold tx, ty and rz";

/// Refuses unknowns that the images do not determine.
pub(crate) fn check_determined(problem: &Problem<'_>, sums: &Sums) -> Result<(), SelfCalibrationError> {
    let count = problem.parameters.len();
    if let Some(index) = (0..count).find(|&index| !sums.is_visible(index, LEAST_VISIBLE)) {
        return Err(undetermined(problem, vec![problem.parameters[index].to_string()]));
    }
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(sums.scaled().0);
    let least = eigenvalues.imin();
    if eigenvalues[least] >= LEAST_EIGENVALUE {
        return Ok(());
    }
    let direction = eigenvectors.column(least);
    let named = |unknowns: std::ops::Range<usize>| {
        let of_note = NAMED * direction.amax();
        unknowns
            .filter(|&unknown| direction[unknown].abs() >= of_note)
            .map(|unknown| name_of(problem, unknown))
            .collect()
    };
    let parameters: Vec<String> = named(0..count);
    Err(undetermined(problem, if parameters.is_empty() { named(count..direction.len()) } else { parameters }))
}

fn undetermined(problem: &Problem<'_>, names: Vec<String>) -> SelfCalibrationError {
    let among = |group: [&str; 3]| names.iter().any(|name| group.contains(&name.as_str()));
    let unknown_translations = problem.components.contains(&0);
    let advice = match names.len() {
        _ if unknown_translations && among(["fx", "fy", "tz"]) => HOLD_SCALE,
        _ if among(["tx", "ty", "rz"]) => HOLD_PLACE,
        1 => HOLD_ONE,
        _ => HOLD,
    };
    SelfCalibrationError::Undetermined { names, advice }
}

/// Refuses parameters known no better than half an image.
pub(crate) fn check_deviations(
    problem: &Problem<'_>,
    covariance: &DMatrix<f64>,
    sensitivities: &[f64],
    size: [usize; 2],
) -> Result<(), SelfCalibrationError> {
    let diagonal = (size[0] as f64).hypot(size[1] as f64);
    let lost = |index: usize| covariance[(index, index)].sqrt() * sensitivities[index] > LARGEST_DEVIATION * diagonal;
    match (0..problem.parameters.len()).find(|&index| lost(index)) {
        Some(index) => Err(undetermined(problem, vec![problem.parameters[index].to_string()])),
        None => Ok(()),
    }
}

/// Covariance of all unknowns, `variance A^-1 B A^-1`: `gathered` is `B`, the noise that the right-hand side gathers.
pub(crate) fn covariance(sums: &Sums, gathered: &Sums, variance: f64) -> Option<DMatrix<f64>> {
    let (scaled, scale) = sums.scaled();
    let inverse = scaled.cholesky()?.inverse();
    let spread = DMatrix::from_diagonal(&scale);
    let inverse = &spread * inverse * &spread;
    Some(&inverse * gathered.matrix() * &inverse * variance)
}

/// The largest way in pixels that one unit of each parameter moves a node in an image.
pub(crate) fn sensitivities(problem: &Problem<'_>, state: &State) -> Vec<f64> {
    let mut largest = vec![0.0_f64; problem.parameters.len()];
    let mut columns = vec![[0.0; 2]; problem.parameters.len()];
    for motion in &state.motions {
        for &node in problem.mesh.points() {
            state.camera.parameter_jacobian(motion.apply(node), problem.parameters, &mut columns);
            largest.iter_mut().zip(&columns).for_each(|(l, [u, v])| *l = l.max(u.hypot(*v)));
        }
    }
    largest
}

fn name_of(problem: &Problem<'_>, unknown: usize) -> String {
    const MOTIONS: [&str; RIGID] =
        ["X", "Y", "Z", "the rotation about X", "the rotation about Y", "the rotation about Z"];
    let layout = problem.layout();
    if let Some(parameter) = problem.parameters.get(unknown) {
        return parameter.to_string();
    }
    let (image, own) =
        ((unknown - layout.parameters) / layout.block_len(), (unknown - layout.parameters) % layout.block_len());
    match problem.components.get(own) {
        Some(&component) => format!("{} of the motion of {}", MOTIONS[component], error::name(image + 1)),
        None => format!("the brightness of {}", error::name(image + 1)),
    }
}
