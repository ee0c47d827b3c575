//! Runs: sums over equal numbers of consecutive samples, whose spread tells the variance of the mean of all.
//!
//! Stratified samples fill the gaps that those before them left, so that single ones differ more than their mean errs.
//! So do runs, but less the longer they are, since each is spread evenly itself.

/// Most runs of a pixel. Their length doubles where there would be more: fewer would say less, more would be shorter.
pub const RUNS: usize = 8;

/// Samples in each of the runs of so many samples; the last may have fewer.
fn length(samples: usize) -> usize {
    samples.div_ceil(RUNS).next_power_of_two()
}

/// Adds the sample `index` of a pixel, all before it having been added.
pub fn add(runs: &mut [[f64; 3]], index: usize, sample: [f64; 3]) {
    let length = length(index + 1);
    if length > 1 && index == RUNS * length / 2 {
        for i in 0..RUNS {
            let pair = |j: usize| runs.get(2 * i + j).copied().unwrap_or_default();
            let (a, b) = (pair(0), pair(1));
            runs[i] = std::array::from_fn(|channel| a[channel] + b[channel]);
        }
    }
    runs[index / length].iter_mut().zip(sample).for_each(|(sum, value)| *sum += value);
}

/// Variance of the mean of so many samples, by channel; 0 of a single one.
pub fn variance_of_mean(runs: &[[f64; 3]], samples: usize) -> [f64; 3] {
    let length = length(samples);
    let count = samples.div_ceil(length);
    if count < 2 {
        return [0.0; 3];
    }
    std::array::from_fn(|channel| {
        let runs = runs.iter().take(count).map(|run| run[channel]);
        let mean = runs.clone().sum::<f64>() / samples as f64;
        let sizes = (0..count).map(|i| length.min(samples - i * length) as f64);
        let spread: f64 = runs.zip(sizes).map(|(sum, size)| size * (sum / size - mean).powi(2)).sum();
        spread / ((count - 1) * samples) as f64
    })
}

#[cfg(test)]
mod tests {
    use rand::rngs::Xoshiro256PlusPlus;
    use rand::{RngExt, SeedableRng};

    use super::*;

    fn runs(samples: &[f64]) -> [[f64; 3]; RUNS] {
        let mut runs = [[0.0; 3]; RUNS];
        samples.iter().enumerate().for_each(|(index, &value)| add(&mut runs, index, [value, -value, 1.0]));
        runs
    }

    #[test]
    fn runs_are_sums_of_consecutive_samples_at_every_number_of_them() {
        for count in 1..200 {
            let samples: Vec<f64> = (0..count).map(|i| f64::from(i * i)).collect();
            let (runs, length) = (runs(&samples), length(samples.len()));
            assert!(length.is_power_of_two() && samples.len().div_ceil(length) <= RUNS, "{count}: {length}");
            assert!(count <= 8 || samples.len().div_ceil(length) > RUNS / 2, "{count}: {length}");
            let mut chunks = samples.chunks(length);
            for run in runs {
                let sum: f64 = chunks.next().unwrap_or_default().iter().sum();
                assert_eq!(run[..2], [sum, -sum], "{count}");
            }
        }
    }

    #[test]
    fn the_variance_of_few_samples_is_that_of_the_textbook() {
        assert_eq!(variance_of_mean(&runs(&[5.0]), 1), [0.0; 3]);
        assert_eq!(variance_of_mean(&runs(&[1.0, 3.0]), 2), [1.0, 1.0, 0.0]);
        assert_eq!(variance_of_mean(&runs(&[1.0, 3.0, 5.0]), 3), [4.0 / 3.0, 4.0 / 3.0, 0.0]);
    }

    #[test]
    fn the_variance_of_independent_samples_has_the_right_mean_at_every_number_of_them() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        for count in [2, 7, 8, 9, 16, 23, 100] {
            const ROUNDS: usize = 20_000;
            let mut round = || {
                let samples: Vec<f64> = (0..count).map(|_| random.random()).collect();
                variance_of_mean(&runs(&samples), count)[0]
            };
            let mean = (0..ROUNDS).map(|_| round()).sum::<f64>() / ROUNDS as f64;
            // A few degrees of freedom leave each a deviation of about its size.
            let expected = 1.0 / 12.0 / count as f64;
            assert!((mean / expected - 1.0).abs() < 0.04, "{count}: {mean} for {expected}");
        }
    }
}
