//! Whole-sample symmetric continuation: `d c b | a b c d | c b a`.

/// Index of the sample, among `size >= 2` samples, that the continuation has at position `index`, inside or outside.
pub(crate) fn mirror(index: isize, size: usize) -> usize {
    let period = 2 * size - 2;
    let folded = index.rem_euclid(period as isize) as usize;
    folded.min(period - folded)
}

/// Fills the first and last `margin` entries of `line` by continuation of the samples between them.
pub(crate) fn mirror_ends(line: &mut [f32], margin: usize) {
    let size = line.len() - 2 * margin;
    for distance in 1..=margin {
        line[margin - distance] = line[margin + mirror(-(distance as isize), size)];
        line[margin + size - 1 + distance] = line[margin + mirror((size - 1 + distance) as isize, size)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_reflected_at_both_ends() {
        let folded: Vec<usize> = (-7..10).map(|index| mirror(index, 4)).collect();
        assert_eq!(folded, [1, 0, 1, 2, 3, 2, 1, 0, 1, 2, 3, 2, 1, 0, 1, 2, 3]);
    }

    #[test]
    fn margins_may_be_longer_than_one_reflection() {
        let mut line = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0];
        mirror_ends(&mut line, 3);
        assert_eq!(line, [2.0, 3.0, 2.0, 1.0, 2.0, 3.0, 2.0, 1.0, 2.0]);
    }
}
