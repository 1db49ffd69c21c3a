//! Start from a smooth displacement with few unknowns, fitted to a subset of the cells.
//!
//! Most motion in a test is smooth. Far from the solution every iteration would read all points to find it, where a few hundred
//! cells determine it as well. The iterations on the nodal field start from there.

use fedic_image::Interpolator;

use crate::equations::basis::Basis;
use crate::equations::dofs::Dofs;
use crate::equations::term::Term;
use crate::projection::projected_points::project_nodes;
use crate::solve::basis::polynomial::PolynomialModes;
use crate::solve::basis::reduced::ReducedBasis;
use crate::solve::gauss_newton::{pixel_lengths, residual_rms};
use crate::solve::level::Level;
use crate::{Brightness, Error, Monitor};

/// The mesh must have this many times the cells of the subset for it to be worth reading.
const MIN_CELLS: usize = 4;
/// Increments below this, in pixels, are left to the iterations on the nodal field.
const NEAR: f64 = 0.1;
const MAX_ITERATIONS: usize = 12;
/// Keeps parameters small that the subset hardly determines, such as powers across a narrow strip.
const RIDGE: f64 = 1e-3;

/// Improves a start: returns `displacement`, or that plus a smooth field with a smaller residual in the subset of the cells.
///
/// # Errors
///
/// [`Error::Cancelled`] if `monitor` asks to stop.
pub(crate) fn smooth_start<const D: usize>(
    dofs: &Dofs<D>,
    level: &Level<D>,
    deformed: &Interpolator,
    brightness: Brightness,
    displacement: Vec<[f64; D]>,
    monitor: &dyn Monitor,
) -> Result<Vec<[f64; D]>, Error> {
    if dofs.mesh.num_cells() < MIN_CELLS * level.subset.len() {
        return Ok(displacement);
    }
    let nodes = project_nodes::<D>(&dofs.mesh, level.observation.camera.as_ref(), None);
    let mut basis = ReducedBasis::new(dofs, PolynomialModes::new(&nodes), RIDGE);
    let mut term = level.image_term(dofs, deformed, brightness).restricted_to(&level.subset);
    term.estimate_gain_offset(&displacement, &level.subset, monitor)?;
    let mut best = displacement.clone();
    let mut least = f64::INFINITY;
    let mut current = displacement;
    for iteration in 0..MAX_ITERATIONS {
        basis.linearize(&current);
        let mut equations = basis.equations(true);
        let residual = residual_rms(&[term.assemble(&current, &basis, &mut equations, monitor)?]);
        // A residual of NaN, where the subset has left the image, is no progress either.
        if residual >= least || residual.is_nan() {
            break;
        }
        best.clone_from(&current);
        least = residual;
        let Ok(increment) = basis.solve(equations) else { break };
        let largest = pixel_lengths(&mut [&mut term], &increment).into_iter().fold(0.0, f64::max);
        let near = largest <= NEAR;
        if near && iteration == 0 {
            break;
        }
        for (u, increment) in current.iter_mut().zip(increment) {
            u.iter_mut().zip(increment).for_each(|(u, increment)| *u += increment);
        }
        if near {
            return Ok(current);
        }
    }
    Ok(best)
}
