//! Polynomial approximation of the projection over a cell.
//!
//! Over a cell a camera is very nearly a polynomial, whatever its lens. Values and Jacobians at the nodes, which cells share,
//! determine one that costs a few multiplications per point. It is checked against the exact projection at the points where it
//! is expected to be worst; on failure the cell falls back to exact projection.

use std::array::from_fn;

use fedic_camera::Camera;
use fedic_mesh::{Cell, CellVisitor, MAX_NODES};

use crate::kernels::gradient::LinearJacobian;
use crate::kernels::polynomial::{PixelPolynomial, Polynomial, combinations};
use crate::projection::polynomial_basis::{CheckPoint, DATA, MAX_CHECK_POINTS, PolynomialBasis};
use crate::projection::projected_points::{BATCH, ProjectedPoint, ProjectedPoints};
use crate::quadrature::monomials::{MONOMIALS, UP_TO_DEGREE};

/// Largest number of cells fitted at once: their centres and check points fill one batch of projected points.
pub(crate) const CELLS_AT_ONCE: usize = BATCH / (1 + MAX_CHECK_POINTS);
/// Largest error of the polynomials in pixels, far below the noise of images. Following the pieces of a spline more closely is
/// not worth the time.
const SMOOTH_TOLERANCE: f64 = 1e-6;
const PIECEWISE_TOLERANCE: f64 = 1e-4;
/// Coefficients whose sum is below this, in pixels, are left out.
const NEGLIGIBLE: f64 = 1e-6;
/// Largest relative error of the Jacobian, which only weighs residuals; or this many times the precision of the camera, if larger.
const JACOBIAN_TOLERANCE: f64 = 1e-4;
const JACOBIAN_PER_PRECISION: f64 = 10.0;
/// Largest magnitude of the image coordinates of a cell's centre for which a polynomial is kept.
const MAX_COORDINATE: f64 = 2e9;

/// Approximation of the projection over a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellPolynomial<const D: usize> {
    /// The pixel near the centre from which `pixel` counts.
    pub(crate) origin: [isize; 2],
    /// Image coordinates.
    pub(crate) pixel: PixelPolynomial,
    /// Jacobian with respect to the first `D` world coordinates.
    pub(crate) jacobian: LinearJacobian<D>,
}

/// Fits polynomials over up to [`CELLS_AT_ONCE`] cells; `None` where no polynomial is accurate enough.
///
/// `accepted` holds, for each cell, whether its polynomial was accurate when the nodes were nearly where they are now: then no
/// polynomial is checked again.
pub(crate) fn fit_cells<'a, const D: usize>(
    cells: impl Iterator<Item = Cell<'a>> + Clone,
    nodes: &[ProjectedPoint],
    camera: &dyn Camera,
    accepted: Option<&[bool]>,
    polynomials: &mut [Option<CellPolynomial<D>>],
) {
    let each = polynomials.iter_mut().zip(cells.clone());
    if let Some(jacobian) = camera.constant_jacobian() {
        each.for_each(|(polynomial, cell)| *polynomial = Draft::affine(cell, nodes, jacobian).to_single());
        return;
    }
    let piecewise = camera.is_piecewise();
    let check_points_of =
        |basis: &'static PolynomialBasis| if accepted.is_some() { &[] } else { basis.check_points(piecewise) };
    let points = cells.take(CELLS_AT_ONCE).flat_map(|cell| {
        let basis = PolynomialBasis::of(cell.cell_type);
        let shapes =
            std::iter::once(&basis.centre_shape).chain(check_points_of(basis).iter().map(|check| &check.shape));
        shapes.map(move |shape| interpolate(shape, cell, nodes))
    });
    let projected = ProjectedPoints::new(camera, points);
    let (precision, mut centre) = (if piecewise { PIECEWISE_TOLERANCE } else { SMOOTH_TOLERANCE }, 0);
    for (index, (polynomial, cell)) in each.enumerate() {
        let basis = PolynomialBasis::of(cell.cell_type);
        let centre_pixel = projected.at(centre).pixel;
        let draft: Draft<D> =
            cell.cell_type.visit(NewDraft { basis, nodes: cell.nodes, projected: nodes, centre: centre_pixel });
        let check_points = check_points_of(basis);
        let agrees = accepted.is_none_or(|accepted| accepted[index])
            && check_points.iter().zip(centre + 1..).all(|(check, k)| draft.agrees(check, &projected.at(k), precision));
        *polynomial = if agrees { draft.to_single() } else { None };
        centre += 1 + check_points.len();
    }
}

/// Position of the point of a cell with these shape functions.
fn interpolate(shape: &[f64; MAX_NODES], cell: Cell<'_>, nodes: &[ProjectedPoint]) -> [f64; 3] {
    let mut position = [0.0; 3];
    for (shape, &node) in shape.iter().zip(cell.nodes) {
        let node = &nodes[node as usize].world;
        (0..3).for_each(|d| position[d] += shape * node[d]);
    }
    position
}

/// A cell's polynomial in double precision.
struct Draft<const D: usize> {
    origin: [f64; 2],
    pixel: [Polynomial; 2],
    jacobian: [[[f64; 3]; D]; 2],
}

/// Arguments of [`Draft::new`], which is compiled for each number of nodes.
struct NewDraft<'a, const D: usize> {
    basis: &'a PolynomialBasis,
    nodes: &'a [u32],
    projected: &'a [ProjectedPoint],
    centre: [f64; 2],
}

impl<const D: usize> CellVisitor for NewDraft<'_, D> {
    type Output = Draft<D>;

    fn visit<const N: usize>(self) -> Draft<D> {
        Draft::new::<N>(self.basis, self.nodes, self.projected, self.centre)
    }
}

impl<const D: usize> Draft<D> {
    /// Fits a cell of `N` nodes whose centre is projected to `centre`.
    fn new<const N: usize>(
        basis: &PolynomialBasis,
        nodes: &[u32],
        projected: &[ProjectedPoint],
        centre: [f64; 2],
    ) -> Self {
        let nodes: [&ProjectedPoint; N] = from_fn(|a| &projected[nodes[a] as usize]);
        let origin = centre.map(f64::round);
        let mut data = [[0.0; DATA]; 2];
        let mut jacobian = [[[0.0; 3]; D]; 2];
        for c in 0..2 {
            data[c][3 * N] = centre[c] - origin[c];
        }
        for a in 0..N {
            let mut tangents = [[0.0; 3]; 2];
            for b in 0..N {
                for (tangent, slope) in tangents.iter_mut().zip(basis.gradients[a][b]) {
                    (0..3).for_each(|d| tangent[d] += slope * nodes[b].world[d]);
                }
            }
            for c in 0..2 {
                let [x, y, z] = nodes[a].jacobian[c];
                data[c][a] = nodes[a].pixel[c] - origin[c];
                for (direction, tangent) in tangents.iter().enumerate() {
                    data[c][(1 + direction) * N + a] = x * tangent[0] + y * tangent[1] + z * tangent[2];
                }
                for (entry, slope) in jacobian[c].iter_mut().zip(nodes[a].jacobian[c]) {
                    (0..3).for_each(|m| entry[m] += slope * basis.jacobian[a][m]);
                }
            }
        }
        let data = data.each_ref().map(|data| &data[..=3 * N]);
        Self { origin, pixel: combinations(data, &basis.pixel[..=3 * N]), jacobian }
    }

    /// A cell seen by a camera with a constant Jacobian.
    fn affine(cell: Cell<'_>, nodes: &[ProjectedPoint], jacobian: [[f64; 3]; 2]) -> Self {
        let basis = PolynomialBasis::of(cell.cell_type);
        let n = cell.nodes.len();
        let mut centre = [0.0; 2];
        for (shape, &node) in basis.centre_shape.iter().zip(cell.nodes) {
            (0..2).for_each(|c| centre[c] += shape * nodes[node as usize].pixel[c]);
        }
        let origin = centre.map(f64::round);
        let mut values = [[0.0; MAX_NODES]; 2];
        for (a, &node) in cell.nodes.iter().enumerate() {
            (0..2).for_each(|c| values[c][a] = nodes[node as usize].pixel[c] - origin[c]);
        }
        let pixel = combinations(values.each_ref().map(|values| &values[..n]), &basis.shape[..n]);
        Self { origin, pixel, jacobian: from_fn(|c| from_fn(|d| [jacobian[c][d], 0.0, 0.0])) }
    }

    /// Compares the polynomial with the exact projection of a check point.
    fn agrees(&self, check: &CheckPoint, exact: &ProjectedPoint, precision: f64) -> bool {
        let entries = self.jacobian.as_flattened();
        let size = entries.iter().map(|entry| entry[0].abs()).fold(0.0, f64::max);
        let jacobian_tolerance = size * JACOBIAN_TOLERANCE.max(JACOBIAN_PER_PRECISION * precision);
        let same_pixel = (0..2).all(|c| {
            let [constant, factors @ ..] = &self.pixel[c];
            let monomials = factors.iter().zip(&check.monomials).map(|(factor, monomial)| factor * monomial);
            (self.origin[c] + constant + monomials.sum::<f64>() - exact.pixel[c]).abs() <= precision
        });
        let same_jacobian = entries.iter().enumerate().all(|(entry, [constant, xi, eta])| {
            let approximate = constant + xi * check.monomials[0] + eta * check.monomials[1];
            (approximate - exact.jacobian[entry / D][entry % D]).abs() <= jacobian_tolerance
        });
        same_pixel && same_jacobian
    }

    /// Rounds to single precision; `None` where the cell is far outside any image.
    fn to_single(&self) -> Option<CellPolynomial<D>> {
        self.origin.iter().all(|c| c.abs() < MAX_COORDINATE).then(|| CellPolynomial {
            origin: self.origin.map(|c| c as isize),
            pixel: PixelPolynomial {
                coefficients: self.pixel.map(|c| from_fn(|m| c[m] as f32)),
                remainder: self.pixel.map(|c| from_fn(|m| (c[m] - f64::from(c[m] as f32)) as f32)),
                terms: significant_terms(&self.pixel),
            },
            jacobian: self.jacobian.map(|row| row.map(|entry| entry.map(|c| c as f32))),
        })
    }
}

/// Smallest number of monomials, a whole degree, beyond which the coefficients are negligible: no monomial exceeds one.
fn significant_terms(coefficients: &[Polynomial; 2]) -> usize {
    let mut terms = MONOMIALS;
    let mut beyond = [0.0; 2];
    for fewer in UP_TO_DEGREE.into_iter().rev() {
        for (beyond, c) in beyond.iter_mut().zip(coefficients) {
            *beyond += c[fewer + 1..=terms].iter().map(|c| c.abs()).sum::<f64>();
        }
        if beyond[0].max(beyond[1]) > NEGLIGIBLE {
            break;
        }
        terms = fewer;
    }
    terms
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_camera::{
        BrownDistortion, Distortion, InverseSplineDistortion, Pinhole, SplineDistortion, SplineField,
        rotation_from_vector,
    };
    use fedic_mesh::{CellType, map};

    use super::*;
    use crate::quadrature::monomials::monomials;

    fn tilted(focal: f64, radial: f64) -> Pinhole {
        let lens = BrownDistortion::new([radial, 0.05, 0.0], [1e-3, -5e-4], [1e-4, 0.0]).unwrap();
        let rotation = rotation_from_vector([std::f64::consts::PI, 0.1, 0.0]);
        Pinhole::new([focal; 2], [500.0, 400.0], rotation, [0.0, 0.0, focal]).unwrap().with_distortion(lens)
    }

    /// A slightly warped cell of this half-size, in pixels, seen by a camera of one pixel per unit at its centre.
    fn warped(cell: CellType, half: f64, camera: &dyn Camera) -> Vec<ProjectedPoint> {
        let warp = |i: usize, phase: f64| 0.01 * half * (phase * i as f64).sin();
        let world =
            |(i, [x, y]): (usize, &[f64; 2])| [300.0 + half * x + warp(i, 1.7), -200.0 + half * y + warp(i, 2.7), 0.0];
        let view = |world| {
            let (pixel, jacobian) = camera.project_with_jacobian(world);
            ProjectedPoint { world, pixel, jacobian }
        };
        cell.reference_nodes().iter().enumerate().map(|node| view(world(node))).collect()
    }

    fn fit_one(cell_type: CellType, nodes_of: &[ProjectedPoint], camera: &dyn Camera) -> Option<CellPolynomial<2>> {
        let nodes: Vec<u32> = (0..nodes_of.len() as u32).collect();
        let mut polynomial = [None];
        fit_cells(std::iter::once(Cell { cell_type, nodes: &nodes }), nodes_of, camera, None, &mut polynomial);
        polynomial[0]
    }

    fn points_of(cell: CellType) -> impl Iterator<Item = [f64; 2]> {
        let steps = (0..=10).map(|i| f64::from(i) / 10.0);
        let grid = steps.clone().flat_map(move |x| steps.clone().map(move |y| [x, y]));
        grid.filter(move |[x, y]| !cell.is_triangle() || x + y <= 1.0)
            .map(move |at| if cell.is_triangle() { at } else { at.map(|c| 2.0 * c - 1.0) })
    }

    /// Largest differences from the camera: in pixels, and of the Jacobian.
    fn differences(
        cell: CellType,
        nodes: &[ProjectedPoint],
        camera: &dyn Camera,
        polynomial: &CellPolynomial<2>,
    ) -> [f64; 2] {
        let positions: Vec<[f64; 3]> = nodes.iter().map(|node| node.world).collect();
        let mut worst = [0.0_f64; 2];
        for at in points_of(cell) {
            let (pixel, jacobian) = camera.project_with_jacobian(map(cell, &positions, at));
            let monomials = monomials(at);
            for c in 0..2 {
                let coefficients = polynomial.pixel.coefficients[c].map(f64::from);
                let mut sum =
                    polynomial.origin[c] as f64 + coefficients[0] + f64::from(polynomial.pixel.remainder[c][0]);
                for (m, monomial) in monomials[..polynomial.pixel.terms].iter().enumerate() {
                    let remainder = polynomial.pixel.remainder[c].get(m + 1).copied().unwrap_or_default();
                    sum += (coefficients[m + 1] + f64::from(remainder)) * monomial;
                }
                worst[0] = worst[0].max((sum - pixel[c]).abs());
            }
            for (entry, linear) in polynomial.jacobian.as_flattened().iter().enumerate() {
                let [constant, xi, eta] = linear.map(f64::from);
                let found = constant + xi * at[0] + eta * at[1];
                worst[1] = worst[1].max((found - jacobian[entry / 2][entry % 2]).abs());
            }
        }
        worst
    }

    #[test]
    fn polynomials_agree_with_the_camera() {
        let mut fitted = 0;
        for camera in [tilted(8381.0, -0.032), tilted(1400.0, -0.2)] {
            for cell in CellType::ALL {
                for half in [5.0, 10.0, 40.0] {
                    let nodes = warped(cell, half, &camera);
                    if let Some(polynomial) = fit_one(cell, &nodes, &camera) {
                        let [pixel, jacobian] = differences(cell, &nodes, &camera, &polynomial);
                        assert!(pixel < 2.5e-6 && jacobian < 4e-4, "{cell}, {half}: {pixel:e} px, {jacobian:e}");
                        fitted += 1;
                    }
                }
            }
        }
        // Large cells behind the stronger lens are projected exactly.
        assert!((20..30).contains(&fitted), "{fitted}");
    }

    /// A lens of waves of half a pixel, 350 px long, approximated by 16 intervals over 1400 px.
    fn wavy(inverse: bool) -> Pinhole {
        let wave = std::f64::consts::TAU * 8381.0 / 350.0;
        let displacement = |[x, y]: [f64; 2]| {
            let [u, v] = [wave * x + 0.3, 0.8 * wave * y];
            Some([u.sin() * v.cos(), u.cos() * v.sin()].map(|c| 0.5 / 8381.0 * c))
        };
        let field = SplineField::fit([-0.084, -0.063, 0.084, 0.063], [16, 12], displacement).unwrap().unwrap();
        let lens: Distortion = match inverse {
            true => InverseSplineDistortion::new(field).into(),
            false => SplineDistortion::new(field).into(),
        };
        tilted(8381.0, 0.0).with_distortion(lens)
    }

    #[test]
    fn polynomials_agree_with_spline_lenses() {
        for camera in [wavy(false), wavy(true)] {
            for (cell, half, all) in [
                (CellType::Quad, 5.0, true),
                (CellType::Quad, 10.0, true),
                (CellType::Quad8, 10.0, true),
                (CellType::Triangle6, 10.0, true),
                (CellType::Quad, 20.0, false),
                (CellType::Quad, 30.0, false),
                (CellType::Triangle, 20.0, false),
            ] {
                let (mut fitted, mut cells, mut worst) = (0, 0, [0.0_f64; 2]);
                for row in -6..6 {
                    for column in -10..10 {
                        let mut nodes = warped(cell, half, &camera);
                        for node in &mut nodes {
                            let [x, y, z] = node.world;
                            node.world = [x - 300.0 + 57.0 * f64::from(column), y + 200.0 + 53.0 * f64::from(row), z];
                            (node.pixel, node.jacobian) = camera.project_with_jacobian(node.world);
                        }
                        cells += 1;
                        if let Some(polynomial) = fit_one(cell, &nodes, &camera) {
                            fitted += 1;
                            let found = differences(cell, &nodes, &camera, &polynomial);
                            worst = [worst[0].max(found[0]), worst[1].max(found[1])];
                        }
                    }
                }
                assert!(fitted == cells || !all, "{cell}, {half}: {fitted} of {cells}");
                assert!(worst[0] < if all { 2e-4 } else { 4e-4 } && worst[1] < 1.2e-3, "{cell}, {half}: {worst:?}");
            }
        }
    }

    #[test]
    fn cells_fitted_together_equal_cells_fitted_alone() {
        for camera in [&tilted(1400.0, -0.2) as &dyn Camera, &wavy(false), &fedic_camera::ImageFrame] {
            let (mut nodes_of, mut cells) = (Vec::new(), Vec::new());
            for (cell_type, half) in CellType::ALL.into_iter().zip([10.0, 5.0, 10.0, 80.0, 5.0]) {
                let nodes = warped(cell_type, half, camera);
                cells.push((
                    cell_type,
                    (nodes_of.len() as u32..(nodes_of.len() + nodes.len()) as u32).collect::<Vec<_>>(),
                ));
                nodes_of.extend(nodes);
            }
            let mut together: [Option<CellPolynomial<2>>; CELLS_AT_ONCE] = [None; CELLS_AT_ONCE];
            let cells = cells.iter().map(|(cell_type, nodes)| Cell { cell_type: *cell_type, nodes });
            fit_cells(cells.clone(), &nodes_of, camera, None, &mut together);
            let accepted = together.each_ref().map(Option::is_some);
            let mut again: [Option<CellPolynomial<2>>; CELLS_AT_ONCE] = [None; CELLS_AT_ONCE];
            fit_cells(cells.clone(), &nodes_of, camera, Some(&accepted), &mut again);
            assert_eq!(format!("{again:?}"), format!("{together:?}"));
            for (cell, polynomial) in cells.zip(&together) {
                let mut alone: [Option<CellPolynomial<2>>; 1] = [None];
                fit_cells(std::iter::once(cell), &nodes_of, camera, None, &mut alone);
                assert_eq!(format!("{polynomial:?}"), format!("{:?}", alone[0]));
            }
            assert!(together.iter().flatten().count() >= 3);
        }
    }

    #[test]
    fn a_camera_without_perspective_is_fitted_exactly() {
        let camera = fedic_camera::FrontParallel::new(1.0, [12_000.3, 15_000.7]).unwrap();
        for cell in CellType::ALL {
            let nodes = warped(cell, 10.0, &camera);
            let polynomial = fit_one(cell, &nodes, &camera).unwrap();
            let [pixel, jacobian] = differences(cell, &nodes, &camera, &polynomial);
            assert!(pixel < 6e-7 && jacobian == 0.0, "{cell}: {pixel:e} px, {jacobian:e}");
        }
    }
}
