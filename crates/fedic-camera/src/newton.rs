//! Newton's method for maps of the plane.

const MAX_ITERATIONS: usize = 30;

/// Derivatives of a map of the plane: row 0 is `(dx'/dx, dx'/dy)`.
pub(crate) type Jacobian2 = [[f64; 2]; 2];

/// What to do at an iterate with a given residual.
pub(crate) enum Verdict {
    /// Take a step and judge again.
    Iterate,
    /// Take a step and return without evaluating the map again: a step squares a small error.
    Finish,
    /// Return this iterate.
    Accept,
    /// Give up.
    Fail,
}

/// Solution of [`solve`].
pub(crate) struct Root {
    pub(crate) point: [f64; 2],
    /// Inverse of the last Jacobian evaluated.
    pub(crate) inverse: Jacobian2,
}

/// Solves `map(x) = target` from `start`; `map` returns its value and its Jacobian, and `judge` decides on the largest
/// component of the residual. `None` if `judge` gives up or never accepts.
#[inline]
pub(crate) fn solve(
    target: [f64; 2],
    start: [f64; 2],
    map: impl Fn([f64; 2]) -> ([f64; 2], Jacobian2),
    mut judge: impl FnMut(f64) -> Verdict,
) -> Option<Root> {
    let mut point = start;
    for _ in 0..MAX_ITERATIONS {
        let (value, jacobian) = map(point);
        let residual = [target[0] - value[0], target[1] - value[1]];
        let verdict = judge(residual[0].abs().max(residual[1].abs()));
        if matches!(verdict, Verdict::Fail) {
            return None;
        }
        let inverse = invert(jacobian);
        if matches!(verdict, Verdict::Accept) {
            return Some(Root { point, inverse });
        }
        point[0] += inverse[0][0] * residual[0] + inverse[0][1] * residual[1];
        point[1] += inverse[1][0] * residual[0] + inverse[1][1] * residual[1];
        if matches!(verdict, Verdict::Finish) {
            return Some(Root { point, inverse });
        }
    }
    None
}

/// Inverse of a 2x2 matrix; entries that are not finite if it is singular. One division, which nalgebra's `try_inverse`
/// makes four of.
#[inline]
fn invert([[a, b], [c, d]]: Jacobian2) -> Jacobian2 {
    let scale = 1.0 / (a * d - b * c);
    [[d * scale, -b * scale], [-c * scale, a * scale]]
}
