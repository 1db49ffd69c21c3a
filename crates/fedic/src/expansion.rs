//! Where the points of a cell are seen, as polynomials of their reference coordinates.
//!
//! Over a cell a camera is very nearly a polynomial, whatever its lens. Its values and slopes at the nodes, which cells share,
//! give one that the points of a cell evaluate in a few multiplications, from tables that cells of one subdivision share. The
//! polynomial is compared with the camera itself where it can be worst; a cell where they differ is left to the camera.

use std::sync::OnceLock;

use fedic_camera::Camera;
use fedic_mesh::{CellType, MAX_NODES, shape_gradients, shape_values};
use nalgebra::{DMatrix, DVector};

use crate::simd::combination;

/// Monomials `xi^i eta^j` besides the constant, by degree.
const EXPONENTS: [[i32; 2]; MONOMIALS] =
    [[1, 0], [0, 1], [2, 0], [1, 1], [0, 2], [3, 0], [2, 1], [1, 2], [0, 3], [4, 0], [3, 1], [2, 2], [1, 3], [0, 4]];
/// Number of monomials up to degree 4, the constant left out.
pub(crate) const MONOMIALS: usize = 14;
/// Numbers of monomials up to each degree.
const UP_TO_DEGREE: [usize; 4] = [2, 5, 9, 14];
/// Rows of a fit that give the coefficients of `xi^4` and `eta^4`.
const X4: usize = 10;
const Y4: usize = 14;
/// Coefficients that add up to less than this, in pixels, are left out.
const NEGLIGIBLE: f64 = 1e-6;
/// Largest difference from the camera's Jacobian, relative: it only weighs residuals. For a camera of poor precision, this many
/// times the precision.
const JACOBIAN_TOLERANCE: f64 = 1e-4;
const JACOBIAN_PER_PRECISION: f64 = 10.0;

/// Singular values below this count as zero.
const RANK: f64 = 1e-10;

/// Coefficients of the constant and of each monomial, and a zero that fills the last vector.
pub(crate) type Polynomial = [f64; MONOMIALS + 2];

/// Values, then slopes along `xi`, then along `eta`, at each node; then the value at the centre.
const DATA: usize = 3 * MAX_NODES + 1;

/// A node where it is, as the camera sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeView {
    pub(crate) place: [f64; 3],
    pub(crate) pixel: [f64; 2],
    pub(crate) jacobian: [[f64; 3]; 2],
}

/// Polynomials over a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Expansion {
    /// A pixel near the centre, from which `pixel` counts.
    pub(crate) origin: [isize; 2],
    /// Constant and coefficients of the monomials, of `u` and of `v`.
    pub(crate) pixel: [[f32; MONOMIALS + 1]; 2],
    /// What single precision leaves of the coefficients of `xi` and `eta`, of `u` and of `v`.
    pub(crate) remainder: [[f32; 2]; 2],
    /// How many monomials have coefficients worth adding.
    pub(crate) terms: usize,
    /// Constant, slopes along `xi` and `eta` of `du/dX, du/dY, dv/dX, dv/dY`.
    pub(crate) jacobian: [[f32; 3]; 4],
}

/// All monomials but the constant at a point.
pub(crate) fn monomials([xi, eta]: [f64; 2]) -> [f64; MONOMIALS] {
    let mut values = [0.0; MONOMIALS];
    for (value, [i, j]) in values.iter_mut().zip(EXPONENTS) {
        *value = xi.powi(i) * eta.powi(j);
    }
    values
}

/// The linear maps from what is known at the nodes of a cell to the coefficients.
struct Fit {
    num_nodes: usize,
    /// What each datum adds to the coefficients: of the constant, then of each monomial.
    pixel: [Polynomial; DATA],
    /// The same of the values at the nodes alone: what the shape functions are made of.
    shape: [Polynomial; MAX_NODES],
    jacobian: [[f64; 3]; MAX_NODES],
    /// Derivatives of the shape functions at each node.
    gradients: [[[f64; 2]; MAX_NODES]; MAX_NODES],
    centre_shape: [f64; MAX_NODES],
    /// Where the polynomial is compared with a smooth camera, and with one made of pieces.
    smooth_check: Vec<Check>,
    piece_checks: Vec<Check>,
}

/// A point of the reference cell: its monomials and shape functions.
struct Check {
    monomials: [f64; MONOMIALS],
    shape: [f64; MAX_NODES],
}

impl Fit {
    fn of(cell_type: CellType) -> &'static Self {
        static FITS: OnceLock<Vec<Fit>> = OnceLock::new();
        &FITS.get_or_init(|| CellType::ALL.into_iter().map(Self::new).collect())[cell_type as usize]
    }

    fn new(cell_type: CellType) -> Self {
        let nodes = cell_type.reference_nodes();
        let n = nodes.len();
        let centre = cell_type.reference_centre();
        // As many as the data tell apart: corners and centre do not know a fourth power from a second.
        let used: Vec<usize> = match cell_type {
            CellType::Triangle => (0..=UP_TO_DEGREE[2]).collect(),
            CellType::Quad => (0..=MONOMIALS).filter(|&m| m != X4 && m != Y4).collect(),
            CellType::Triangle6 | CellType::Quad8 | CellType::Quad9 => (0..=MONOMIALS).collect(),
        };
        let powers = |m: usize| if m == 0 { [0, 0] } else { EXPONENTS[m - 1] };
        let known = DMatrix::from_fn(3 * n + 1, used.len(), |row, column| {
            let ([i, j], [xi, eta]) = (powers(used[column]), if row < 3 * n { nodes[row % n] } else { centre });
            let power = |x: f64, p: i32| if p < 0 { 0.0 } else { x.powi(p) };
            match row / n {
                1 => f64::from(i) * power(xi, i - 1) * power(eta, j),
                2 => f64::from(j) * power(xi, i) * power(eta, j - 1),
                _ => power(xi, i) * power(eta, j),
            }
        });
        let mut fit = Self {
            num_nodes: n,
            pixel: [Polynomial::default(); DATA],
            shape: [Polynomial::default(); MAX_NODES],
            jacobian: [[0.0; 3]; MAX_NODES],
            gradients: [[[0.0; 2]; MAX_NODES]; MAX_NODES],
            centre_shape: [0.0; MAX_NODES],
            smooth_check: Vec::new(),
            piece_checks: Vec::new(),
        };
        let svd = known.svd(true, true);
        for datum in 0..=3 * n {
            let mut unit = DVector::zeros(3 * n + 1);
            unit[datum] = 1.0;
            if let Ok(column) = svd.solve(&unit, RANK) {
                used.iter().zip(column.iter()).for_each(|(&m, &value)| fit.pixel[datum][m] = value);
            }
        }
        let linear = DMatrix::from_fn(n, 3, |row, column| [1.0, nodes[row][0], nodes[row][1]][column]).svd(true, true);
        for node in 0..n {
            let mut unit = DVector::zeros(n);
            unit[node] = 1.0;
            if let Ok(column) = linear.solve(&unit, RANK) {
                (0..3).for_each(|m| fit.jacobian[node][m] = column[m]);
            }
            fit.gradients[node] = shape_gradients(cell_type, nodes[node]);
        }
        let shape_at_centre = shape_values(cell_type, centre);
        for m in 0..=MONOMIALS {
            for node in 0..n {
                // A shape function has its own slopes at the nodes and its own value at the centre.
                let mut coefficient = fit.pixel[node][m] + fit.pixel[3 * n][m] * shape_at_centre[node];
                for at in 0..n {
                    let [xi, eta] = fit.gradients[at][node];
                    coefficient += fit.pixel[n + at][m] * xi + fit.pixel[2 * n + at][m] * eta;
                }
                fit.shape[node][m] = coefficient;
            }
        }
        // Half way from the centre to the edges of a quad the errors of a piece are as large as anywhere.
        let (smooth, pieces): ([f64; 2], &[[f64; 2]]) = match cell_type.is_triangle() {
            true => ([0.5, 0.25], &[[0.5, 0.25], [0.25, 0.5], [0.25, 0.25]]),
            false => ([0.5, 0.5], &[[0.0, 0.5], [0.0, -0.5], [0.5, 0.0], [-0.5, 0.0]]),
        };
        let check = |&at: &[f64; 2]| Check { monomials: monomials(at), shape: shape_values(cell_type, at) };
        fit.centre_shape = shape_at_centre;
        fit.smooth_check = vec![check(&smooth)];
        fit.piece_checks = pieces.iter().map(check).collect();
        fit
    }
}

impl Expansion {
    /// The polynomials over a cell with these nodes, or `None` where they are too far from the camera.
    pub(crate) fn new(cell_type: CellType, nodes: &[&NodeView], camera: &dyn Camera) -> Option<Self> {
        let fit = Fit::of(cell_type);
        let constant = camera.constant_jacobian().is_some();
        let n = fit.num_nodes as f64;
        let mut centre = [0.0; 2];
        for node in nodes {
            (0..2).for_each(|c| centre[c] += node.pixel[c] / n);
        }
        if !centre.iter().all(|c| c.abs() < f64::from(i32::MAX)) {
            return None;
        }
        let origin = centre.map(f64::round);
        let mut jacobian = [[0.0; 3]; 4];
        let coefficients;
        if constant {
            let mut values = [[0.0; MAX_NODES]; 2];
            for (a, node) in nodes.iter().enumerate() {
                (0..2).for_each(|c| values[c][a] = node.pixel[c] - origin[c]);
            }
            coefficients = values.map(|values| combination(&values[..nodes.len()], &fit.shape));
            for entry in 0..4 {
                jacobian[entry][0] = nodes[0].jacobian[entry / 2][entry % 2];
            }
        } else {
            coefficients = fit.expand(nodes, camera, origin);
            jacobian = fit.expand_jacobian(nodes);
            if !fit.agrees(nodes, camera, origin, &coefficients, &jacobian) {
                return None;
            }
        }
        let terms = worth_adding(&coefficients);
        Some(Self {
            origin: origin.map(|c| c as isize),
            pixel: coefficients.map(|c| std::array::from_fn(|m| c[m] as f32)),
            remainder: coefficients.map(|c| [1, 2].map(|m| (c[m] - f64::from(c[m] as f32)) as f32)),
            terms,
            jacobian: jacobian.map(|c| c.map(|c| c as f32)),
        })
    }
}

impl Fit {
    fn expand(&self, nodes: &[&NodeView], camera: &dyn Camera, origin: [f64; 2]) -> [Polynomial; 2] {
        let n = self.num_nodes;
        let mut data = [[0.0; DATA]; 2];
        let centre = camera.project(interpolate(&self.centre_shape, nodes));
        (0..2).for_each(|c| data[c][3 * n] = centre[c] - origin[c]);
        for (a, node) in nodes.iter().enumerate() {
            let mut tangents = [[0.0; 3]; 2];
            for (gradient, other) in self.gradients[a].iter().zip(nodes) {
                for d in 0..3 {
                    tangents[0][d] += gradient[0] * other.place[d];
                    tangents[1][d] += gradient[1] * other.place[d];
                }
            }
            for c in 0..2 {
                let [x, y, z] = node.jacobian[c];
                data[c][a] = node.pixel[c] - origin[c];
                data[c][n + a] = x * tangents[0][0] + y * tangents[0][1] + z * tangents[0][2];
                data[c][2 * n + a] = x * tangents[1][0] + y * tangents[1][1] + z * tangents[1][2];
            }
        }
        [combination(&data[0][..=3 * n], &self.pixel), combination(&data[1][..=3 * n], &self.pixel)]
    }

    fn expand_jacobian(&self, nodes: &[&NodeView]) -> [[f64; 3]; 4] {
        let mut jacobian = [[0.0; 3]; 4];
        for (node, shares) in nodes.iter().zip(&self.jacobian) {
            for entry in 0..4 {
                for m in 0..3 {
                    jacobian[entry][m] += node.jacobian[entry / 2][entry % 2] * shares[m];
                }
            }
        }
        jacobian
    }

    /// Whether the polynomials agree with the camera away from the nodes.
    fn agrees(
        &self,
        nodes: &[&NodeView],
        camera: &dyn Camera,
        origin: [f64; 2],
        coefficients: &[Polynomial; 2],
        jacobian: &[[f64; 3]; 4],
    ) -> bool {
        let size = jacobian.iter().map(|entry| entry[0].abs()).fold(0.0, f64::max);
        let jacobian_tolerance = size * JACOBIAN_TOLERANCE.max(JACOBIAN_PER_PRECISION * camera.precision());
        let checks = if camera.is_in_pieces() { &self.piece_checks } else { &self.smooth_check };
        checks.iter().all(|check| {
            let (seen, true_jacobian) = camera.project_with_jacobian(interpolate(&check.shape, nodes));
            (0..2).all(|c| {
                let monomials = coefficients[c][1..].iter().zip(&check.monomials);
                let expanded = origin[c] + coefficients[c][0] + monomials.map(|(c, m)| c * m).sum::<f64>();
                (expanded - seen[c]).abs() <= camera.precision()
            }) && (0..4).all(|entry| {
                let [constant, xi, eta] = jacobian[entry];
                let expanded = constant + xi * check.monomials[0] + eta * check.monomials[1];
                (expanded - true_jacobian[entry / 2][entry % 2]).abs() <= jacobian_tolerance
            })
        })
    }
}

fn interpolate(shape: &[f64; MAX_NODES], nodes: &[&NodeView]) -> [f64; 3] {
    let mut place = [0.0; 3];
    for (shape, node) in shape.iter().zip(nodes) {
        (0..3).for_each(|d| place[d] += shape * node.place[d]);
    }
    place
}

/// The fewest monomials, up to a whole degree, beyond which coefficients add up to nothing: a monomial is at most one.
fn worth_adding(coefficients: &[Polynomial; 2]) -> usize {
    let rest = |terms: usize| {
        let beyond = |c: &Polynomial| c[terms + 1..].iter().map(|c| c.abs()).sum::<f64>();
        coefficients.iter().map(beyond).fold(0.0, f64::max)
    };
    UP_TO_DEGREE.into_iter().find(|&terms| rest(terms) <= NEGLIGIBLE).unwrap_or(MONOMIALS)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_camera::{
        BrownDistortion, Distortion, InverseSplineDistortion, Pinhole, SplineDistortion, SplineField,
        rotation_from_vector,
    };
    use fedic_mesh::map;

    use super::*;

    fn tilted(focal: f64, radial: f64) -> Pinhole {
        let lens = BrownDistortion::new([radial, 0.05, 0.0], [1e-3, -5e-4], [1e-4, 0.0]).unwrap();
        let rotation = rotation_from_vector([std::f64::consts::PI, 0.1, 0.0]);
        Pinhole::new([focal; 2], [500.0, 400.0], rotation, [0.0, 0.0, focal]).unwrap().with_distortion(lens)
    }

    /// A slightly warped cell of this half-size, in pixels, seen by a camera of one pixel per unit at its centre.
    fn warped(cell: CellType, half: f64, camera: &dyn Camera) -> Vec<NodeView> {
        let warp = |i: usize, phase: f64| 0.01 * half * (phase * i as f64).sin();
        let place =
            |(i, [x, y]): (usize, &[f64; 2])| [300.0 + half * x + warp(i, 1.7), -200.0 + half * y + warp(i, 2.7), 0.0];
        let view = |place| {
            let (pixel, jacobian) = camera.project_with_jacobian(place);
            NodeView { place, pixel, jacobian }
        };
        cell.reference_nodes().iter().enumerate().map(|node| view(place(node))).collect()
    }

    fn expand(cell: CellType, nodes: &[NodeView], camera: &dyn Camera) -> Option<Expansion> {
        Expansion::new(cell, &nodes.iter().collect::<Vec<_>>(), camera)
    }

    fn points_of(cell: CellType) -> impl Iterator<Item = [f64; 2]> {
        let steps = (0..=10).map(|i| f64::from(i) / 10.0);
        let grid = steps.clone().flat_map(move |x| steps.clone().map(move |y| [x, y]));
        grid.filter(move |[x, y]| !cell.is_triangle() || x + y <= 1.0)
            .map(move |at| if cell.is_triangle() { at } else { at.map(|c| 2.0 * c - 1.0) })
    }

    /// Largest differences from the camera: in pixels, and of the Jacobian.
    fn differences(cell: CellType, nodes: &[NodeView], camera: &dyn Camera, expansion: &Expansion) -> [f64; 2] {
        let places: Vec<[f64; 3]> = nodes.iter().map(|node| node.place).collect();
        let mut worst = [0.0_f64; 2];
        for at in points_of(cell) {
            let (pixel, jacobian) = camera.project_with_jacobian(map(cell, &places, at));
            let monomials = monomials(at);
            for c in 0..2 {
                let coefficients = expansion.pixel[c].map(f64::from);
                let mut sum = expansion.origin[c] as f64 + coefficients[0];
                for (m, monomial) in monomials[..expansion.terms].iter().enumerate() {
                    let remainder = expansion.remainder[c].get(m).copied().unwrap_or_default();
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
                    if let Some(expansion) = expand(cell, &nodes, &camera) {
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
                        if let Some(expansion) = expand(cell, &nodes, &camera) {
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
    fn a_camera_without_perspective_is_expanded_exactly() {
        let camera = fedic_camera::FrontParallel::new(1.0, [12_000.3, 15_000.7]).unwrap();
        for cell in CellType::ALL {
            let nodes = warped(cell, 10.0, &camera);
            let expansion = expand(cell, &nodes, &camera).unwrap();
            let [pixel, jacobian] = differences(cell, &nodes, &camera, &expansion);
            assert!(pixel < 6e-7 && jacobian == 0.0, "{cell}: {pixel:e} px, {jacobian:e}");
        }
    }
}
