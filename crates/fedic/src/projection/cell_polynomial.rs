//! Where the points of a cell are seen, as polynomials of their reference coordinates.
//!
//! Over a cell a camera is very nearly a polynomial, whatever its lens. Its values and slopes at the nodes, which cells share,
//! give one that the points of a cell evaluate in a few multiplications, from tables that cells of one subdivision share. The
//! polynomial is compared with the camera itself where it can be worst; a cell where they differ is left to the camera.

use std::array::from_fn;

use fedic_camera::Camera;
use fedic_mesh::{Cell, CellVisitor, MAX_NODES};

use crate::kernels::simd::combinations;
use crate::projection::polynomial_basis::{Check, DATA, Fit, MONOMIALS, MOST_CHECKS, Polynomial, UP_TO_DEGREE};
use crate::projection::projected_points::{MOST_SIGHTS, Sight, Sights};

/// Most cells expanded together: as many as the camera sees at once, centres and checks.
pub(crate) const TOGETHER: usize = MOST_SIGHTS / (1 + MOST_CHECKS);
/// Coefficients that add up to less than this, in pixels, are left out.
const NEGLIGIBLE: f64 = 1e-6;
/// Largest difference from the camera's Jacobian, relative: it only weighs residuals. For a camera of poor precision, this many
/// times the precision.
const JACOBIAN_TOLERANCE: f64 = 1e-4;
const JACOBIAN_PER_PRECISION: f64 = 10.0;
/// Largest pixel coordinate, in magnitude, near which a polynomial is of use.
const FARTHEST: f64 = 2e9;

/// Polynomials over a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Expansion {
    /// A pixel near the centre, from which `pixel` counts.
    pub(crate) origin: [isize; 2],
    /// Constant and coefficients of the monomials, of `u` and of `v`.
    pub(crate) pixel: [[f32; MONOMIALS + 1]; 2],
    /// What single precision leaves of the constant and of the coefficients of `xi` and `eta`, of `u` and of `v`.
    pub(crate) remainder: [[f32; 3]; 2],
    /// How many monomials have coefficients worth adding.
    pub(crate) terms: usize,
    /// Constant, slopes along `xi` and `eta` of `du/dX, du/dY, dv/dX, dv/dY`.
    pub(crate) jacobian: [[f32; 3]; 4],
}

/// Finds the polynomials over up to [`TOGETHER`] cells; `None` over those that only the camera can follow. Where `followed` says
/// of each cell whether a polynomial does so, because it did when the cells were hardly elsewhere, none is compared with the camera.
pub(crate) fn expand<'a>(
    cells: impl Iterator<Item = Cell<'a>> + Clone,
    views: &[Sight],
    camera: &dyn Camera,
    followed: Option<&[bool]>,
    expansions: &mut [Option<Expansion>],
) {
    let each = expansions.iter_mut().zip(cells.clone());
    if let Some(jacobian) = camera.constant_jacobian() {
        each.for_each(|(expansion, cell)| *expansion = Draft::affine(cell, views, jacobian).finished());
        return;
    }
    let in_pieces = camera.is_in_pieces();
    let checks_of = |fit: &'static Fit| if followed.is_some() { &[] } else { fit.checks(in_pieces) };
    let asked = cells.take(TOGETHER).flat_map(|cell| {
        let fit = Fit::of(cell.cell_type);
        let shapes = std::iter::once(&fit.centre_shape).chain(checks_of(fit).iter().map(|check| &check.shape));
        shapes.map(move |shape| interpolate(shape, cell, views))
    });
    let sights = Sights::new(camera, asked);
    let (precision, mut centre) = (camera.precision(), 0);
    for (index, (expansion, cell)) in each.enumerate() {
        let fit = Fit::of(cell.cell_type);
        let draft = cell.cell_type.visit(NewDraft { fit, nodes: cell.nodes, views, centre: sights.at(centre).pixel });
        let checks = checks_of(fit);
        let agrees = followed.is_none_or(|followed| followed[index])
            && checks.iter().zip(centre + 1..).all(|(check, k)| draft.agrees(check, &sights.at(k), precision));
        *expansion = if agrees { draft.finished() } else { None };
        centre += 1 + checks.len();
    }
}

/// The point of a cell where its shape functions are these.
fn interpolate(shape: &[f64; MAX_NODES], cell: Cell<'_>, views: &[Sight]) -> [f64; 3] {
    let mut place = [0.0; 3];
    for (shape, &node) in shape.iter().zip(cell.nodes) {
        let node = &views[node as usize].place;
        (0..3).for_each(|d| place[d] += shape * node[d]);
    }
    place
}

/// An expansion in double precision.
struct Draft {
    origin: [f64; 2],
    pixel: [Polynomial; 2],
    jacobian: [[f64; 3]; 4],
}

/// Arguments of [`Draft::new`], which is compiled for each number of nodes.
struct NewDraft<'a> {
    fit: &'a Fit,
    nodes: &'a [u32],
    views: &'a [Sight],
    centre: [f64; 2],
}

impl CellVisitor for NewDraft<'_> {
    type Output = Draft;

    fn visit<const N: usize>(self) -> Draft {
        Draft::new::<N>(self.fit, self.nodes, self.views, self.centre)
    }
}

impl Draft {
    /// Of a cell of `N` nodes, whose centre is seen at the pixel `centre`.
    fn new<const N: usize>(fit: &Fit, nodes: &[u32], views: &[Sight], centre: [f64; 2]) -> Self {
        let nodes: [&Sight; N] = from_fn(|a| &views[nodes[a] as usize]);
        let origin = centre.map(f64::round);
        let mut data = [[0.0; DATA]; 2];
        let mut jacobian = [[0.0; 3]; 4];
        for c in 0..2 {
            data[c][3 * N] = centre[c] - origin[c];
        }
        for a in 0..N {
            let mut tangents = [[0.0; 3]; 2];
            for b in 0..N {
                for (tangent, slope) in tangents.iter_mut().zip(fit.gradients[a][b]) {
                    (0..3).for_each(|d| tangent[d] += slope * nodes[b].place[d]);
                }
            }
            for c in 0..2 {
                let [x, y, z] = nodes[a].jacobian[c];
                data[c][a] = nodes[a].pixel[c] - origin[c];
                for (direction, tangent) in tangents.iter().enumerate() {
                    data[c][(1 + direction) * N + a] = x * tangent[0] + y * tangent[1] + z * tangent[2];
                }
                for (d, slope) in [x, y].into_iter().enumerate() {
                    (0..3).for_each(|m| jacobian[2 * c + d][m] += slope * fit.jacobian[a][m]);
                }
            }
        }
        let data = data.each_ref().map(|data| &data[..=3 * N]);
        Self { origin, pixel: combinations(data, &fit.pixel[..=3 * N]), jacobian }
    }

    /// Of a cell before a camera whose Jacobian is the same everywhere.
    fn affine(cell: Cell<'_>, views: &[Sight], jacobian: [[f64; 3]; 2]) -> Self {
        let fit = Fit::of(cell.cell_type);
        let n = cell.nodes.len();
        let mut centre = [0.0; 2];
        for (shape, &node) in fit.centre_shape.iter().zip(cell.nodes) {
            (0..2).for_each(|c| centre[c] += shape * views[node as usize].pixel[c]);
        }
        let origin = centre.map(f64::round);
        let mut values = [[0.0; MAX_NODES]; 2];
        for (a, &node) in cell.nodes.iter().enumerate() {
            (0..2).for_each(|c| values[c][a] = views[node as usize].pixel[c] - origin[c]);
        }
        let pixel = combinations(values.each_ref().map(|values| &values[..n]), &fit.shape[..n]);
        Self { origin, pixel, jacobian: from_fn(|entry| [jacobian[entry / 2][entry % 2], 0.0, 0.0]) }
    }

    /// Whether it agrees with what the camera sees at a point.
    fn agrees(&self, check: &Check, sight: &Sight, precision: f64) -> bool {
        let size = self.jacobian.iter().map(|entry| entry[0].abs()).fold(0.0, f64::max);
        let jacobian_tolerance = size * JACOBIAN_TOLERANCE.max(JACOBIAN_PER_PRECISION * precision);
        let same_pixel = (0..2).all(|c| {
            let [constant, factors @ ..] = &self.pixel[c];
            let monomials = factors.iter().zip(&check.monomials).map(|(factor, monomial)| factor * monomial);
            (self.origin[c] + constant + monomials.sum::<f64>() - sight.pixel[c]).abs() <= precision
        });
        let same_jacobian = (0..4).all(|entry| {
            let [constant, xi, eta] = self.jacobian[entry];
            let expanded = constant + xi * check.monomials[0] + eta * check.monomials[1];
            (expanded - sight.jacobian[entry / 2][entry % 2]).abs() <= jacobian_tolerance
        });
        same_pixel && same_jacobian
    }

    /// In single precision; `None` where it is not near the image.
    fn finished(&self) -> Option<Expansion> {
        self.origin.iter().all(|c| c.abs() < FARTHEST).then(|| Expansion {
            origin: self.origin.map(|c| c as isize),
            pixel: self.pixel.map(|c| from_fn(|m| c[m] as f32)),
            remainder: self.pixel.map(|c| from_fn(|m| (c[m] - f64::from(c[m] as f32)) as f32)),
            terms: worth_adding(&self.pixel),
            jacobian: self.jacobian.map(|c| c.map(|c| c as f32)),
        })
    }
}

/// The fewest monomials, up to a whole degree, beyond which coefficients add up to nothing: a monomial is at most one.
fn worth_adding(coefficients: &[Polynomial; 2]) -> usize {
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
    use crate::projection::polynomial_basis::monomials;

    fn tilted(focal: f64, radial: f64) -> Pinhole {
        let lens = BrownDistortion::new([radial, 0.05, 0.0], [1e-3, -5e-4], [1e-4, 0.0]).unwrap();
        let rotation = rotation_from_vector([std::f64::consts::PI, 0.1, 0.0]);
        Pinhole::new([focal; 2], [500.0, 400.0], rotation, [0.0, 0.0, focal]).unwrap().with_distortion(lens)
    }

    /// A slightly warped cell of this half-size, in pixels, seen by a camera of one pixel per unit at its centre.
    fn warped(cell: CellType, half: f64, camera: &dyn Camera) -> Vec<Sight> {
        let warp = |i: usize, phase: f64| 0.01 * half * (phase * i as f64).sin();
        let place =
            |(i, [x, y]): (usize, &[f64; 2])| [300.0 + half * x + warp(i, 1.7), -200.0 + half * y + warp(i, 2.7), 0.0];
        let view = |place| {
            let (pixel, jacobian) = camera.project_with_jacobian(place);
            Sight { place, pixel, jacobian }
        };
        cell.reference_nodes().iter().enumerate().map(|node| view(place(node))).collect()
    }

    fn expand_one(cell_type: CellType, views: &[Sight], camera: &dyn Camera) -> Option<Expansion> {
        let nodes: Vec<u32> = (0..views.len() as u32).collect();
        let mut expansion = [None];
        expand(std::iter::once(Cell { cell_type, nodes: &nodes }), views, camera, None, &mut expansion);
        expansion[0]
    }

    fn points_of(cell: CellType) -> impl Iterator<Item = [f64; 2]> {
        let steps = (0..=10).map(|i| f64::from(i) / 10.0);
        let grid = steps.clone().flat_map(move |x| steps.clone().map(move |y| [x, y]));
        grid.filter(move |[x, y]| !cell.is_triangle() || x + y <= 1.0)
            .map(move |at| if cell.is_triangle() { at } else { at.map(|c| 2.0 * c - 1.0) })
    }

    /// Largest differences from the camera: in pixels, and of the Jacobian.
    fn differences(cell: CellType, nodes: &[Sight], camera: &dyn Camera, expansion: &Expansion) -> [f64; 2] {
        let places: Vec<[f64; 3]> = nodes.iter().map(|node| node.place).collect();
        let mut worst = [0.0_f64; 2];
        for at in points_of(cell) {
            let (pixel, jacobian) = camera.project_with_jacobian(map(cell, &places, at));
            let monomials = monomials(at);
            for c in 0..2 {
                let coefficients = expansion.pixel[c].map(f64::from);
                let mut sum = expansion.origin[c] as f64 + coefficients[0] + f64::from(expansion.remainder[c][0]);
                for (m, monomial) in monomials[..expansion.terms].iter().enumerate() {
                    let remainder = expansion.remainder[c].get(m + 1).copied().unwrap_or_default();
                    sum += (coefficients[m + 1] + f64::from(remainder)) * monomial;
                }
                worst[0] = worst[0].max((sum - pixel[c]).abs());
            }
            for (entry, linear) in expansion.jacobian.iter().enumerate() {
                let [constant, xi, eta] = linear.map(f64::from);
                let found = constant + xi * at[0] + eta * at[1];
                worst[1] = worst[1].max((found - jacobian[entry / 2][entry % 2]).abs());
            }
        }
        worst
    }

    #[test]
    fn expansions_follow_the_camera() {
        let mut expanded = 0;
        for camera in [tilted(8381.0, -0.032), tilted(1400.0, -0.2)] {
            for cell in CellType::ALL {
                for half in [5.0, 10.0, 40.0] {
                    let nodes = warped(cell, half, &camera);
                    if let Some(expansion) = expand_one(cell, &nodes, &camera) {
                        let [pixel, jacobian] = differences(cell, &nodes, &camera, &expansion);
                        assert!(pixel < 2.5e-6 && jacobian < 4e-4, "{cell}, {half}: {pixel:e} px, {jacobian:e}");
                        expanded += 1;
                    }
                }
            }
        }
        // Large cells behind the stronger lens are left to the camera.
        assert!((20..30).contains(&expanded), "{expanded}");
    }

    /// Waves of half a pixel, 350 px long, as 16 intervals over 1400 px follow them.
    fn wavy(inverse: bool) -> Pinhole {
        let wave = std::f64::consts::TAU * 8381.0 / 350.0;
        let displacement = |[x, y]: [f64; 2]| {
            let [u, v] = [wave * x + 0.3, 0.8 * wave * y];
            Some([u.sin() * v.cos(), u.cos() * v.sin()].map(|c| 0.5 / 8381.0 * c))
        };
        let field =
            SplineField::approximating([-0.084, -0.063, 0.084, 0.063], [16, 12], displacement).unwrap().unwrap();
        let lens: Distortion = match inverse {
            true => InverseSplineDistortion::new(field).into(),
            false => SplineDistortion::new(field).into(),
        };
        tilted(8381.0, 0.0).with_distortion(lens)
    }

    #[test]
    fn expansions_follow_a_lens_of_any_shape() {
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
                let (mut expanded, mut cells, mut worst) = (0, 0, [0.0_f64; 2]);
                for row in -6..6 {
                    for column in -10..10 {
                        let mut nodes = warped(cell, half, &camera);
                        for node in &mut nodes {
                            let [x, y, z] = node.place;
                            node.place = [x - 300.0 + 57.0 * f64::from(column), y + 200.0 + 53.0 * f64::from(row), z];
                            (node.pixel, node.jacobian) = camera.project_with_jacobian(node.place);
                        }
                        cells += 1;
                        if let Some(expansion) = expand_one(cell, &nodes, &camera) {
                            expanded += 1;
                            let found = differences(cell, &nodes, &camera, &expansion);
                            worst = [worst[0].max(found[0]), worst[1].max(found[1])];
                        }
                    }
                }
                assert!(expanded == cells || !all, "{cell}, {half}: {expanded} of {cells}");
                assert!(worst[0] < if all { 2e-4 } else { 4e-4 } && worst[1] < 1.2e-3, "{cell}, {half}: {worst:?}");
            }
        }
    }

    #[test]
    fn cells_expanded_together_are_as_those_alone() {
        for camera in [&tilted(1400.0, -0.2) as &dyn Camera, &wavy(false), &fedic_camera::ImageFrame] {
            let (mut views, mut cells) = (Vec::new(), Vec::new());
            for (cell_type, half) in CellType::ALL.into_iter().zip([10.0, 5.0, 10.0, 80.0, 5.0]) {
                let nodes = warped(cell_type, half, camera);
                cells.push((cell_type, (views.len() as u32..(views.len() + nodes.len()) as u32).collect::<Vec<_>>()));
                views.extend(nodes);
            }
            let mut together = [None; TOGETHER];
            let cells = cells.iter().map(|(cell_type, nodes)| Cell { cell_type: *cell_type, nodes });
            expand(cells.clone(), &views, camera, None, &mut together);
            let (followed, mut again) = (together.each_ref().map(Option::is_some), [None; TOGETHER]);
            expand(cells.clone(), &views, camera, Some(&followed), &mut again);
            assert_eq!(format!("{again:?}"), format!("{together:?}"));
            for (cell, expansion) in cells.zip(&together) {
                let mut alone = [None];
                expand(std::iter::once(cell), &views, camera, None, &mut alone);
                assert_eq!(format!("{expansion:?}"), format!("{:?}", alone[0]));
            }
            assert!(together.iter().flatten().count() >= 3);
        }
    }

    #[test]
    fn a_camera_without_perspective_is_expanded_exactly() {
        let camera = fedic_camera::FrontParallel::new(1.0, [12_000.3, 15_000.7]).unwrap();
        for cell in CellType::ALL {
            let nodes = warped(cell, 10.0, &camera);
            let expansion = expand_one(cell, &nodes, &camera).unwrap();
            let [pixel, jacobian] = differences(cell, &nodes, &camera, &expansion);
            assert!(pixel < 6e-7 && jacobian == 0.0, "{cell}: {pixel:e} px, {jacobian:e}");
        }
    }
}
