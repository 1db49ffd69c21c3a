//! Search for the cell that contains a point of the plane.

use crate::{Mesh, inverse_map};

/// Tolerance in reference coordinates for points on the edge of a cell.
const EDGE: f64 = 1e-9;
/// Margin for curved edges around the bounding box of a cell's nodes, as a fraction of the box.
const BULGE: f64 = 0.25;

/// Finds the cell of a mesh that contains a point of the `(x, y)` plane, by a uniform grid of buckets.
///
/// Surfaces in space are searched in their projection onto that plane; cells perpendicular to it contain no point.
#[derive(Debug, Clone)]
pub struct Locator<'a> {
    mesh: &'a Mesh,
    low: [f64; 2],
    per_length: [f64; 2],
    shape: [usize; 2],
    starts: Vec<usize>,
    cells: Vec<u32>,
}

impl<'a> Locator<'a> {
    /// Builds a grid with about one cell of `mesh` per bucket.
    pub fn new(mesh: &'a Mesh) -> Self {
        let boxes: Vec<[[f64; 2]; 2]> = (0..mesh.num_cells()).map(|c| bounding_box(mesh, c)).collect();
        let mut low = [f64::MAX; 2];
        let mut high = [f64::MIN; 2];
        for [a, b] in &boxes {
            for d in 0..2 {
                low[d] = low[d].min(a[d]);
                high[d] = high[d].max(b[d]);
            }
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        let pitch = (extent[0] * extent[1] / boxes.len() as f64).sqrt().max(f64::MIN_POSITIVE);
        let shape = extent.map(|e| ((e / pitch).ceil() as usize).clamp(1, boxes.len()));
        let per_length = [shape[0] as f64 / extent[0], shape[1] as f64 / extent[1]];
        let mut locator =
            Self { mesh, low, per_length, shape, starts: vec![0; shape[0] * shape[1] + 1], cells: vec![] };
        for corners in &boxes {
            locator.buckets(corners).for_each(|s| locator.starts[s + 1] += 1);
        }
        for s in 0..shape[0] * shape[1] {
            locator.starts[s + 1] += locator.starts[s];
        }
        let mut next = locator.starts.clone();
        locator.cells = vec![0; locator.starts[shape[0] * shape[1]]];
        for (cell, corners) in boxes.iter().enumerate() {
            for s in locator.buckets(corners) {
                locator.cells[next[s]] = cell as u32;
                next[s] += 1;
            }
        }
        locator
    }

    /// The mesh that is searched.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    fn bucket(&self, x: f64, d: usize) -> usize {
        (((x - self.low[d]) * self.per_length[d]).floor().max(0.0) as usize).min(self.shape[d] - 1)
    }

    fn buckets(&self, corners: &[[f64; 2]; 2]) -> impl Iterator<Item = usize> + use<> {
        let columns = self.bucket(corners[0][0], 0)..=self.bucket(corners[1][0], 0);
        let rows = self.bucket(corners[0][1], 1)..=self.bucket(corners[1][1], 1);
        let width = self.shape[0];
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    /// Index of the cell that contains `(x, y)` and the point's reference coordinates, or `None` outside the mesh.
    ///
    /// A point on a shared edge belongs to the cell of lowest index.
    pub fn find(&self, point: [f64; 2]) -> Option<(usize, [f64; 2])> {
        if !(point[0].is_finite() && point[1].is_finite()) {
            return None;
        }
        let bucket = self.bucket(point[1], 1) * self.shape[0] + self.bucket(point[0], 0);
        self.cells[self.starts[bucket]..self.starts[bucket + 1]].iter().find_map(|&cell| {
            let cell = cell as usize;
            let corners = bounding_box(self.mesh, cell);
            if (0..2).any(|d| point[d] < corners[0][d] || point[d] > corners[1][d]) {
                return None;
            }
            let (nodes, num_nodes) = self.mesh.cell_points_xy(cell);
            let cell_type = self.mesh.cell(cell).cell_type;
            let at = inverse_map(cell_type, &nodes[..num_nodes], point)?;
            cell_type.data().domain.contains(at, EDGE).then_some((cell, at))
        })
    }
}

/// Lower and upper corner of a box that contains the cell, including its curved edges.
fn bounding_box(mesh: &Mesh, cell: usize) -> [[f64; 2]; 2] {
    let mut low = [f64::MAX; 2];
    let mut high = [f64::MIN; 2];
    let (nodes, num_nodes) = mesh.cell_points_xy(cell);
    for p in &nodes[..num_nodes] {
        for d in 0..2 {
            low[d] = low[d].min(p[d]);
            high[d] = high[d].max(p[d]);
        }
    }
    let curved = mesh.cell(cell).cell_type.edge_intervals() > 1;
    let margin = if curved { BULGE } else { EDGE };
    for d in 0..2 {
        let m = margin * (high[d] - low[d]);
        (low[d], high[d]) = (low[d] - m, high[d] + m);
    }
    [low, high]
}
