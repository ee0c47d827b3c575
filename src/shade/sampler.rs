//! Random numbers keyed by (seed, pixel, sample, set): no state, so that no order of work can change them.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

use super::sobol::{SEQUENCE, SETS, Sobol};
use crate::math::kernel::widest;

/// Vertices whose numbers are made side by side.
const LANES: usize = 16;

/// Source of random numbers for all paths of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    seed: u64,
    independent: bool,
}

/// Key of random numbers: what they are for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Pixel, counted over the whole image row by row.
    pub pixel: u32,
    /// Sample of that pixel.
    pub sample: u32,
    /// Index of a set of four numbers of the sample.
    pub set: u32,
}

impl Sampler {
    /// Owen-scrambled Sobol' points, four dimensions at a time, decorrelated between pixels.
    pub fn sobol(seed: u64) -> Self {
        Self { seed, independent: false }
    }

    /// Independent uniform numbers.
    pub fn independent(seed: u64) -> Self {
        Self { seed, independent: true }
    }

    /// Four numbers in [0, 1) for `key`.
    #[inline]
    pub fn four(&self, key: Key) -> [f32; 4] {
        let [four] = self.lanes([key.pixel], [key.sample], [key.set]);
        four
    }

    /// Four numbers in [0, 1) for each of `keys`.
    pub fn four_all(&self, keys: &[Key], numbers: &mut Vec<[f32; 4]>) {
        numbers.resize(keys.len(), [0.0; 4]);
        widest(All { sampler: self, keys, numbers });
    }

    /// Four numbers in [0, 1) for each of some lanes.
    #[inline(always)]
    fn lanes<const N: usize>(&self, pixel: [u32; N], sample: [u32; N], set: [u32; N]) -> [[f32; 4]; N] {
        if self.independent {
            return std::array::from_fn(|lane| {
                let key = mix(self.seed, (u64::from(pixel[lane]) << 32) | u64::from(sample[lane]));
                Xoshiro256PlusPlus::seed_from_u64(mix(key, u64::from(set[lane]))).random()
            });
        }
        let mut seed = [0; N];
        for lane in 0..N {
            // Past the limits of a sequence a fresh scramble takes over; within them all sets belong to one sequence.
            let block = (u64::from(sample[lane] / SEQUENCE) << 32) | u64::from(set[lane] / SETS);
            seed[lane] = mix(mix(self.seed, u64::from(pixel[lane])), block) as u32;
        }
        Sobol::new().four(sample.map(|sample| sample % SEQUENCE), set.map(|set| set % SETS), seed)
    }
}

struct All<'a> {
    sampler: &'a Sampler,
    keys: &'a [Key],
    numbers: &'a mut [[f32; 4]],
}

impl pulp::NullaryFnOnce for All<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { sampler, keys, numbers } = self;
        for (keys, numbers) in keys.chunks(LANES).zip(numbers.chunks_mut(LANES)) {
            let (mut pixel, mut sample, mut set) = ([0; LANES], [0; LANES], [0; LANES]);
            for (lane, key) in keys.iter().enumerate() {
                (pixel[lane], sample[lane], set[lane]) = (key.pixel, key.sample, key.set);
            }
            let four = sampler.lanes(pixel, sample, set);
            numbers.copy_from_slice(&four[..numbers.len()]);
        }
    }
}

/// A well-mixed function of two words: two rounds of SplitMix64's finaliser (Steele, Lea, Flood 2014).
#[inline(always)]
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
                    for (d, u) in sampler.four(Key { pixel: 7, sample: i, set }).into_iter().enumerate() {
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
    fn numbers_of_many_keys_are_those_of_each() {
        let key = |i: u32| Key { pixel: i * i, sample: i << 12, set: i * 3 };
        let keys: Vec<Key> = (0..100).map(key).collect();
        for sampler in [Sampler::sobol(3), Sampler::independent(3)] {
            let mut numbers = Vec::new();
            sampler.four_all(&keys, &mut numbers);
            assert_eq!(numbers, keys.iter().map(|&key| sampler.four(key)).collect::<Vec<_>>());
        }
    }

    #[test]
    fn pixels_samples_sets_and_seeds_are_told_apart() {
        let four = |seed: u64, pixel: u32, sample: u32, set: u32| {
            Sampler::sobol(seed).four(Key { pixel, sample, set })
        };
        let base = four(1, 5, 9, 2);
        assert_eq!(base, four(1, 5, 9, 2));
        for other in [
            four(2, 5, 9, 2),
            four(1, 6, 9, 2),
            four(1, 5, 10, 2),
            four(1, 5, 9, 3),
            four(1, 5, 9 + SEQUENCE, 2),
        ] {
            assert_ne!(base, other);
        }
    }
}
