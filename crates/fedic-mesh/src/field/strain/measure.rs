//! Strain measures as functions of the displacement gradient.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// Step of the derivative of a Hencky strain with respect to the Green-Lagrange strain.
const STEP: f64 = 1e-6;

/// Strain measure of the reference configuration.
///
/// `H` is the gradient of the displacement along the surface, `F = I + H` the deformation gradient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum StrainMeasure {
    /// Green-Lagrange strain `E = (F^T F - I) / 2`: zero under any rigid motion.
    #[default]
    GreenLagrange,
    /// Hencky (logarithmic) strain of the right stretch tensor, `ln U = ln(F^T F) / 2`: zero under any rigid motion.
    Hencky,
    /// Small (infinitesimal) strain `(H + H^T) / 2`: a rotation by an angle `a` adds `cos(a) - 1` to both normal strains.
    Small,
}

impl StrainMeasure {
    /// Every measure.
    pub const ALL: [Self; 3] = [Self::GreenLagrange, Self::Hencky, Self::Small];

    /// Names of the measures, in the order of [`StrainMeasure::ALL`].
    pub const NAMES: [&str; 3] = [Self::GreenLagrange.name(), Self::Hencky.name(), Self::Small.name()];

    /// Name of the measure.
    pub const fn name(self) -> &'static str {
        match self {
            Self::GreenLagrange => "green-lagrange",
            Self::Hencky => "hencky",
            Self::Small => "small",
        }
    }

    /// Strain `[e_11, e_22, e_12]` of a displacement gradient: tension positive, shear as the tensor component.
    ///
    /// Row `a`, column `b` of `gradient` is the derivative of component `a` with respect to the position along axis `b`; the
    /// third component is normal to the surface. The Hencky strain is not finite if the surface is compressed to a line.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::StrainMeasure;
    /// // Rotation by 90 degrees.
    /// let gradient = [[-1.0, -1.0], [1.0, -1.0], [0.0, 0.0]];
    /// assert_eq!(StrainMeasure::GreenLagrange.of_gradient(&gradient), [0.0, 0.0, 0.0]);
    /// assert_eq!(StrainMeasure::Small.of_gradient(&gradient), [-1.0, -1.0, 0.0]);
    /// ```
    pub fn of_gradient(self, gradient: &[[f64; 2]; 3]) -> [f64; 3] {
        match self {
            Self::Small => small(gradient),
            Self::GreenLagrange => green_lagrange(gradient),
            Self::Hencky => hencky(green_lagrange(gradient)),
        }
    }

    /// Derivative of the strain: entry `[s][a][b]` is that of component `s` with respect to `gradient[a][b]`. That of the Hencky strain is
    /// found by central differences, to about 1e-9.
    #[must_use]
    pub fn derivative(self, gradient: &[[f64; 2]; 3]) -> [[[f64; 2]; 3]; 3] {
        match self {
            Self::Small => product_derivative(&[[0.0; 2]; 3]),
            Self::GreenLagrange => product_derivative(gradient),
            Self::Hencky => {
                let (strain, inner) = (green_lagrange(gradient), product_derivative(gradient));
                let mut derivative = [[[0.0; 2]; 3]; 3];
                for (component, inner) in inner.iter().enumerate() {
                    let moved = |step: f64| {
                        let mut moved = strain;
                        moved[component] += step;
                        hencky(moved)
                    };
                    let (up, down) = (moved(STEP), moved(-STEP));
                    for (s, of_strain) in derivative.iter_mut().enumerate() {
                        let outer = (up[s] - down[s]) / (2.0 * STEP);
                        let entries = of_strain.as_flattened_mut().iter_mut().zip(inner.as_flattened());
                        entries.for_each(|(entry, inner)| *entry += outer * inner);
                    }
                }
                derivative
            }
        }
    }
}

/// Small strain `(H + H^T) / 2`.
fn small([x, y, _]: &[[f64; 2]; 3]) -> [f64; 3] {
    [x[0], y[1], 0.5 * (x[1] + y[0])]
}

/// Derivative of `(F^T F - I) / 2` with `F = I + H` with respect to `H`.
fn product_derivative(gradient: &[[f64; 2]; 3]) -> [[[f64; 2]; 3]; 3] {
    let deformation = |a: usize, b: usize| f64::from(u8::from(a == b)) + gradient[a][b];
    [(0, 0), (1, 1), (0, 1)].map(|(p, q)| {
        let mut derivative = [[0.0; 2]; 3];
        for (a, row) in derivative.iter_mut().enumerate() {
            row[p] += 0.5 * deformation(a, q);
            row[q] += 0.5 * deformation(a, p);
        }
        derivative
    })
}

/// Green-Lagrange strain `(H + H^T + H^T H) / 2`, without the cancellation of `F^T F - I`.
fn green_lagrange(gradient: &[[f64; 2]; 3]) -> [f64; 3] {
    let small = small(gradient);
    let product = |a: usize, b: usize| gradient.iter().map(|row| row[a] * row[b]).sum::<f64>();
    [small[0] + 0.5 * product(0, 0), small[1] + 0.5 * product(1, 1), small[2] + 0.5 * product(0, 1)]
}

/// Hencky strain `ln(I + 2 E) / 2` of the Green-Lagrange strain `E`, which has the same principal directions.
fn hencky([e11, e22, e12]: [f64; 3]) -> [f64; 3] {
    let (mean, half_difference) = (0.5 * (e11 + e22), 0.5 * (e11 - e22));
    let radius = half_difference.hypot(e12);
    let second = mean - radius;
    // Half the difference of the two logarithms; the ratio to `radius` has the limit 1 / (1 + 2 E) for equal strains.
    let log_radius = 0.25 * (4.0 * radius / (1.0 + 2.0 * second)).ln_1p();
    let log_mean = 0.5 * (2.0 * second).ln_1p() + log_radius;
    let ratio = if radius > 0.0 { log_radius / radius } else { 0.0 };
    [log_mean + ratio * half_difference, log_mean - ratio * half_difference, ratio * e12]
}

impl fmt::Display for StrainMeasure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for StrainMeasure {
    type Err = UnknownStrainMeasure;

    fn from_str(name: &str) -> Result<Self, UnknownStrainMeasure> {
        let found = Self::ALL.into_iter().find(|measure| measure.name() == name);
        found.ok_or_else(|| UnknownStrainMeasure { name: name.to_owned() })
    }
}

/// A name that is not a strain measure.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "unknown strain measure \"{name}\"; choose one of {}",
    StrainMeasure::NAMES.map(|name| format!("\"{name}\"")).join(", ")
)]
pub struct UnknownStrainMeasure {
    /// The name given.
    pub name: String,
}
