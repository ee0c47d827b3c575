//! Errors of directions and of many rays.

use glam::DVec3;

/// Size of many errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Root of the mean square.
    pub rmse: f64,
    /// Median.
    pub median: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest.
    pub max: f64,
}

/// A value of a spread, and its name.
pub type Part = (&'static str, fn(&Spread) -> f64);

impl Spread {
    pub(super) const RMSE: Part = ("rmse", |spread| spread.rmse);
    pub(super) const MEDIAN: Part = ("median", |spread| spread.median);
    pub(super) const P99: Part = ("p99", |spread| spread.p99);
    pub(super) const MAX: Part = ("max", |spread| spread.max);

    /// The spread of `values`; `None` if there are none.
    pub(super) fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let count = values.len();
        let rmse = (values.iter().map(|value| value * value).sum::<f64>() / count as f64).sqrt();
        let at = |index: usize| values.get(index).copied();
        Some(Self { rmse, median: at(count / 2)?, p99: at(count * 99 / 100)?, max: *values.last()? })
    }
}

/// Median of `value` over `samples`, the upper one of two in the middle; NaN if there are none.
pub(super) fn median<T>(samples: &[T], value: impl Fn(&T) -> f64) -> f64 {
    Spread::of(samples.iter().map(value).collect()).map_or(f64::NAN, |spread| spread.median)
}

/// Angle between unit vectors, also where it is too small for its cosine.
pub(super) fn angle(a: DVec3, b: DVec3) -> f64 {
    2.0 * libm::asin((0.5 * a.distance(b)).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_are_those_of_textbooks() {
        let spread = Spread::of((0..=200).rev().map(f64::from).collect()).unwrap();
        assert_eq!((spread.median, spread.p99, spread.max), (100.0, 198.0, 200.0));
        assert_eq!(Spread::of(vec![3.0, 4.0]).unwrap().rmse, 12.5f64.sqrt());
        assert_eq!(Spread::of(Vec::new()), None);
    }

    #[test]
    fn small_angles_keep_their_digits() {
        let tilted = DVec3::new(1e-10, 0.0, 1.0).normalize();
        assert!((angle(DVec3::Z, tilted) - 1e-10).abs() < 1e-20);
    }
}
