//! Loops over many points, compiled once per camera and lens type.

/// Points projected together, so that the compiler can vectorise over them.
const LANES: usize = 4;

/// Projects points one by one; the compiler vectorises the loop for simple cameras.
#[inline(always)]
pub(crate) fn project_each(project: impl Fn([f64; 3]) -> [f64; 2], [x, y, z]: [&[f64]; 3], [u, v]: [&mut [f64]; 2]) {
    let n = u.len();
    let (x, y, z, v) = (&x[..n], &y[..n], &z[..n], &mut v[..n]);
    for k in 0..n {
        [u[k], v[k]] = project([x[k], y[k], z[k]]);
    }
}

/// Projects points with their Jacobians, [`LANES`] points at a time through local arrays: the compiler cannot prove that
/// so many slices do not alias.
#[inline(always)]
pub(crate) fn project_each_with_jacobian(
    project: impl Fn([f64; 3]) -> ([f64; 2], [[f64; 3]; 2]),
    [x, y, z]: [&[f64]; 3],
    [u, v]: [&mut [f64]; 2],
    jacobian: &mut [[&mut [f64]; 3]; 2],
) {
    let n = u.len();
    for start in (0..n).step_by(LANES) {
        let block = start..n.min(start + LANES);
        let mut point = [[0.0; LANES]; 3];
        for (lane, c) in point.iter_mut().zip([x, y, z]) {
            copy(&mut lane[..block.len()], &c[block.clone()]);
        }
        let mut pixel = [[0.0; LANES]; 2];
        let mut rows = [[[0.0; LANES]; 3]; 2];
        for k in 0..LANES {
            let (image, derivatives) = project([point[0][k], point[1][k], point[2][k]]);
            for r in 0..2 {
                pixel[r][k] = image[r];
                for c in 0..3 {
                    rows[r][c][k] = derivatives[r][c];
                }
            }
        }
        copy(&mut u[block.clone()], &pixel[0]);
        copy(&mut v[block.clone()], &pixel[1]);
        for (entry, lane) in jacobian.iter_mut().flatten().zip(rows.as_flattened()) {
            copy(&mut entry[block.clone()], lane);
        }
    }
}

/// Copies the common prefix; a full block of [`LANES`] numbers is copied without a call.
#[inline(always)]
fn copy(to: &mut [f64], from: &[f64]) {
    if let (Ok(to), Some(from)) = (<&mut [f64; LANES]>::try_from(&mut *to), from.first_chunk()) {
        *to = *from;
        return;
    }
    let n = to.len().min(from.len());
    to[..n].copy_from_slice(&from[..n]);
}
