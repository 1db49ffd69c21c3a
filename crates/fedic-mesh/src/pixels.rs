//! The pixels whose centre lies in a cell: the classical region of interest (paper, Sect. 2.2).

/// Appends the integer points `[u, v]` inside a polygon with straight edges, row by row.
///
/// A point on an edge that two polygons share belongs to exactly one of them: edges are half-open, and a shared edge is
/// intersected with the rows by the same arithmetic in both directions. Polygons that tile a region therefore partition its
/// pixels.
///
/// # Examples
///
/// ```
/// use fedic_mesh::pixels_in_polygon;
/// let mut pixels = Vec::new();
/// pixels_in_polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], &mut pixels);
/// assert_eq!(pixels, [[0, 0], [1, 0], [0, 1], [1, 1]]);
/// ```
pub fn pixels_in_polygon(polygon: &[[f64; 2]], pixels: &mut Vec<[i32; 2]>) {
    let (low, high) = polygon.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[1]), h.max(p[1])));
    let mut crossings = Vec::with_capacity(polygon.len());
    for v in low.ceil() as i32..=high.floor() as i32 {
        crossings.clear();
        for (k, &a) in polygon.iter().enumerate() {
            let b = polygon[(k + 1) % polygon.len()];
            crossings.extend(crossing(a, b, f64::from(v)));
        }
        crossings.sort_unstable_by(f64::total_cmp);
        for span in crossings.chunks_exact(2) {
            pixels.extend((span[0].ceil() as i32..span[1].ceil() as i32).map(|u| [u, v]));
        }
    }
}

/// Column at which an edge crosses row `v`; the edge excludes its upper end.
fn crossing(a: [f64; 2], b: [f64; 2], v: f64) -> Option<f64> {
    let (bottom, top) = if (a[1], a[0]) <= (b[1], b[0]) { (a, b) } else { (b, a) };
    if v < bottom[1] || v >= top[1] {
        return None;
    }
    Some(bottom[0] + (v - bottom[1]) / (top[1] - bottom[1]) * (top[0] - bottom[0]))
}
