//! The strain at one point of a surface, with the axes of its components.

use super::axes::StrainAxes;

/// Strain at a point of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceStrain {
    /// The point.
    pub position: [f64; 3],
    /// Orthonormal axes of the tangent plane; their cross product is the normal.
    pub axes: [[f64; 3]; 2],
    /// Strain `[e_11, e_22, e_12]` along the axes: tension positive, shear as the tensor component.
    pub components: [f64; 3],
}

impl SurfaceStrain {
    /// The same strain along other axes of the tangent plane.
    pub fn along(self, axes: StrainAxes) -> Self {
        let (sin, cos) = axes.angle(self.position, self.axes).sin_cos();
        let [first, second] = self.axes;
        let [e11, e22, e12] = self.components;
        Self {
            position: self.position,
            axes: [
                std::array::from_fn(|d| cos * first[d] + sin * second[d]),
                std::array::from_fn(|d| cos * second[d] - sin * first[d]),
            ],
            components: [
                cos * cos * e11 + sin * sin * e22 + 2.0 * sin * cos * e12,
                sin * sin * e11 + cos * cos * e22 - 2.0 * sin * cos * e12,
                sin * cos * (e22 - e11) + (cos * cos - sin * sin) * e12,
            ],
        }
    }

    /// The strain as a tensor in space: `[xx, yy, zz, xy, yz, zx]`.
    pub(super) fn tensor(&self) -> [f64; 6] {
        let [a, b] = self.axes;
        let [e11, e22, e12] = self.components;
        let entry = |i: usize, j: usize| e11 * a[i] * a[j] + e22 * b[i] * b[j] + e12 * (a[i] * b[j] + b[i] * a[j]);
        [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)]
    }

    /// Part of a tensor in space along two axes.
    pub(super) fn of_tensor([xx, yy, zz, xy, yz, zx]: [f64; 6], axes: [[f64; 3]; 2], position: [f64; 3]) -> Self {
        let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
        let entry = |a: [f64; 3], b: [f64; 3]| -> f64 {
            (0..3).map(|i| a[i] * (0..3).map(|j| rows[i][j] * b[j]).sum::<f64>()).sum()
        };
        let [a, b] = axes;
        Self { position, axes, components: [entry(a, a), entry(b, b), entry(a, b)] }
    }
}
