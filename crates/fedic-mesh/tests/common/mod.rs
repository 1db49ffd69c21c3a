//! Random cells and meshes for the tests.

// Every test file compiles its own copy and uses a part of it.
#![allow(dead_code, clippy::unwrap_used)]

use std::collections::HashMap;

use fedic_mesh::{CellType, MAX_NODES, Mesh, map, shape_values};

/// Reproducible random numbers.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn index(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// A point of the reference domain of a cell.
    pub(crate) fn reference_point(&mut self, cell_type: CellType) -> [f64; 2] {
        if cell_type.is_triangle() {
            let (a, b) = (self.between(0.0, 1.0), self.between(0.0, 1.0));
            if a + b < 1.0 { [a, b] } else { [1.0 - a, 1.0 - b] }
        } else {
            [self.between(-1.0, 1.0), self.between(-1.0, 1.0)]
        }
    }

    /// A matrix of random rotation, shear and aspect, and of determinant `size^2`.
    pub(crate) fn affine(&mut self, size: f64) -> [[f64; 2]; 2] {
        let (sin, cos) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let (shear, aspect) = (self.between(-0.8, 0.8), self.between(0.6, 1.6));
        let stretched = [[aspect, shear], [0.0, 1.0 / aspect]];
        let row = |a: f64, b: f64| [0, 1].map(|column| size * (a * stretched[0][column] + b * stretched[1][column]));
        [row(cos, -sin), row(sin, cos)]
    }

    /// Corners of a convex cell of about `size`, anywhere within 1000 of the origin.
    pub(crate) fn corners(&mut self, cell_type: CellType, size: f64) -> Vec<[f64; 2]> {
        let [[a, b], [c, d]] = self.affine(size);
        let origin = [self.between(-1000.0, 1000.0), self.between(-1000.0, 1000.0)];
        let square: &[[f64; 2]] = &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let triangle: &[[f64; 2]] = &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let corners = if cell_type.is_triangle() { triangle } else { square };
        let mut jittered = |c: f64| c + self.between(-0.2, 0.2);
        let moved: Vec<[f64; 2]> = corners.iter().map(|&[x, y]| [jittered(x), jittered(y)]).collect();
        moved.into_iter().map(|[x, y]| [origin[0] + a * x + b * y, origin[1] + c * x + d * y]).collect()
    }

    /// A cell with curved edges: its middle nodes moved by up to `curvature` times its size.
    pub(crate) fn curved_cell(&mut self, cell_type: CellType, size: f64, curvature: f64) -> Vec<[f64; 2]> {
        let mut nodes = straight_cell(cell_type, &self.corners(cell_type, size));
        for node in &mut nodes[cell_type.num_corners()..] {
            *node = node.map(|c| c + self.between(-curvature, curvature) * size);
        }
        nodes
    }
}

/// The linear cell with the same corners.
pub(crate) fn linear(cell_type: CellType) -> CellType {
    if cell_type.is_triangle() { CellType::Triangle } else { CellType::Quad }
}

/// Nodes of a cell with straight edges, the middle nodes halfway.
pub(crate) fn straight_cell(cell_type: CellType, corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
    cell_type.reference_nodes().iter().map(|&at| map(linear(cell_type), corners, at)).collect()
}

pub(crate) fn determinant([[a, b], [c, d]]: [[f64; 2]; 2]) -> f64 {
    a * d - b * c
}

/// Signed area of a polygon.
pub(crate) fn shoelace(polygon: &[[f64; 2]]) -> f64 {
    // About the first corner: far from the origin the products would lose digits.
    let [x0, y0] = polygon[0];
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(a, b)| 0.5 * ((a[0] - x0) * (b[1] - y0) - (a[1] - y0) * (b[0] - x0))).sum()
}

/// How far inside a convex polygon that turns counter-clockwise a point lies; negative outside.
pub(crate) fn depth_in_convex(polygon: &[[f64; 2]], point: [f64; 2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let depths = polygon.iter().zip(next).map(|(a, b)| {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        (dx * (point[1] - a[1]) - dy * (point[0] - a[0])) / dx.hypot(dy)
    });
    depths.fold(f64::INFINITY, f64::min)
}

/// A grid of nodes whose squares become one quad or two triangles each, of types drawn from a list.
///
/// `place` takes the node `[i, j]` of the grid to the plane and must keep the squares convex; cells turn either way.
pub(crate) fn mesh_of_grid(
    random: &mut Random,
    [columns, rows]: [usize; 2],
    types: &[CellType],
    mut place: impl FnMut(&mut Random, [usize; 2]) -> [f64; 2],
) -> Mesh {
    let mut nodes = Builder::default();
    for j in 0..=rows {
        for i in 0..=columns {
            let [x, y] = place(random, [i, j]);
            nodes.points.push([x, y, 0.0]);
        }
    }
    let mut blocks = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let first = j * (columns + 1) + i;
            let square = [first, first + 1, first + columns + 2, first + columns + 1];
            let cell_type = types[random.index(types.len())];
            let turned = random.index(4);
            let [a, b, c, d] = std::array::from_fn(|k| square[(k + turned) % 4]);
            let corners: &[&[usize]] =
                if cell_type.is_triangle() { &[&[a, b, c], &[a, c, d]] } else { &[&[a, b, c, d]] };
            for corners in corners {
                let mut corners = corners.to_vec();
                if random.index(2) == 0 {
                    corners.reverse();
                }
                blocks.push((cell_type, nodes.cell(cell_type, &corners)));
            }
        }
    }
    Mesh::new(nodes.points, &blocks).unwrap()
}

/// Nodes of a mesh; nodes other than the corners are created when first used.
#[derive(Default)]
struct Builder {
    points: Vec<[f64; 3]>,
    /// By the corners they lie between and their weights, in parts per million.
    between: HashMap<Vec<(usize, i64)>, usize>,
}

impl Builder {
    fn cell(&mut self, cell_type: CellType, corners: &[usize]) -> Vec<i64> {
        let nodes = cell_type.reference_nodes().iter();
        nodes.map(|&at| self.node(corners, shape_values(linear(cell_type), at)) as i64).collect()
    }

    /// The node at a weighted mean of corners.
    fn node(&mut self, corners: &[usize], weights: [f64; MAX_NODES]) -> usize {
        let mut parents: Vec<(usize, f64)> =
            corners.iter().copied().zip(weights).filter(|p| p.1.abs() > 1e-9).collect();
        if let [(corner, _)] = parents[..] {
            return corner;
        }
        parents.sort_unstable_by_key(|&(corner, _)| corner);
        let key = parents.iter().map(|&(corner, weight)| (corner, (weight * 1e6).round() as i64)).collect();
        *self.between.entry(key).or_insert_with(|| {
            let mean = |d: usize| parents.iter().map(|&(corner, weight)| weight * self.points[corner][d]).sum::<f64>();
            self.points.push([mean(0), mean(1), 0.0]);
            self.points.len() - 1
        })
    }
}

/// A rotated and sheared grid of `[columns, rows]` squares of about `size` with its inner nodes moved by up to `jitter` of
/// it along either axis, and its outline. Squares stay convex for a jitter below 1/4.
pub(crate) fn jittered_mesh(
    random: &mut Random,
    shape: [usize; 2],
    types: &[CellType],
    size: f64,
    jitter: f64,
) -> (Mesh, Vec<[f64; 2]>) {
    let [[a, b], [c, d]] = random.affine(size);
    let origin = [random.between(-20.0, 20.0), random.between(-20.0, 20.0)];
    let at = |x: f64, y: f64| [origin[0] + a * x + b * y, origin[1] + c * x + d * y];
    let mesh = mesh_of_grid(random, shape, types, |random, [i, j]| {
        let mut moved = |k: usize, n: usize| {
            let inner = k > 0 && k < n;
            k as f64 + if inner { random.between(-jitter, jitter) } else { 0.0 }
        };
        at(moved(i, shape[0]), moved(j, shape[1]))
    });
    let [width, height] = shape.map(|n| n as f64);
    (mesh, vec![at(0.0, 0.0), at(width, 0.0), at(width, height), at(0.0, height)])
}

/// Nodes of a cell listed in the opposite direction: the reference domain mirrored at its diagonal.
pub(crate) fn clockwise<T: Copy>(cell_type: CellType, nodes: &[T]) -> Vec<T> {
    let all = cell_type.reference_nodes();
    let mirrored = |&[x, y]: &[f64; 2]| all.iter().position(|&[a, b]| (a - y).abs() + (b - x).abs() < 1e-9).unwrap();
    all.iter().map(|at| nodes[mirrored(at)]).collect()
}

/// Cell types whose edges have this many intervals.
pub(crate) fn types_with_edge_intervals(intervals: usize) -> Vec<CellType> {
    CellType::ALL.into_iter().filter(|cell| cell.edge_intervals() == intervals).collect()
}

/// Nodes of a cell in the plane.
pub(crate) fn cell_nodes(mesh: &Mesh, cell: usize) -> Vec<[f64; 2]> {
    mesh.cell_points(cell).iter().map(|p| [p[0], p[1]]).collect()
}
