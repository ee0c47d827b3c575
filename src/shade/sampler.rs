//! Random numbers keyed by (seed, pixel, sample, set): no state, so that no order of work can change them.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

/// Source of random numbers for all paths of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    seed: u64,
    independent: bool,
}

/// Points of one Sobol' sequence, the library's limit.
const SEQUENCE: u32 = 1 << 16;
/// Sets of four dimensions of one sequence, the library's limit.
const SETS: u32 = 64;

impl Sampler {
    /// Owen-scrambled Sobol' points, four dimensions at a time, decorrelated between pixels.
    pub fn sobol(seed: u64) -> Self {
        Self { seed, independent: false }
    }

    /// Independent uniform numbers.
    pub fn independent(seed: u64) -> Self {
        Self { seed, independent: true }
    }

    /// Four numbers in [0, 1) for `set` (0: the camera; n: the n-th vertex) of `sample` in `pixel`.
    #[inline]
    pub fn four(&self, pixel: u32, sample: u32, set: u32) -> [f32; 4] {
        if self.independent {
            let key = mix(self.seed, (u64::from(pixel) << 32) | u64::from(sample));
            let mut generator = Xoshiro256PlusPlus::seed_from_u64(mix(key, u64::from(set)));
            return generator.random();
        }
        // Past the library's limits a fresh scramble takes over; within them all sets belong to one sequence.
        let block = (u64::from(sample / SEQUENCE) << 32) | u64::from(set / SETS);
        let seed = mix(mix(self.seed, u64::from(pixel)), block) as u32;
        sobol_burley::sample_4d(sample % SEQUENCE, set % SETS, seed)
    }
}

/// A well-mixed function of two words: two rounds of SplitMix64's finaliser (Steele, Lea, Flood 2014).
fn mix(a: u64, b: u64) -> u64 {
    let finalise = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    finalise(finalise(a.wrapping_add(0x9e37_79b9_7f4a_7c15)) ^ b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_samplers_are_uniform_in_mean_and_variance_in_every_dimension() {
        for sampler in [Sampler::sobol(3), Sampler::independent(3)] {
            for set in [0, 1, 63, 64, 200] {
                let (mut sum, mut square) = ([0.0f64; 4], [0.0f64; 4]);
                const N: u32 = 4096;
                for i in 0..N {
                    for (d, u) in sampler.four(7, i, set).into_iter().enumerate() {
                        assert!((0.0..1.0).contains(&u));
                        sum[d] += f64::from(u);
                        square[d] += f64::from(u).powi(2);
                    }
                }
                for d in 0..4 {
                    let mean = sum[d] / f64::from(N);
                    let variance = square[d] / f64::from(N) - mean * mean;
                    assert!((mean - 0.5).abs() < 0.02, "{sampler:?} set {set} dimension {d}: mean {mean}");
                    assert!((variance - 1.0 / 12.0).abs() < 0.005, "{sampler:?} set {set}: {variance}");
                }
            }
        }
    }

    #[test]
    fn pixels_samples_sets_and_seeds_are_told_apart() {
        let base = Sampler::sobol(1).four(5, 9, 2);
        assert_eq!(base, Sampler::sobol(1).four(5, 9, 2));
        for other in [
            Sampler::sobol(2).four(5, 9, 2),
            Sampler::sobol(1).four(6, 9, 2),
            Sampler::sobol(1).four(5, 10, 2),
            Sampler::sobol(1).four(5, 9, 3),
            Sampler::sobol(1).four(5, 9 + SEQUENCE, 2),
        ] {
            assert_ne!(base, other);
        }
    }
}
