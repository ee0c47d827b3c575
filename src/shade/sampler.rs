//! Random numbers keyed by (seed, pixel, sample, set): no state, so that no order of work can change them.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

use sobol_burley::parts::u32_to_f32_norm;

use super::sobol::pairs;
use crate::math::kernel::widest;

/// Vertices whose numbers are made side by side.
const LANES: usize = 16;

/// Source of random numbers for all paths of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    /// Mixed.
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
    /// Index of a set of numbers of the sample, below 2^31.
    pub set: u32,
}

impl Sampler {
    /// Owen-scrambled Sobol' points, two dimensions at a time, decorrelated between pixels and sets.
    pub fn sobol(seed: u64) -> Self {
        Self { seed: finalise(seed.wrapping_add(GOLDEN)), independent: false }
    }

    /// Independent uniform numbers.
    pub fn independent(seed: u64) -> Self {
        Self { seed: finalise(seed.wrapping_add(GOLDEN)), independent: true }
    }

    /// Numbers in [0, 1) for `key`.
    #[inline]
    pub fn point<P: SamplePoint>(&self, key: Key) -> P {
        let [point] = P::draw(self, [key]);
        point
    }

    /// Numbers in [0, 1) for each of `keys`.
    pub fn points<P: SamplePoint>(&self, keys: &[Key], points: &mut Vec<P>) {
        points.resize(keys.len(), P::default());
        widest(All { sampler: self, keys, points });
    }

    /// For each of some keys, the sequence `number`, 0 or 1, of its set.
    #[inline(always)]
    fn sequences<const N: usize>(&self, keys: [Key; N], number: u32) -> [u64; N] {
        let mut sequences = [0; N];
        for lane in 0..N {
            let Key { pixel, set, .. } = keys[lane];
            sequences[lane] = finalise(self.seed ^ (u64::from(pixel) << 32 | u64::from(set << 1 | number)));
        }
        sequences
    }

    fn generator(&self, Key { pixel, sample, set }: Key) -> Xoshiro256PlusPlus {
        let key = finalise(self.seed ^ (u64::from(pixel) << 32 | u64::from(sample)));
        Xoshiro256PlusPlus::seed_from_u64(finalise(key ^ u64::from(set)))
    }
}

/// Numbers that are drawn together for one key.
pub trait SamplePoint: Copy + Default {
    /// Those for each of some keys.
    fn draw<const N: usize>(sampler: &Sampler, keys: [Key; N]) -> [Self; N];
}

/// Two pairs, each spread evenly over the square.
impl SamplePoint for [f32; 4] {
    #[inline(always)]
    fn draw<const N: usize>(sampler: &Sampler, keys: [Key; N]) -> [Self; N] {
        if sampler.independent {
            return keys.map(|key| sampler.generator(key).random());
        }
        let index = keys.map(|key| key.sample);
        let first = pairs(index, sampler.sequences(keys, 0));
        let second = pairs(index, sampler.sequences(keys, 1));
        let mut points = [[0.0; 4]; N];
        for lane in 0..N {
            let ([x, y], [z, w]) = (first[lane], second[lane]);
            points[lane] = [x, y, z, w].map(u32_to_f32_norm);
        }
        points
    }
}

/// A pair spread evenly over the square, with digits enough for choices by parts of it.
impl SamplePoint for [f64; 2] {
    #[inline(always)]
    fn draw<const N: usize>(sampler: &Sampler, keys: [Key; N]) -> [Self; N] {
        if sampler.independent {
            return keys.map(|key| sampler.generator(key).random());
        }
        let (index, sequences) = (keys.map(|key| key.sample), sampler.sequences(keys, 0));
        let pairs = pairs(index, sequences);
        let mut points = [[0.0; 2]; N];
        for lane in 0..N {
            // So far down, scrambled digits are random: those of SplitMix64 from the sequence on.
            let more = finalise(sequences[lane].wrapping_add(u64::from(index[lane]).wrapping_mul(GOLDEN)));
            let [x, y] = pairs[lane];
            points[lane] = [(x, more as u32), (y, (more >> 32) as u32)].map(|(digits, more)| {
                let digits = u64::from(digits) << 20 | u64::from(more >> 12);
                f64::from_bits(1f64.to_bits() | digits) - 1.0
            });
        }
        points
    }
}

struct All<'a, P> {
    sampler: &'a Sampler,
    keys: &'a [Key],
    points: &'a mut [P],
}

impl<P: SamplePoint> pulp::NullaryFnOnce for All<'_, P> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { sampler, keys, points } = self;
        for (keys, points) in keys.chunks(LANES).zip(points.chunks_mut(LANES)) {
            let mut lanes = [Key { pixel: 0, sample: 0, set: 0 }; LANES];
            lanes[..keys.len()].copy_from_slice(keys);
            points.copy_from_slice(&P::draw(sampler, lanes)[..points.len()]);
        }
    }
}

/// Step of SplitMix64: 2^64 over the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's finaliser, which mixes all bits of a word (Steele, Lea, Flood 2014).
#[inline(always)]
fn finalise(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLERS: [fn(u64) -> Sampler; 2] = [Sampler::sobol, Sampler::independent];

    #[test]
    fn both_samplers_are_uniform_in_mean_and_variance_in_every_dimension() {
        for sampler in SAMPLERS.map(|sampler| sampler(3)) {
            for set in [0, 1, 63, 64, 200] {
                let (mut sum, mut square) = ([0.0f64; 6], [0.0f64; 6]);
                const N: u32 = 4096;
                for sample in 0..N {
                    let key = Key { pixel: 7, sample, set };
                    let ([a, b, c, d], [e, f]) =
                        (sampler.point::<[f32; 4]>(key).map(f64::from), sampler.point::<[f64; 2]>(key));
                    for (dimension, u) in [a, b, c, d, e, f].into_iter().enumerate() {
                        assert!((0.0..1.0).contains(&u));
                        sum[dimension] += u;
                        square[dimension] += u * u;
                    }
                }
                for d in 0..6 {
                    let mean = sum[d] / f64::from(N);
                    let variance = square[d] / f64::from(N) - mean * mean;
                    assert!((mean - 0.5).abs() < 0.02, "{sampler:?} set {set} dimension {d}: mean {mean}");
                    assert!((variance - 1.0 / 12.0).abs() < 0.005, "{sampler:?} set {set}: {variance}");
                }
            }
        }
    }

    #[test]
    fn points_of_many_keys_are_those_of_each() {
        fn check<P: SamplePoint + PartialEq + std::fmt::Debug>(sampler: Sampler, keys: &[Key]) {
            let mut points: Vec<P> = Vec::new();
            sampler.points(keys, &mut points);
            assert_eq!(points, keys.iter().map(|&key| sampler.point::<P>(key)).collect::<Vec<_>>());
        }
        let key = |i: u32| Key { pixel: i * i, sample: i << 12, set: i * 3 };
        let keys: Vec<Key> = (0..100).map(key).collect();
        for sampler in SAMPLERS.map(|sampler| sampler(3)) {
            check::<[f32; 4]>(sampler, &keys);
            check::<[f64; 2]>(sampler, &keys);
        }
    }

    #[test]
    fn pixels_samples_sets_and_seeds_are_told_apart() {
        let point = |seed: u64, pixel: u32, sample: u32, set: u32| {
            Sampler::sobol(seed).point::<[f32; 4]>(Key { pixel, sample, set })
        };
        let base = point(1, 5, 9, 2);
        assert_eq!(base, point(1, 5, 9, 2));
        for other in [
            point(2, 5, 9, 2),
            point(1, 6, 9, 2),
            point(1, 5, 10, 2),
            point(1, 5, 9, 3),
            point(1, 5, 1 << 30, 2),
        ] {
            assert_ne!(base, other);
        }
    }

    #[test]
    fn pairs_beside_each_other_are_independent() {
        // Of 16 points, each pair has one in each of 16 squares; which of one pair goes with which of the other is
        // as good as random: for each of 256 cells of four dimensions the count is 1 in the mean over pixels.
        let sampler = Sampler::sobol(5);
        let mut counts = [0.0f64; 256];
        const PIXELS: u32 = 4096;
        for pixel in 0..PIXELS {
            for sample in 0..16 {
                let key = |set| Key { pixel, sample, set };
                let [a, b] = sampler.point::<[f64; 2]>(key(3)).map(|u| (4.0 * u) as usize);
                let [c, d] = sampler.point::<[f64; 2]>(key(4)).map(|u| (4.0 * u) as usize);
                counts[64 * a + 16 * b + 4 * c + d] += 1.0;
            }
        }
        let expected = f64::from(PIXELS) / 16.0;
        let chi_square: f64 = counts.iter().map(|count| (count - expected).powi(2) / expected).sum();
        // 225 degrees of freedom: the mean is about that, the deviation 21.
        assert!((chi_square - 225.0).abs() < 85.0, "{chi_square}");
    }
}
