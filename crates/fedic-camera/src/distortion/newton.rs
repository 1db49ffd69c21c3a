//! The plane point that a smooth map takes to a given point.

const MAX_NEWTON: usize = 30;
/// Relative to one plus the size of a coordinate: one more step squares such an error, which leaves rounding.
const LAST: f64 = 1e-8;

/// Solves `map(x) = target` from `start` by Newton's method; `map` gives its value and its Jacobian. The solution, and the inverse
/// of the Jacobian there; `None` where the iteration does not converge.
#[inline]
pub(super) fn solve(
    target: [f64; 2],
    start: [f64; 2],
    map: impl Fn([f64; 2]) -> ([f64; 2], [[f64; 2]; 2]),
) -> Option<([f64; 2], [[f64; 2]; 2])> {
    let mut point = start;
    let size = 1.0 + target[0].abs().max(target[1].abs());
    for _ in 0..MAX_NEWTON {
        let (value, jacobian) = map(point);
        let rest = [target[0] - value[0], target[1] - value[1]];
        let error = rest[0].abs().max(rest[1].abs());
        if !error.is_finite() {
            return None;
        }
        let inverse = invert(jacobian);
        point[0] += inverse[0][0] * rest[0] + inverse[0][1] * rest[1];
        point[1] += inverse[1][0] * rest[0] + inverse[1][1] * rest[1];
        if error <= LAST * size {
            return Some((point, inverse));
        }
    }
    None
}

/// The inverse of a matrix of two rows.
#[inline]
fn invert([[a, b], [c, d]]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let scale = 1.0 / (a * d - b * c);
    [[d * scale, -b * scale], [-c * scale, a * scale]]
}
