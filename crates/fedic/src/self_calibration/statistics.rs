//! Covariance of the unknowns, and checks that the images determine them.

use fedic_camera::Parametric;
use nalgebra::{DMatrix, SymmetricEigen};

use crate::error::self_calibration::{SelfCalibrationError, image_name};
use crate::self_calibration::motion::RIGID;
use crate::self_calibration::normal_equations::CalibrationEquations;
use crate::self_calibration::problem::{Problem, State};

/// Smallest part of the effect of a parameter that a change of the texture must not explain.
const MIN_OBSERVABLE: f64 = 1e-14;
/// Smallest eigenvalue of the normal matrix scaled to a diagonal of ones.
const MIN_EIGENVALUE: f64 = 1e-7;
/// Smallest component of an undetermined direction, relative to its largest, that is named.
const MIN_NAMED_COMPONENT: f64 = 0.1;
/// Largest displacement of a point by one standard deviation of a parameter, relative to the diagonal of the image.
const MAX_DEVIATION: f64 = 0.5;

pub(crate) const FIX_SOME: &str =
    "fix one of them by leaving it out of the parameters, or add images of the specimen with other motions";
const FIX_ONE: &str =
    "fix it by leaving it out of the parameters, or add images of the specimen with larger motions in other directions";
const FIX_SCALE: &str = "a plane with unknown motions does not determine the scale: fix fx, fy and tz, or give the true \
                         translations (known_translations)";
const FIX_POSITION: &str = "no image shows where the specimen is in its plane: fix tx, ty and rz";

/// Checks that the images determine every unknown.
///
/// # Errors
///
/// [`SelfCalibrationError::Undetermined`] with the names of those that are not determined.
pub(crate) fn check_determined(
    problem: &Problem<'_>,
    equations: &CalibrationEquations,
) -> Result<(), SelfCalibrationError> {
    let count = problem.parameters.len();
    if let Some(index) = (0..count).find(|&index| !equations.is_observable(index, MIN_OBSERVABLE)) {
        return Err(undetermined(problem, vec![problem.parameters[index].to_string()]));
    }
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(equations.scaled().0);
    let smallest = eigenvalues.imin();
    if eigenvalues[smallest] >= MIN_EIGENVALUE {
        return Ok(());
    }
    let direction = eigenvectors.column(smallest);
    let named = |unknowns: std::ops::Range<usize>| {
        let threshold = MIN_NAMED_COMPONENT * direction.amax();
        unknowns
            .filter(|&unknown| direction[unknown].abs() >= threshold)
            .map(|unknown| name_of(problem, unknown))
            .collect()
    };
    let parameters: Vec<String> = named(0..count);
    Err(undetermined(problem, if parameters.is_empty() { named(count..direction.len()) } else { parameters }))
}

fn undetermined(problem: &Problem<'_>, names: Vec<String>) -> SelfCalibrationError {
    let any_of = |group: [&str; 3]| names.iter().any(|name| group.contains(&name.as_str()));
    let unknown_translations = problem.components.contains(&0);
    let advice = match names.len() {
        _ if unknown_translations && any_of(["fx", "fy", "tz"]) => FIX_SCALE,
        _ if any_of(["tx", "ty", "rz"]) => FIX_POSITION,
        1 => FIX_ONE,
        _ => FIX_SOME,
    };
    SelfCalibrationError::Undetermined { names, advice }
}

/// Checks that no standard deviation of a parameter displaces points by more than [`MAX_DEVIATION`].
///
/// # Errors
///
/// [`SelfCalibrationError::Undetermined`] for the first such parameter.
pub(crate) fn check_deviations(
    problem: &Problem<'_>,
    covariance: &DMatrix<f64>,
    sensitivities: &[f64],
    size: [usize; 2],
) -> Result<(), SelfCalibrationError> {
    let diagonal = (size[0] as f64).hypot(size[1] as f64);
    let is_too_large =
        |index: usize| covariance[(index, index)].sqrt() * sensitivities[index] > MAX_DEVIATION * diagonal;
    match (0..problem.parameters.len()).find(|&index| is_too_large(index)) {
        Some(index) => Err(undetermined(problem, vec![problem.parameters[index].to_string()])),
        None => Ok(()),
    }
}

/// Covariance of all unknowns, `variance A^-1 B A^-1`, where `A` is the normal matrix of `equations` and `B` that of
/// `rhs_covariance`, the covariance of the right-hand side for noise of variance one.
pub(crate) fn covariance(
    equations: &CalibrationEquations,
    rhs_covariance: &CalibrationEquations,
    variance: f64,
) -> Option<DMatrix<f64>> {
    let (scaled, scale) = equations.scaled();
    let inverse = scaled.cholesky()?.inverse();
    let scale = DMatrix::from_diagonal(&scale);
    let inverse = &scale * inverse * &scale;
    Some(&inverse * rhs_covariance.matrix() * &inverse * variance)
}

/// Largest displacement of a node in any image per unit of each parameter, in pixels.
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

/// Name of an unknown in messages.
fn name_of(problem: &Problem<'_>, unknown: usize) -> String {
    const COMPONENTS: [&str; RIGID] =
        ["X", "Y", "Z", "the rotation about X", "the rotation about Y", "the rotation about Z"];
    let layout = problem.layout();
    if let Some(parameter) = problem.parameters.get(unknown) {
        return parameter.to_string();
    }
    let (image, own) =
        ((unknown - layout.parameters) / layout.block_len(), (unknown - layout.parameters) % layout.block_len());
    match problem.components.get(own) {
        Some(&component) => format!("{} of the motion of {}", COMPONENTS[component], image_name(image + 1)),
        None => format!("the brightness of {}", image_name(image + 1)),
    }
}
