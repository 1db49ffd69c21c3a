//! A synthetic speckle: a continuous texture, defined at any point of the plane.

use rayon::prelude::*;

use crate::error::SyntheticError;
use crate::random::{INCREMENT, mix};

/// Dark spots on a white ground: one per square of a regular grid, of random position, radius and darkness.
///
/// A spot of radius `R` darkens the ground by `a (1 - d^2 / R^2)^3` at the distance `d` from its centre, which is twice
/// continuously differentiable and zero beyond `R`: the grey level at a point depends on the spots of the nearest squares
/// only, nine up to a coverage of 0.33 and 25 above. The grey level is the product of `1 - darkness` over the spots.
///
/// # Examples
///
/// ```
/// use fedic_synthetic::Speckle;
/// let speckle = Speckle::new(4.0, 0.5, 7)?;
/// let grey = speckle.value([12.3, -4.5]);
/// assert!((0.0..=1.0).contains(&grey) && grey == Speckle::new(4.0, 0.5, 7)?.value([12.3, -4.5]));
/// # Ok::<(), fedic_synthetic::SyntheticError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speckle {
    size: f64,
    coverage: f64,
    seed: u64,
    pitch: f64,
    /// Squares on either side of the one that holds a point, whose spots may cover the point.
    reach: i64,
}

/// Ratio of the radius of a spot to the radius at half its darkness: `1 / sqrt(1 - 2^(-1/3))`.
const SUPPORT: f64 = 2.201_626_6;
/// Largest relative deviation of the radii from their mean.
const SPREAD: f64 = 0.25;
/// Points that share a table of spots.
const CHUNK: usize = 4096;

impl Speckle {
    /// A speckle whose spots have the mean diameter `size` (at half darkness, in the unit of the plane) and darken about
    /// the fraction `coverage` of the ground. The same seed gives the same speckle.
    ///
    /// # Errors
    ///
    /// [`SyntheticError::InvalidOption`] if the size is not positive or the coverage not between 0.1 and 0.7.
    pub fn new(size: f64, coverage: f64, seed: u64) -> Result<Self, SyntheticError> {
        let refuse = |option, expected, value: f64| {
            Err(SyntheticError::InvalidOption { option, expected, value: value.to_string() })
        };
        if !(size.is_finite() && size > 0.0) {
            return refuse("size", "a positive length", size);
        }
        if !(0.1..=0.7).contains(&coverage) {
            return refuse("coverage", "between 0.1 and 0.7", coverage);
        }
        // The disks of mean diameter `size`, one per square, cover this fraction of it if they overlap at random.
        let disk = 0.25 * std::f64::consts::PI * size * size;
        let pitch = (disk / -(1.0 - coverage).ln()).sqrt();
        let largest = 0.5 * size * SUPPORT * (1.0 + SPREAD);
        Ok(Self { size, coverage, seed, pitch, reach: (largest / pitch).ceil() as i64 })
    }

    /// Mean diameter of the spots.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Fraction of the ground that is dark.
    pub fn coverage(&self) -> f64 {
        self.coverage
    }

    /// Seed of the random positions.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Grey level at a point of the plane, from 0 (black) to 1 (the white ground).
    pub fn value(&self, point: [f64; 2]) -> f64 {
        let [column, row] = self.square(point);
        let around = |centre: i64| centre.saturating_sub(self.reach)..=centre.saturating_add(self.reach);
        let mut light = 1.0;
        for row in around(row) {
            for column in around(column) {
                light *= self.spot(column, row).light(point);
            }
        }
        light
    }

    /// [`value`](Self::value) at many points, in parallel and with the same bits; many times faster if consecutive points are
    /// close to each other.
    pub fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let mut values = vec![0.0; points.len()];
        values.par_chunks_mut(CHUNK).zip(points.par_chunks(CHUNK)).for_each(|(values, points)| {
            let table = SpotTable::around(self, points);
            for (value, &point) in values.iter_mut().zip(points) {
                *value = table.as_ref().map_or_else(|| self.value(point), |table| table.value(point));
            }
        });
        values
    }

    /// Squares along one edge of the neighbourhood of a point.
    fn side(&self) -> usize {
        2 * self.reach as usize + 1
    }

    /// Column and row of the square that holds a point.
    fn square(&self, point: [f64; 2]) -> [i64; 2] {
        point.map(|x| (x / self.pitch).floor() as i64)
    }

    fn spot(&self, column: i64, row: i64) -> Spot {
        let [a, b, c, d] = random(self.seed, column, row);
        let radius = 0.5 * self.size * SUPPORT * (1.0 + SPREAD * (2.0 * c - 1.0));
        Spot {
            centre: [(column as f64 + a) * self.pitch, (row as f64 + b) * self.pitch],
            inverse_square: 1.0 / (radius * radius),
            darkness: 0.75 + 0.25 * d,
        }
    }
}

#[derive(Clone, Copy)]
struct Spot {
    centre: [f64; 2],
    /// `1 / R^2`.
    inverse_square: f64,
    darkness: f64,
}

impl Spot {
    /// Transmitted fraction of the light at a point; exactly 1 outside the spot.
    #[inline]
    fn light(&self, [x, y]: [f64; 2]) -> f64 {
        let [dx, dy] = [x - self.centre[0], y - self.centre[1]];
        let inside = 1.0 - (dx * dx + dy * dy) * self.inverse_square;
        let inside = if inside > 0.0 { inside } else { 0.0 };
        1.0 - self.darkness * (inside * inside * inside)
    }
}

/// The spots of a rectangle of squares, row by row.
struct SpotTable<'a> {
    speckle: &'a Speckle,
    first: [i64; 2],
    columns: usize,
    spots: Vec<Spot>,
}

impl<'a> SpotTable<'a> {
    /// The spots that may cover the points; `None` if the table would have more spots than the points visit one by one.
    fn around(speckle: &'a Speckle, points: &[[f64; 2]]) -> Option<Self> {
        let mut first = [i64::MAX; 2];
        let mut last = [i64::MIN; 2];
        for &point in points {
            let square = speckle.square(point);
            first = std::array::from_fn(|d| first[d].min(square[d]));
            last = std::array::from_fn(|d| last[d].max(square[d]));
        }
        let first = [first[0].checked_sub(speckle.reach)?, first[1].checked_sub(speckle.reach)?];
        let last = [last[0].checked_add(speckle.reach)?, last[1].checked_add(speckle.reach)?];
        let count = |d: usize| usize::try_from(last[d].checked_sub(first[d])?).ok()?.checked_add(1);
        let columns = count(0)?;
        let visits = points.len() * speckle.side() * speckle.side();
        if columns.checked_mul(count(1)?)? > visits {
            return None;
        }
        let row = |row| (first[0]..=last[0]).map(move |column| speckle.spot(column, row));
        Some(Self { speckle, first, columns, spots: (first[1]..=last[1]).flat_map(row).collect() })
    }

    /// [`Speckle::value`] at one of the points of the table.
    fn value(&self, point: [f64; 2]) -> f64 {
        let square = self.speckle.square(point);
        let [column, row] = [0, 1].map(|d| (square[d] - self.speckle.reach - self.first[d]) as usize);
        let mut light = 1.0;
        for row in self.spots.chunks_exact(self.columns).skip(row).take(self.speckle.side()) {
            for spot in &row[column..column + self.speckle.side()] {
                light *= spot.light(point);
            }
        }
        light
    }
}

/// Four random numbers in `[0, 1)`, a function of the seed and of the square of the grid.
fn random(seed: u64, column: i64, row: i64) -> [f64; 4] {
    let square = mix(mix(seed.wrapping_add(INCREMENT) ^ column as u64).wrapping_add(row as u64));
    let second = mix(square.wrapping_add(INCREMENT));
    let unit = |bits: u64| (bits & 0xffff_ffff) as f64 / f64::from(u32::MAX) * (1.0 - 1e-9);
    [unit(square), unit(square >> 32), unit(second), unit(second >> 32)]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn assert_same_bits(speckle: &Speckle, points: &[[f64; 2]]) {
        let one_by_one = points.iter().map(|&point| speckle.value(point).to_bits());
        assert!(speckle.values(points).into_iter().map(f64::to_bits).eq(one_by_one));
    }

    /// A rotated grid of points, so that rows of squares change within a chunk.
    fn raster(step: f64, origin: [f64; 2]) -> Vec<[f64; 2]> {
        let at = |k: u32| [f64::from(k % 150) * step, f64::from(k / 150) * step];
        (0..150 * 90).map(at).map(|[x, y]| [origin[0] + 0.8 * x - 0.6 * y, origin[1] + 0.6 * x + 0.8 * y]).collect()
    }

    #[test]
    fn values_have_the_same_bits_as_value() {
        for coverage in [0.1, 0.33, 0.5, 0.7] {
            let speckle = Speckle::new(3.0, coverage, 11).unwrap();
            for step in [0.1, 1.0] {
                let points = raster(step, [-40.0, -70.0]);
                assert!(points.chunks(CHUNK).all(|chunk| SpotTable::around(&speckle, chunk).is_some()));
                assert_same_bits(&speckle, &points);
            }
        }
    }

    #[test]
    fn scattered_points_are_evaluated_without_a_table() {
        let speckle = Speckle::new(3.0, 0.5, 11).unwrap();
        let far = raster(1e4, [0.0; 2]);
        assert!(SpotTable::around(&speckle, &far).is_none());
        assert_same_bits(&speckle, &far);
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
            assert_same_bits(&speckle, &[[x, 0.0], [1.0, 2.0], [0.0, x]]);
            assert_eq!(speckle.value([x, 0.0]), 1.0, "{x}");
        }
        assert!(speckle.values(&[]).is_empty());
    }

    #[test]
    fn no_spot_beyond_the_neighbourhood_covers_a_point() {
        for (coverage, squares) in [(0.1, 9), (0.33, 9), (0.34, 25), (0.5, 25), (0.7, 25)] {
            let speckle = Speckle::new(3.0, coverage, 5).unwrap();
            assert_eq!(speckle.side() * speckle.side(), squares, "coverage {coverage}");
            let wider = Speckle { reach: speckle.reach + 2, ..speckle };
            for point in raster(0.3, [10.0, -20.0]) {
                assert_eq!(speckle.value(point), wider.value(point), "{point:?}");
            }
        }
    }
}
