//! Random numbers as functions of a counter: any thread computes any of them, always the same.

/// Increment of SplitMix64.
pub(crate) const INCREMENT: u64 = 0x9e37_79b9_7f4a_7c15;

/// The finaliser of SplitMix64.
pub(crate) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Number `index` of a sequence of independent standard normal deviates (Box-Muller).
pub(crate) fn normal(seed: u64, index: u64) -> f64 {
    let first = mix(mix(seed.wrapping_add(INCREMENT)) ^ index);
    let second = mix(first.wrapping_add(INCREMENT));
    // 53 random bits; the first number lies in (0, 1], so that its logarithm is finite.
    let unit = |bits: u64| (bits >> 11) as f64 / (1_u64 << 53) as f64;
    (-2.0 * (1.0 - unit(first)).ln()).sqrt() * (std::f64::consts::TAU * unit(second)).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_deviates_have_the_moments_of_the_normal_distribution() {
        let count = 200_000;
        let deviates: Vec<f64> = (0..count).map(|index| normal(5, index)).collect();
        let moment = |power: i32| deviates.iter().map(|x| x.powi(power)).sum::<f64>() / count as f64;
        // Four standard errors: sqrt(variance of the power / count).
        for (power, expected, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)] {
            let error = 4.0 * f64::sqrt(variance / count as f64);
            assert!((moment(power) - expected).abs() < error, "moment {power}: {}", moment(power));
        }
        let lagged = deviates.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / count as f64;
        assert!(lagged.abs() < 4.0 / (count as f64).sqrt(), "correlation of neighbours: {lagged}");
    }

    #[test]
    fn seeds_give_different_sequences() {
        assert_eq!(normal(1, 7), normal(1, 7));
        assert_ne!(normal(1, 7), normal(2, 7));
        assert_ne!(normal(1, 7), normal(1, 8));
    }
}
