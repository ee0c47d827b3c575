//! Pearson's χ² test: counts of samples in cells, against what a density says.

use std::f64::consts::{PI, SQRT_2, TAU};

use glam::DVec3;
use warpfront::math::frame::tangents;

/// Least expected count of a cell; cells below are taken together.
const FEWEST: f64 = 5.0;

/// The probability of a χ² at least as large as that of `counts`, if each is expected as often as `expected` says.
pub fn probability(counts: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(counts.len(), expected.len());
    let mut cells: Vec<(f64, f64)> = counts.iter().copied().zip(expected.iter().copied()).collect();
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut pooled: Vec<(f64, f64)> = Vec::new();
    for (count, expected) in cells {
        match pooled.last_mut() {
            Some(last) if last.1 < FEWEST => *last = (last.0 + count, last.1 + expected),
            _ => pooled.push((count, expected)),
        }
    }
    if pooled.len() < 2 {
        return 1.0;
    }
    let square = |(count, expected): &(f64, f64)| (count - expected).powi(2) / expected.max(1e-9);
    let chi2: f64 = pooled.iter().map(square).sum();
    upper_tail(chi2, pooled.len() as f64 - 1.0)
}

/// The probability of a χ² of `freedom` degrees of at least `chi2` [Wilson, Hilferty 1931]; its relative error is some
/// percent, and at one degree of freedom a factor of two.
fn upper_tail(chi2: f64, freedom: f64) -> f64 {
    let variance = 2.0 / (9.0 * freedom);
    let z = (libm::cbrt(chi2 / freedom) - (1.0 - variance)) / variance.sqrt();
    0.5 * libm::erfc(z / SQRT_2)
}

/// A space of samples, cut into cells of equal measure: a square onto which it is mapped so that areas stay in
/// proportion.
pub struct Space<'a, T> {
    /// A sample's place in the unit square.
    pub place: &'a dyn Fn(T) -> [f64; 2],
    /// The sample at a place.
    pub at: &'a dyn Fn([f64; 2]) -> T,
    /// Measure of all of it, in which densities are given.
    pub measure: f64,
}

/// Cells along either side of the square.
pub const CELLS: usize = 16;
/// Places along either side of a cell at which the density is looked at.
pub const FINE: usize = 48;

impl<T> Space<'_, T> {
    /// The probability of the places of `samples`, some of which are none, under `density`: it integrates to the share
    /// of those that are some.
    pub fn probability(
        &self,
        samples: impl IntoIterator<Item = Option<T>>,
        density: impl Fn(T) -> f64,
    ) -> f64 {
        let (mut counts, mut total) = (vec![0.0; CELLS * CELLS + 1], 0.0);
        for sample in samples {
            total += 1.0;
            let cell = sample.map_or(CELLS * CELLS, |sample| {
                let [u, v] = (self.place)(sample).map(|x| ((x * CELLS as f64) as usize).min(CELLS - 1));
                v * CELLS + u
            });
            counts[cell] += 1.0;
        }
        let side = CELLS * FINE;
        let mut expected = vec![0.0; CELLS * CELLS + 1];
        for fine in 0..side * side {
            let (x, y) = (fine % side, fine / side);
            let place = [x, y].map(|i| (i as f64 + 0.5) / side as f64);
            let share = density((self.at)(place)) * self.measure / (side * side) as f64;
            expected[y / FINE * CELLS + x / FINE] += share * total;
        }
        expected[CELLS * CELLS] = (total - expected.iter().sum::<f64>()).max(0.0);
        probability(&counts, &expected)
    }
}

/// Unit vectors as a square: around an axis, by how far from it and by the azimuth.
#[derive(Clone, Copy, Debug)]
pub struct Directions {
    /// Unit vector.
    pub axis: DVec3,
    /// Half of 1 − cos of the angle around the axis beyond which cells become larger in proportion; far above 1 all
    /// cells are alike.
    pub near: f64,
    /// Half of 1 − cos of the largest angle around the axis: 1 for all directions.
    pub reach: f64,
}

impl Directions {
    /// All alike.
    pub fn even(axis: DVec3) -> Self {
        Self { axis, near: 1e6, reach: 1.0 }
    }

    /// The place of a unit vector.
    pub fn place(&self, direction: DVec3) -> [f64; 2] {
        let (t, s) = tangents(self.axis);
        let azimuth = libm::atan2(direction.dot(s), direction.dot(t)) / TAU;
        let below = 0.25 * direction.distance_squared(self.axis);
        [libm::log1p(below / self.near) / self.decades(), azimuth.rem_euclid(1.0)]
    }

    /// The unit vector at a place, and the factor by which more solid angle is at it than elsewhere on average.
    pub fn at(&self, [u, azimuth]: [f64; 2]) -> (DVec3, f64) {
        let (t, s) = tangents(self.axis);
        let below = self.near * libm::expm1(u * self.decades());
        let sin = 2.0 * (below * (1.0 - below)).sqrt();
        let (sin_azimuth, cos_azimuth) = libm::sincos(TAU * azimuth);
        let direction = sin * (cos_azimuth * t + sin_azimuth * s) + (1.0 - 2.0 * below) * self.axis;
        (direction, (below + self.near) * self.decades() / self.reach)
    }

    fn decades(&self) -> f64 {
        libm::log1p(self.reach / self.near)
    }

    /// The probability of unit vectors under a density in solid angle.
    pub fn probability(
        &self,
        samples: impl IntoIterator<Item = Option<DVec3>>,
        density: impl Fn(DVec3) -> f64,
    ) -> f64 {
        let space = Space {
            place: &|(d, _)| self.place(d),
            at: &|place| self.at(place),
            measure: 4.0 * PI * self.reach,
        };
        let samples = samples.into_iter().map(|sample| sample.map(|direction| (direction, 1.0)));
        space.probability(samples, |(direction, stretch)| density(direction) * stretch)
    }
}

/// Probabilities of many tests: Šidák's correction for the least of them.
#[derive(Default)]
pub struct Verdict {
    least: Option<(f64, String)>,
    count: f64,
}

impl Verdict {
    /// One test more.
    pub fn add(&mut self, what: impl Into<String>, probability: f64) {
        self.count += 1.0;
        // Not a number is the worst of all.
        if self.least.as_ref().is_none_or(|(least, _)| probability.is_nan() || probability < *least) {
            self.least = Some((probability, what.into()));
        }
    }

    /// The probability that the least of so many is as small as it is.
    pub fn corrected(&self) -> f64 {
        let least = self.least.as_ref().expect("a test").0;
        -libm::expm1(self.count * libm::log1p(-least))
    }

    /// Complains about what chance does not explain.
    pub fn check(&self) {
        let (least, what) = self.least.as_ref().expect("a test");
        println!("{} tests, least probability {least:.2e}: {what}", self.count);
        assert!(self.corrected() > 1e-3, "{what}: probability {least:e} in {} tests", self.count);
    }
}
