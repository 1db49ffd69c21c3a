//! Axes in the tangent plane along which strains are given.

/// Radii, relative to the distance of the point from the axis, below which a projected direction counts as zero.
const PARALLEL: f64 = 1e-6;

/// Axes of the components of a strain.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum StrainAxes {
    /// The local axes of the surface ([`SurfaceGradients::axes`](crate::SurfaceGradients::axes)): `x` and `y` in a mesh
    /// parallel to the `(x, y)` plane.
    #[default]
    Local,
    /// The local axes turned counter-clockwise, seen against the normal, by an angle in radians.
    Turned(f64),
    /// Radial and circumferential direction about the axis parallel to `z` through a point of the `(x, y)` plane.
    ///
    /// In a mesh parallel to the `(x, y)` plane axis 1 points away from the centre and axis 2 is counter-clockwise. On any other
    /// surface axis 2 is the projection of the circumferential direction onto the tangent plane and axis 1 is perpendicular to
    /// it; where the surface is perpendicular to the circumferential direction, axis 1 is the projection of the radial direction.
    /// At the centre itself the axes are the local ones.
    Cylindrical {
        /// The centre, in the mesh's unit.
        centre: [f64; 2],
    },
}

impl StrainAxes {
    /// Counter-clockwise angle from the local axes at a position to these axes.
    pub(super) fn angle(self, [x, y, _]: [f64; 3], [first, second]: [[f64; 3]; 2]) -> f64 {
        match self {
            Self::Local => 0.0,
            Self::Turned(angle) => angle,
            Self::Cylindrical { centre } => {
                let [x, y] = [x - centre[0], y - centre[1]];
                let along = |axis: [f64; 3], [x, y]: [f64; 2]| x * axis[0] + y * axis[1];
                let circumferential = [along(first, [-y, x]), along(second, [-y, x])];
                if circumferential[0].hypot(circumferential[1]) > PARALLEL * x.hypot(y) {
                    (-circumferential[0]).atan2(circumferential[1])
                } else {
                    along(second, [x, y]).atan2(along(first, [x, y]))
                }
            }
        }
    }
}
