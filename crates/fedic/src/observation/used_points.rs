//! Quadrature points of a cell that carry a weight: inside both images, neither masked nor saturated.

use fedic_mesh::CellType;

/// Smallest share of its points with which a cell is used.
const MIN_SHARE: f64 = 0.1;
/// Smallest number of points for each unknown of a cell.
const POINTS_PER_UNKNOWN: usize = 2;
/// Part of the full scale up to which a grey level counts as saturated. A grey level comes this close only where all the pixels
/// that it is interpolated from are saturated.
const SATURATED: f32 = 0.998;
/// Side, in pixels, of the smallest square whose saturation is looked for: that which an interpolation reads.
pub(crate) const SATURATED_SQUARE: usize = 5;
/// Correction in pixels below which the set of used points may only shrink.
const FROZEN_CORRECTION: f64 = 0.5;
/// Number of corrections after which it may only shrink, however large they are.
const FROZEN_AFTER: usize = 10;

/// Whether a cell with `used` of its `count` points is left out, for a displacement of `components`.
pub(crate) fn is_too_few(used: usize, count: usize, cell_type: CellType, components: usize) -> bool {
    (used as f64) < MIN_SHARE * count as f64 || used < POINTS_PER_UNKNOWN * components * cell_type.num_nodes()
}

/// Grey level from which on a point is saturated in an image of this full scale.
pub(crate) fn saturated_from(full_scale: f32) -> f32 {
    SATURATED * full_scale
}

/// Points of a deformed image without weight, cell by cell.
///
/// While the displacement still moves, points leave the image and come back. From the first small correction on, those that are out
/// stay out, so that the iterations end.
#[derive(Debug, Default)]
pub(crate) struct UsedPoints {
    /// Points without weight; absent in cells all of whose points are used. Empty before the first pass.
    unused: Vec<Option<Box<[bool]>>>,
    num_unused: usize,
    frozen: bool,
    corrections: usize,
    /// Number of points without weight in the Hessian assembled last; zero in that of the reference image.
    in_hessian: usize,
}

impl UsedPoints {
    /// Points of a cell that stay without weight.
    pub(crate) fn excluded(&self, cell: usize) -> Option<&[bool]> {
        if !self.frozen {
            return None;
        }
        self.unused.get(cell)?.as_deref()
    }

    /// Takes note of the points without weight of all cells in a pass, and whether it assembled a Hessian.
    pub(crate) fn update(&mut self, unused: Vec<Option<Box<[bool]>>>, with_hessian: bool) {
        self.num_unused = unused.iter().flatten().map(|cell| cell.iter().filter(|&&out| out).count()).sum();
        self.unused = unused;
        if with_hessian && self.frozen {
            self.in_hessian = self.num_unused;
        }
    }

    /// Takes note of the largest correction, in pixels.
    pub(crate) fn advance(&mut self, correction: f64) {
        self.corrections += 1;
        self.frozen |= correction <= FROZEN_CORRECTION || self.corrections >= FROZEN_AFTER;
    }

    /// Whether the Hessian assembled last is that of other points.
    pub(crate) fn changed_since_hessian(&self) -> bool {
        self.num_unused != self.in_hessian
    }

    /// Whether a new Hessian can be assembled that stays valid.
    pub(crate) fn needs_hessian(&self) -> bool {
        self.frozen && self.changed_since_hessian()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(unused: &[bool]) -> Vec<Option<Box<[bool]>>> {
        vec![None, Some(unused.into())]
    }

    #[test]
    fn points_return_until_the_corrections_are_small() {
        let mut used = UsedPoints::default();
        used.update(points(&[true, false, true]), false);
        used.advance(3.0);
        assert_eq!(used.excluded(1), None);
        used.update(points(&[true, false, false]), false);
        used.advance(0.1);
        assert_eq!(used.excluded(1), Some(&[true, false, false][..]));
        assert_eq!(used.excluded(0), None);
    }

    #[test]
    fn a_hessian_is_needed_once_for_each_set_of_points() {
        let mut used = UsedPoints::default();
        used.update(points(&[true, false]), false);
        assert!(used.changed_since_hessian() && !used.needs_hessian());
        used.advance(0.1);
        assert!(used.needs_hessian());
        used.update(points(&[true, false]), true);
        assert!(!used.needs_hessian());
        used.update(points(&[true, true]), false);
        assert!(used.needs_hessian());
    }

    #[test]
    fn the_points_are_frozen_after_some_large_corrections() {
        let mut used = UsedPoints::default();
        used.update(points(&[true, false]), false);
        (0..FROZEN_AFTER).for_each(|_| used.advance(5.0));
        assert!(used.needs_hessian());
    }

    #[test]
    fn a_cell_needs_two_points_for_each_unknown_and_a_tenth_of_its_points() {
        assert!(is_too_few(15, 20, CellType::Quad, 2) && !is_too_few(16, 20, CellType::Quad, 2));
        assert!(is_too_few(39, 400, CellType::Triangle, 2) && !is_too_few(40, 400, CellType::Triangle, 2));
    }
}
