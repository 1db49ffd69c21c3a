//! Images of a synthetic speckle before and after a motion, and meshes to measure it on.

// Every test file compiles its own copy and uses a part of it.
#![allow(dead_code)]

use fedic::{Camera, CellType, Image, Mesh, rectangle_mesh, unproject};
use fedic_synthetic::Speckle;

/// A motion of the plane: `X` goes to `centre + gradient (X - centre) + shift`.
#[derive(Clone, Copy)]
pub(crate) struct Motion {
    pub(crate) gradient: [[f64; 2]; 2],
    pub(crate) shift: [f64; 2],
    pub(crate) centre: [f64; 2],
}

impl Motion {
    pub(crate) fn translation(shift: [f64; 2]) -> Self {
        Self { gradient: [[1.0, 0.0], [0.0, 1.0]], shift, centre: [0.0; 2] }
    }

    pub(crate) fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.gradient;
        let (dx, dy) = (x - self.centre[0], y - self.centre[1]);
        [(a - 1.0) * dx + b * dy + self.shift[0], c * dx + (d - 1.0) * dy + self.shift[1]]
    }

    fn origin(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.gradient;
        let (dx, dy) = (x - self.centre[0] - self.shift[0], y - self.centre[1] - self.shift[1]);
        let det = a * d - b * c;
        [self.centre[0] + (d * dx - b * dy) / det, self.centre[1] + (a * dy - c * dx) / det]
    }
}

/// Images of a speckled plane before and after a motion, in grey levels from 35 to 215, not rounded.
pub(crate) fn render(camera: &dyn Camera, [width, height]: [usize; 2], speckle: Speckle, motion: Motion) -> [Image; 2] {
    let image = |origin: &dyn Fn([f64; 2]) -> [f64; 2]| {
        let pixels = (0..width * height).map(|k| [(k % width) as f64, (k / width) as f64]);
        let greys = pixels.map(|pixel| {
            let [x, y, _] = unproject(camera, pixel, 0.0).unwrap();
            (35.0 + 180.0 * speckle.value(origin([x, y]))) as f32
        });
        Image::new(width, height, greys.collect()).unwrap()
    };
    [image(&|point| point), image(&|point| motion.origin(point))]
}

/// A rectangle whose nodes are moved by up to `warp` along smooth waves, so that all cells differ and edges of quadratic
/// cells are curved.
pub(crate) fn warped_mesh(bounds: [f64; 4], size: f64, cell: CellType, warp: f64) -> Mesh {
    let mesh = rectangle_mesh(bounds, size, cell).unwrap();
    let [x0, y0, x1, y1] = bounds;
    let points = mesh.points().iter().map(|&[x, y, z]| {
        let [s, t] = [(x - x0) / (x1 - x0), (y - y0) / (y1 - y0)].map(|c| c * std::f64::consts::TAU);
        [x + warp * s.sin() * (t + 1.0).cos(), y + warp * (s - 1.0).cos() * t.sin(), z]
    });
    let cells = mesh.cells().flat_map(|c| c.nodes.iter().map(|&n| i64::from(n))).collect();
    Mesh::new(points.collect(), &[(cell, cells)]).unwrap()
}

/// A square grid of `side x side` squares of `size`, every other one cut into two triangles.
pub(crate) fn mixed_mesh(origin: [f64; 2], side: usize, size: f64) -> Mesh {
    let at = |k: usize| [origin[0] + size * (k % (side + 1)) as f64, origin[1] + size * (k / (side + 1)) as f64, 0.0];
    let points = (0..(side + 1) * (side + 1)).map(at).collect();
    let (mut quads, mut triangles) = (Vec::new(), Vec::new());
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        let a = (row * (side + 1) + column) as i64;
        let (b, d) = (a + 1, a + side as i64 + 1);
        let c = d + 1;
        if (row + column) % 2 == 0 {
            quads.extend([a, b, c, d]);
        } else {
            triangles.extend([a, b, c, a, c, d]);
        }
    }
    Mesh::new(points, &[(CellType::Quad, quads), (CellType::Triangle, triangles)]).unwrap()
}

/// Largest difference between a nodal displacement and the motion.
pub(crate) fn largest_error(mesh: &Mesh, displacement: &[[f64; 2]], motion: Motion) -> f64 {
    let errors = mesh.points().iter().zip(displacement).map(|(point, u)| {
        let exact = motion.displacement([point[0], point[1]]);
        (u[0] - exact[0]).hypot(u[1] - exact[1])
    });
    // NaN must not pass for the smallest error.
    errors.fold(0.0, |largest, error| if error > largest || error.is_nan() { error } else { largest })
}
