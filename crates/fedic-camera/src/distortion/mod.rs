//! Lens distortion on the retinal plane, between the canonical projection and the intrinsic matrix (paper, Fig. 11 to 13).

mod brown;
mod inverse_spline;
mod newton;
mod spline;
mod spline_field;

pub use brown::BrownDistortion;
pub use inverse_spline::InverseSplineDistortion;
pub use spline::SplineDistortion;
pub use spline_field::SplineField;

use crate::CameraError;

/// Places between the optical axis and a point where a fold is looked for.
const FOLD_SAMPLES: u32 = 32;
/// Intervals by which a lens goes on beyond its domain for another to follow it.
const OVERHANG: usize = 2;
/// Intervals along the longer side an approximation begins with, and the most it may take.
const FEWEST_INTERVALS: usize = 8;
const MOST_INTERVALS: usize = 256;

/// The distortion of a lens: where it shows a point of the retinal plane.
#[derive(Debug, Clone, PartialEq)]
pub enum Distortion {
    /// Few coefficients.
    Brown(BrownDistortion),
    /// A field of displacements.
    Spline(SplineDistortion),
    /// A field of corrections.
    InverseSpline(InverseSplineDistortion),
}

impl From<BrownDistortion> for Distortion {
    fn from(lens: BrownDistortion) -> Self {
        Self::Brown(lens)
    }
}

impl From<SplineDistortion> for Distortion {
    fn from(lens: SplineDistortion) -> Self {
        Self::Spline(lens)
    }
}

impl From<InverseSplineDistortion> for Distortion {
    fn from(lens: InverseSplineDistortion) -> Self {
        Self::InverseSpline(lens)
    }
}

impl Distortion {
    /// The lens, where it is of Brown's model.
    pub fn brown(&self) -> Option<&BrownDistortion> {
        match self {
            Self::Brown(lens) => Some(lens),
            Self::Spline(_) | Self::InverseSpline(_) => None,
        }
    }

    /// The field, where the lens is made of one: of displacements or of corrections.
    pub fn field(&self) -> Option<&SplineField> {
        match self {
            Self::Brown(_) => None,
            Self::Spline(lens) => Some(lens.field()),
            Self::InverseSpline(lens) => Some(lens.field()),
        }
    }

    /// Where the lens shows the retinal point `(x, y)`; NaN where it cannot be told.
    #[inline]
    pub fn distort(&self, point: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Brown(lens) => lens.distort(point),
            Self::Spline(lens) => lens.distort(point),
            Self::InverseSpline(lens) => lens.distort(point),
        }
    }

    /// [`distort`](Self::distort) and its derivatives: row 0 is `(dx_d/dx, dx_d/dy)`.
    #[inline]
    pub fn distort_with_jacobian(&self, point: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        match self {
            Self::Brown(lens) => (lens.distort(point), lens.jacobian(point)),
            Self::Spline(lens) => lens.distort_with_jacobian(point),
            Self::InverseSpline(lens) => lens.distort_with_jacobian(point),
        }
    }

    /// The retinal point that the lens shows at `(x, y)`; `None` where there is none, or only beyond a fold of the model.
    pub fn undistort(&self, seen: [f64; 2]) -> Option<[f64; 2]> {
        let point = match self {
            Self::InverseSpline(lens) => lens.undistort(seen),
            Self::Brown(_) | Self::Spline(_) => {
                let [x, y] = self.distort(seen);
                let start = [2.0 * seen[0] - x, 2.0 * seen[1] - y];
                newton::solve(seen, start, |at| self.distort_with_jacobian(at))?.0
            }
        };
        (!self.folds_within(point)).then_some(point)
    }

    /// Whether a point of the retinal plane lies where the lens was calibrated: everywhere for Brown's model.
    pub fn covers(&self, point: [f64; 2]) -> bool {
        match self {
            Self::Brown(_) => true,
            Self::Spline(lens) => lens.field().contains(point),
            Self::InverseSpline(lens) => lens.field().contains(lens.distort(point)),
        }
    }

    /// The lens to follow over a domain that reaches somewhat beyond its own: there a field goes on as it does within, not
    /// linearly, whose kink no other field follows.
    fn extended(&self) -> Self {
        match self {
            Self::Brown(lens) => (*lens).into(),
            Self::Spline(lens) => SplineDistortion::new(lens.field().extended(OVERHANG)).into(),
            Self::InverseSpline(lens) => InverseSplineDistortion::new(lens.field().extended(OVERHANG)).into(),
        }
    }

    /// Whether the model folds the retinal plane between the optical axis and `(x, y)`: its Jacobian changes sign there,
    /// and what lies beyond is shown a second time.
    pub fn folds_within(&self, point: [f64; 2]) -> bool {
        let folds = |end: [f64; 2], jacobian: &dyn Fn([f64; 2]) -> [[f64; 2]; 2]| {
            (1..=FOLD_SAMPLES).any(|k| {
                let [[xx, xy], [yx, yy]] = jacobian(end.map(|c| c * f64::from(k) / f64::from(FOLD_SAMPLES)));
                xx * yy - xy * yx <= 0.0
            })
        };
        let gentle = |field: &SplineField, at: [f64; 2]| field.steepest() < 1.0 && field.contains(at);
        match self {
            Self::Brown(lens) => !lens.is_gentle_within(point) && folds(point, &|at| lens.jacobian(at)),
            Self::Spline(lens) => !gentle(lens.field(), point) && folds(point, &|at| lens.distort_with_jacobian(at).1),
            Self::InverseSpline(lens) => {
                let seen = lens.distort(point);
                !gentle(lens.field(), seen) && folds(seen, &|at| lens.undistort_with_jacobian(at).1)
            }
        }
    }
}

/// What a lens does at a point, as a field has it, and whether it is calibrated there.
struct Sample {
    value: [f64; 2],
    covered: bool,
}

/// The coarsest field that differs from a function by at most `tolerance` between the points it was made from.
fn approximation(
    domain: [f64; 4],
    tolerance: f64,
    function: impl Fn([f64; 2]) -> Option<Sample>,
) -> Result<SplineField, CameraError> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(CameraError::NotPositive { parameter: "tolerance (on the retinal plane)", value: tolerance });
    }
    let sides = [domain[2] - domain[0], domain[3] - domain[1]];
    let longer = sides[0].max(sides[1]);
    let mut error = f64::INFINITY;
    let mut most = FEWEST_INTERVALS;
    while most <= MOST_INTERVALS {
        let intervals = sides.map(|side| ((most as f64 * side / longer).ceil() as usize).max(1));
        let fault = CameraError::LensOutOfReach { domain };
        let value = |point| function(point).map(|sample| sample.value);
        let field = SplineField::approximating(domain, intervals, value)?.ok_or(fault.clone())?;
        error = largest_difference(&field, &function).ok_or(fault)?;
        if error <= tolerance {
            return Ok(field);
        }
        most *= 2;
    }
    Err(CameraError::TooRough { tolerance, error })
}

/// The largest difference of a field and a function, where it is covered, at the places furthest from those of the fit.
fn largest_difference(field: &SplineField, function: impl Fn([f64; 2]) -> Option<Sample>) -> Option<f64> {
    let ([x0, y0, x1, y1], count) = (field.domain(), field.intervals().map(|intervals| 4 * intervals));
    let place = |start: f64, end: f64, k: usize, count: usize| start + (end - start) * (k as f64 + 0.5) / count as f64;
    let mut largest = 0.0_f64;
    for j in 0..count[1] {
        for i in 0..count[0] {
            let point = [place(x0, x1, i, count[0]), place(y0, y1, j, count[1])];
            let (value, wanted) = (field.value(point), function(point)?);
            if wanted.covered {
                largest = largest.max((value[0] - wanted.value[0]).hypot(value[1] - wanted.value[1]));
            }
        }
    }
    Some(largest)
}
