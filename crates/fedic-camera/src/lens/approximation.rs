//! Approximation of a lens by a spline field.

use super::spline_field::SplineField;
use crate::CameraError;

/// Intervals along the longer side of the first approximation, and of the finest.
const FEWEST_INTERVALS: usize = 8;
const MOST_INTERVALS: usize = 256;
/// Intervals by which a spline lens is extended on each side for another to approximate it.
pub(super) const MARGIN_INTERVALS: usize = 2;

/// The value at a point of the function to be approximated, and whether the lens is calibrated there.
pub(super) struct Sample {
    pub(super) value: [f64; 2],
    pub(super) covered: bool,
}

/// Finds the coarsest field that differs from a function by at most `tolerance` between the points it was fitted to.
pub(super) fn approximate(
    domain: [f64; 4],
    tolerance: f64,
    function: impl Fn([f64; 2]) -> Option<Sample>,
) -> Result<SplineField, CameraError> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(CameraError::NotPositive {
            parameter: "tolerance (normalised image coordinates)",
            value: tolerance,
        });
    }
    let sides = [domain[2] - domain[0], domain[3] - domain[1]];
    let longer = sides[0].max(sides[1]);
    let mut error = f64::INFINITY;
    let mut most = FEWEST_INTERVALS;
    while most <= MOST_INTERVALS {
        let intervals = sides.map(|side| ((most as f64 * side / longer).ceil() as usize).max(1));
        let out_of_reach = || CameraError::LensOutOfReach { domain };
        let value = |point| function(point).map(|sample| sample.value);
        let field = SplineField::fit(domain, intervals, value)?.ok_or_else(out_of_reach)?;
        error = largest_difference(&field, &function).ok_or_else(out_of_reach)?;
        if error <= tolerance {
            return Ok(field);
        }
        most *= 2;
    }
    Err(CameraError::ToleranceNotReached { tolerance, error })
}

/// Largest difference between a field and a function where the lens is calibrated, at the points furthest from those of the
/// fit.
fn largest_difference(field: &SplineField, function: impl Fn([f64; 2]) -> Option<Sample>) -> Option<f64> {
    let ([x0, y0, x1, y1], count) = (field.domain(), field.intervals().map(|intervals| 4 * intervals));
    let middle = |start: f64, end: f64, k: usize, count: usize| start + (end - start) * (k as f64 + 0.5) / count as f64;
    let mut largest = 0.0_f64;
    for j in 0..count[1] {
        for i in 0..count[0] {
            let point = [middle(x0, x1, i, count[0]), middle(y0, y1, j, count[1])];
            let (value, wanted) = (field.value(point), function(point)?);
            if wanted.covered {
                largest = largest.max((value[0] - wanted.value[0]).hypot(value[1] - wanted.value[1]));
            }
        }
    }
    Some(largest)
}
