//! Means of a few measurements and what they are worth.

use serde::Serialize;

/// A value and its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error; `None` from a single measurement.
    pub error: Option<f64>,
}

impl Estimate {
    /// The mean of `values`.
    pub fn mean(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|v| (v - value).powi(2)).sum();
        Self { value, error: (n > 1.0).then(|| (squares / (n - 1.0) / n).sqrt()) }
    }

    /// The mean of the middle half of `values`, which are not far from normal but for outliers: what a busy machine
    /// does to times.
    pub fn middle(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (low, n) = (sorted.len() / 4, sorted.len() as f64);
        let half = &sorted[low..sorted.len() - low];
        let value = half.iter().sum::<f64>() / half.len() as f64;
        // Of n normal numbers of deviation 1, the quartiles are 1.349 apart, and this mean deviates by 1.09/√n.
        let spread = half.last().zip(half.first()).map(|(last, first)| (last - first) / 1.349);
        Self { value, error: spread.filter(|_| n > 1.0).map(|spread| 1.09 * spread / n.sqrt()) }
    }

    /// The ratio of two values that know nothing of each other.
    pub fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        let relative = |e: Self| e.error.map(|error| error / e.value);
        let error = relative(self).zip(relative(other)).map(|(a, b)| value * libm::hypot(a, b));
        Self { value, error }
    }

    /// The geometric mean of `values`; `None` unless all are finite and above 0.
    pub fn geometric_mean(values: &[f64]) -> Option<Self> {
        are_positive(values).then(|| {
            let logarithms: Vec<f64> = values.iter().map(|&v| libm::log(v)).collect();
            let mean = Self::mean(&logarithms);
            let value = libm::exp(mean.value);
            Self { value, error: mean.error.map(|error| value * error) }
        })
    }
}

/// The median of `values`, between the two in the middle their geometric mean; `None` unless all are finite and above
/// 0.
pub fn geometric_median(mut values: Vec<f64>) -> Option<f64> {
    if !are_positive(&values) {
        return None;
    }
    values.sort_by(f64::total_cmp);
    Some((values[(values.len() - 1) / 2] * values[values.len() / 2]).sqrt())
}

fn are_positive(values: &[f64]) -> bool {
    !values.is_empty() && values.iter().all(|value| value.is_finite() && *value > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_their_errors_are_those_of_textbooks() {
        assert_eq!(
            Estimate::mean(&[1.0, 2.0, 3.0]),
            Estimate { value: 2.0, error: Some((1.0f64 / 3.0).sqrt()) }
        );
        assert_eq!(Estimate::mean(&[5.0]), Estimate { value: 5.0, error: None });
        let ratio = Estimate::geometric_mean(&[2.0, 8.0]).unwrap();
        assert!((ratio.value - 4.0).abs() < 1e-12);
        assert!((ratio.error.unwrap() - 4.0 * 2f64.ln()).abs() < 1e-12);
    }

    #[test]
    fn the_middle_of_times_does_not_mind_outliers() {
        let times = [1.0, 1.1, 0.9, 1.0, 1.05, 0.95, 90.0, 1.0];
        let middle = Estimate::middle(&times);
        assert!((middle.value - 1.0125).abs() < 1e-12, "{middle:?}");
        assert!(
            (middle.error.unwrap() - 1.09 * 0.05 / 1.349 / 8f64.sqrt()).abs() < 1e-12
                && middle.error.unwrap() < 0.1,
            "{middle:?}"
        );
        assert_eq!(Estimate::middle(&[3.0]), Estimate { value: 3.0, error: None });
    }

    #[test]
    fn errors_of_a_ratio_add_up_in_square() {
        let exact = |value, error| Estimate { value, error: Some(error) };
        let ratio = exact(6.0, 0.6).over(exact(2.0, 0.1));
        assert!((ratio.value - 3.0).abs() < 1e-12);
        assert!((ratio.error.unwrap() - 3.0 * 0.1f64.hypot(0.05)).abs() < 1e-12);
    }

    #[test]
    fn a_median_of_ratios_turns_over_with_them() {
        assert_eq!(geometric_median(vec![9.0, 1.0, 4.0]), Some(4.0));
        assert_eq!(geometric_median(vec![16.0, 1.0, 4.0, 9.0]), Some(6.0));
        assert_eq!(geometric_median(vec![1.0 / 16.0, 1.0, 0.25, 1.0 / 9.0]), Some(1.0 / 6.0));
    }

    #[test]
    fn what_has_no_logarithm_has_no_geometric_mean() {
        for values in [vec![], vec![1.0, 0.0], vec![1.0, -1.0], vec![f64::NAN], vec![f64::INFINITY]] {
            assert!(Estimate::geometric_mean(&values).is_none() && geometric_median(values).is_none());
        }
    }
}
