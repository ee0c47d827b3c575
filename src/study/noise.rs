//! Test of whether noise explains the difference of two pictures.
//!
//! Pixels come with the variance v of their mean, so that over any region z = Σ(a − b)/√(Σ(v_a + v_b) + r²) has mean 0
//! and variance 1 if both pictures show the same. r = ε Σ max(\|a\|, \|b\|), ε of f32: values are stored rounded, maybe
//! all of them the same way, which is all that is left where there is no noise.
//!
//! Single pixels are counted but not judged: their samples are few and heavy-tailed and their variances estimated from
//! the same samples, so that z is not normal. Sums over many pixels come close to normal. The picture is therefore cut
//! into blocks of [`BLOCK`]² pixels or more; z of every block and of the whole picture, in each colour, makes the N
//! tests. The probability that the largest of N normal \|z\| exceeds x is at most 1 − erf(x/√2)^N, dependent as the
//! tests are (Z. Šidák, J. Am. Stat. Assoc. 62, 626, 1967), and the pictures differ if that is below [`SIGNIFICANCE`].
//!
//! Assumed is that the noise is independent: of pixel from pixel, and of A from B, so that they must be rendered with
//! different seeds. Variances of `sobol` samples come from runs of them, which lie less well than all together do: they are
//! too high, by 1.2 to 1.5 in rooms and up to 3 in direct light. The test then misses small differences, but does not see
//! any that are not there. The reverse comes from light that a few
//! samples in a block find by chance: a picture in which none did has no variance there to excuse it.

use std::ops::Range;

use serde::Serialize;

use super::window::Window;
use crate::film::{Aov, Image};

/// Least side of a block, pixels, in pictures that are as large.
pub const BLOCK: usize = 16;
/// Share of equal pictures that are called different.
pub const SIGNIFICANCE: f64 = 0.01;
/// Colours and the variances of their means.
pub(super) const CHANNELS: [(&str, &str); 3] = {
    let variances = Aov::Variance.channels();
    [("R", variances[0]), ("G", variances[1]), ("B", variances[2])]
};

/// Differences in units of their standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Noise {
    /// Single pixels, not judged.
    pub pixels: Pixels,
    /// Number of blocks.
    pub blocks: usize,
    /// z of the mean of the picture in `R`, `G`, `B`; absent where nothing is known to vary.
    pub means: [Option<f64>; 3],
    /// Number of tests that were made.
    pub tests: usize,
    /// The test of largest \|z\|.
    pub largest: Option<Deviation>,
    /// Of a \|z\| as large as the largest, by chance.
    pub probability: f64,
    /// Values left out because they or their variances are not finite.
    pub non_finite: usize,
    /// Both pictures say that they were made with the same seed: the noise is then not independent.
    pub same_seed: bool,
}

/// Single pixels of all colours.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Pixels {
    /// Number that have a z; those without noise and difference have none.
    pub tested: usize,
    /// Number that have \|z\| > 2; 4.55 % of normal ones do.
    pub beyond_2: usize,
    /// Number that have \|z\| > 3; 0.27 % of normal ones do.
    pub beyond_3: usize,
    /// The one of largest \|z\|.
    pub largest: Option<Deviation>,
}

/// A difference and where it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// In standard deviations, positive where A is brighter.
    pub z: f64,
    /// `R`, `G` or `B`.
    pub channel: &'static str,
    /// Its pixels.
    pub window: Window,
}

impl Noise {
    /// True if chance is a good enough explanation.
    pub fn explains(&self) -> bool {
        self.probability >= SIGNIFICANCE
    }
}

/// Tests A against B, two pictures of the same pixels; `None` if one has no variances, or only one sample per pixel.
pub(super) fn test(a: &Image, b: &Image) -> Option<Noise> {
    let attribute = |image: &Image, name: &str| {
        image.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.clone())
    };
    if [a, b].iter().any(|image| matches!(attribute(image, "spp").as_deref(), Some("0" | "1"))) {
        return None;
    }
    let seed = attribute(a, "seed");
    let mut noise = Noise {
        pixels: Pixels::default(),
        blocks: 0,
        means: [None; 3],
        tests: 0,
        largest: None,
        probability: 1.0,
        non_finite: 0,
        same_seed: seed.is_some() && seed == attribute(b, "seed"),
    };
    let (columns, rows) = (cuts(a.size.0), cuts(a.size.1));
    noise.blocks = columns.len() * rows.len();
    for (color, (channel, variance)) in CHANNELS.into_iter().enumerate() {
        let values = [a.channel(channel)?, b.channel(channel)?, a.channel(variance)?, b.channel(variance)?];
        let at = |z: f64, x: &Range<usize>, y: &Range<usize>| Deviation {
            z,
            channel,
            window: Window { origin: (a.origin.0 + x.start, a.origin.1 + y.start), size: (x.len(), y.len()) },
        };
        let mut whole = RegionSums::default();
        for (x, y) in rows.iter().flat_map(|y| columns.iter().map(move |x| (x, y))) {
            let mut block = RegionSums::default();
            for (row, column) in y.clone().flat_map(|row| x.clone().map(move |column| (row, column))) {
                let Some(pixel) = RegionSums::of(values.map(|plane| plane[row * a.size.0 + column])) else {
                    noise.non_finite += 1;
                    continue;
                };
                block.add(pixel);
                if let Some(z) = pixel.z() {
                    noise.pixels.count(at(z, &(column..column + 1), &(row..row + 1)));
                }
            }
            whole.add(block);
            noise.count(block.z().map(|z| at(z, x, y)));
        }
        noise.means[color] = whole.z();
        noise.count(whole.z().map(|z| at(z, &(0..a.size.0), &(0..a.size.1))));
    }
    if let Some(largest) = &noise.largest {
        noise.probability = chance(largest.z.abs(), noise.tests);
    }
    Some(noise)
}

/// Cuts `length` pixels into pieces of [`BLOCK`] or a few more, one piece if there are fewer.
fn cuts(length: usize) -> Vec<Range<usize>> {
    let pieces = (length / BLOCK).max(1);
    (0..pieces).map(|i| i * length / pieces..(i + 1) * length / pieces).collect()
}

/// Bound on the probability that the largest of `tests` normal \|z\| is `z` or more.
fn chance(z: f64, tests: usize) -> f64 {
    let one = libm::erfc(z / std::f64::consts::SQRT_2);
    -libm::expm1(tests as f64 * libm::log1p(-one))
}

/// Keeps the deviation of larger \|z\|.
fn keep_larger(largest: &mut Option<Deviation>, found: Deviation) {
    if largest.as_ref().is_none_or(|largest| found.z.abs() > largest.z.abs()) {
        *largest = Some(found);
    }
}

impl Noise {
    fn count(&mut self, found: Option<Deviation>) {
        if let Some(found) = found {
            self.tests += 1;
            keep_larger(&mut self.largest, found);
        }
    }
}

impl Pixels {
    fn count(&mut self, found: Deviation) {
        self.tested += 1;
        self.beyond_2 += usize::from(found.z.abs() > 2.0);
        self.beyond_3 += usize::from(found.z.abs() > 3.0);
        keep_larger(&mut self.largest, found);
    }
}

/// Sums over the pixels of a region.
#[derive(Clone, Copy, Default)]
struct RegionSums {
    difference: f64,
    variance: f64,
    rounding: f64,
}

impl RegionSums {
    /// Of one pixel: its values in A and B and their variances, if all are finite.
    fn of(values: [f32; 4]) -> Option<Self> {
        let [a, b, variance_a, variance_b] = values.map(f64::from);
        values.iter().all(|value| value.is_finite()).then(|| Self {
            difference: a - b,
            variance: variance_a.max(0.0) + variance_b.max(0.0),
            rounding: f64::from(f32::EPSILON) * a.abs().max(b.abs()),
        })
    }

    fn add(&mut self, other: Self) {
        self.difference += other.difference;
        self.variance += other.variance;
        self.rounding += other.rounding;
    }

    fn z(self) -> Option<f64> {
        let deviation = (self.variance + self.rounding * self.rounding).sqrt();
        (deviation > 0.0).then(|| self.difference / deviation)
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::Xoshiro256PlusPlus;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::film::Channel;

    const SIZE: (usize, usize) = (80, 48);

    /// A picture of mean 1 with normal noise of variance `variance` in every colour.
    fn noisy(seed: u64, variance: f64) -> Image {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut normal = || {
            // Box and Muller.
            let (u, v): (f64, f64) = (rng.random(), rng.random());
            (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
        };
        let value = || (1.0 + variance.sqrt() * normal()) as f32;
        picture(value, variance as f32, &seed.to_string())
    }

    fn picture(mut value: impl FnMut() -> f32, variance: f32, seed: &str) -> Image {
        let count = SIZE.0 * SIZE.1;
        let mut plane =
            |name: &str| Channel { name: name.to_owned(), values: (0..count).map(|_| value()).collect() };
        let mut channels: Vec<Channel> = CHANNELS.iter().map(|(color, _)| plane(color)).collect();
        let variances =
            CHANNELS.map(|(_, name)| Channel { name: name.to_owned(), values: vec![variance; count] });
        channels.extend(variances);
        Image {
            width: 100,
            height: 100,
            origin: (10, 20),
            size: SIZE,
            channels,
            attributes: [("seed", seed), ("spp", "16")].map(|(k, v)| (k.to_owned(), v.to_owned())).to_vec(),
        }
    }

    /// Tests of 200 pairs of pictures that differ by noise only.
    fn equal_pairs() -> Vec<Noise> {
        (0..200).map(|i| test(&noisy(2 * i, 0.04), &noisy(2 * i + 1, 0.01)).unwrap()).collect()
    }

    #[test]
    fn the_chance_of_the_largest_deviation_is_that_of_tables() {
        assert!((chance(1.959_963_985, 1) - 0.05).abs() < 1e-9);
        assert!((chance(3.290_526_731, 10) - (1.0 - 0.999f64.powi(10))).abs() < 1e-9);
        // Far out, where 1 - (1 - p)^N would be 0: N times the tail.
        assert!((chance(10.0, 1000) / (1000.0 * 1.523_970_6e-23) - 1.0).abs() < 1e-6);
        assert_eq!(chance(0.0, 5), 1.0);
    }

    #[test]
    fn blocks_cover_the_picture_and_none_is_small() {
        for length in [1, 5, 15, 16, 31, 32, 33, 641] {
            let cuts = cuts(length);
            assert!(cuts[0].start == 0 && cuts.last().unwrap().end == length);
            assert!(cuts.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert!(cuts.iter().all(|cut| cut.len() >= BLOCK.min(length) && cut.len() < 2 * BLOCK));
        }
    }

    #[test]
    fn normal_noise_gives_uniform_probabilities_and_normal_shares() {
        let mut found = equal_pairs();
        found.sort_by(|a, b| a.probability.total_cmp(&b.probability));
        // Kolmogorov and Smirnov: 1.63/sqrt(200) is exceeded in 1 % of the cases.
        let distance = found.iter().enumerate().map(|(i, noise)| {
            let (low, high) = (i as f64 / 200.0, (i + 1) as f64 / 200.0);
            (noise.probability - low).abs().max((high - noise.probability).abs())
        });
        let distance = distance.fold(0.0, f64::max);
        assert!(distance < 1.63 / 200f64.sqrt(), "{distance}");
        let share = |count: fn(&Pixels) -> usize| {
            let (counted, tested) = found
                .iter()
                .fold((0, 0), |(c, t), noise| (c + count(&noise.pixels), t + noise.pixels.tested));
            counted as f64 / tested as f64
        };
        assert!((share(|pixels| pixels.beyond_2) - 0.0455).abs() < 5e-4);
        assert!((share(|pixels| pixels.beyond_3) - 0.0027).abs() < 1.5e-4);
    }

    #[test]
    fn equal_pictures_are_called_different_no_more_often_than_promised() {
        let alarms = equal_pairs().iter().filter(|noise| !noise.explains()).count();
        // Two of 200 are expected; eight or more have a probability of 0.1 %.
        assert!(alarms < 8, "{alarms}");
    }

    #[test]
    fn few_samples_of_heavy_tails_do_not_cry_wolf() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
        let mut render = |spp: u32| {
            let mut image = picture(|| 0.0, 0.0, "");
            for pixel in 0..SIZE.0 * SIZE.1 {
                // Every tenth sample finds a lamp of an exponentially distributed brightness.
                let mut sample = || {
                    let (hit, u): (f64, f64) = (rng.random(), rng.random());
                    if hit < 0.1 { -10.0 * (1.0 - u).ln() } else { 0.0 }
                };
                let samples: Vec<f64> = (0..spp).map(|_| sample()).collect();
                let n = f64::from(spp);
                let mean = samples.iter().sum::<f64>() / n;
                let spread = samples.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (n - 1.0);
                for channel in 0..3 {
                    image.channels[channel].values[pixel] = mean as f32;
                    image.channels[channel + 3].values[pixel] = (spread / n) as f32;
                }
            }
            image
        };
        for (spp_a, spp_b) in [(4, 4), (4, 64)] {
            let alarms =
                (0..50).filter(|_| !test(&render(spp_a), &render(spp_b)).unwrap().explains()).count();
            println!("{spp_a} against {spp_b} samples: {alarms} of 50");
            assert!(alarms < 5, "{spp_a} against {spp_b} samples: {alarms} of 50");
        }
    }

    #[test]
    fn a_small_shift_of_the_whole_picture_is_seen_in_its_mean() {
        let (a, mut b) = (noisy(1, 0.04), noisy(2, 0.04));
        b.channels[1].values.iter_mut().for_each(|value| *value += 0.03);
        let noise = test(&a, &b).unwrap();
        let largest = noise.largest.clone().unwrap();
        assert!(!noise.explains() && largest.z < 0.0, "{noise:?}");
        assert_eq!((largest.channel, largest.window.size), ("G", SIZE));
    }

    #[test]
    fn a_shift_of_one_block_is_seen_where_it_is() {
        let (a, mut b) = (noisy(1, 0.04), noisy(2, 0.04));
        for y in 32..48 {
            b.channels[2].values[y * SIZE.0 + 16..y * SIZE.0 + 32].iter_mut().for_each(|value| *value -= 0.2);
        }
        let noise = test(&a, &b).unwrap();
        let largest = noise.largest.clone().unwrap();
        assert!(!noise.explains() && largest.z > 0.0 && noise.blocks == 15);
        assert_eq!(largest.window, Window { origin: (26, 52), size: (16, 16) });
    }

    #[test]
    fn without_noise_a_difference_beyond_rounding_is_seen_and_rounding_is_not() {
        let flat = |value: f32| picture(|| value, 0.0, "");
        let ulp = f32::from_bits(0.3f32.to_bits() + 1);
        assert!(test(&flat(0.3), &flat(ulp)).unwrap().explains());
        assert!(!test(&flat(0.3), &flat(0.300_01)).unwrap().explains());
        let black = test(&flat(0.0), &flat(0.0)).unwrap();
        assert!(black.explains() && black.tests == 0 && black.pixels.tested == 0);
    }

    #[test]
    fn values_that_are_not_finite_are_left_out() {
        let (mut a, b) = (noisy(1, 0.04), noisy(2, 0.04));
        a.channels[0].values[5] = f32::NAN;
        a.channels[4].values[6] = f32::INFINITY;
        let noise = test(&a, &b).unwrap();
        assert!(noise.non_finite == 2 && noise.explains());
        assert_eq!(noise.pixels.tested, 3 * SIZE.0 * SIZE.1 - 2);
    }

    #[test]
    fn a_single_sample_has_no_variance_and_a_shared_seed_is_told() {
        let (mut a, b) = (noisy(1, 0.04), noisy(1, 0.04));
        assert!(test(&a, &b).unwrap().same_seed);
        a.attributes[1].1 = "1".to_owned();
        assert!(test(&a, &b).is_none());
        a.attributes.clear();
        assert!(!test(&a, &b).unwrap().same_seed);
    }
}
