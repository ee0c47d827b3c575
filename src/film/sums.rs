//! Sums over the samples of pixels, for one plane.

use std::iter::zip;

use super::plane::{Aov, Average};
use super::runs::{self, RUNS};
use super::sample::Sample;

/// Sums of one plane over the samples of some pixels, in f64.
pub struct Sums {
    aov: Aov,
    /// Each pixel's channels, then the number of samples that have a value if the mean is over those; or its runs.
    values: Vec<f64>,
}

/// Values that are kept of a pixel.
const fn stride(aov: Aov) -> usize {
    let definition = aov.definition();
    match definition.average {
        Average::Samples | Average::First => definition.channels.len(),
        Average::Present { .. } => definition.channels.len() + 1,
        Average::VarianceOfMean => 3 * RUNS,
    }
}

impl Sums {
    /// Bytes for each pixel.
    pub fn pixel_bytes(aov: Aov) -> usize {
        stride(aov) * size_of::<f64>()
    }

    /// Empty sums of so many pixels.
    pub fn new(aov: Aov, pixels: usize) -> Self {
        Self { aov, values: vec![0.0; stride(aov) * pixels] }
    }

    /// The plane.
    pub fn aov(&self) -> Aov {
        self.aov
    }

    fn of(&mut self, pixel: usize) -> &mut [f64] {
        let stride = stride(self.aov);
        &mut self.values[pixel * stride..][..stride]
    }

    /// Forgets the samples of a pixel.
    pub fn clear(&mut self, pixel: usize) {
        self.of(pixel).fill(0.0);
    }

    /// Adds a sample to a pixel that holds so many `samples`.
    pub fn add(&mut self, pixel: usize, sample: &Sample, samples: usize) {
        let definition = self.aov.definition();
        let Some(values) = definition.value.of(sample) else { return };
        let sums = self.of(pixel);
        let mut sum = || zip(&mut *sums, values).for_each(|(sum, value)| *sum += value);
        match definition.average {
            Average::Samples => sum(),
            Average::First if samples > 0 => {}
            Average::First => sum(),
            Average::Present { .. } => {
                sum();
                sums[definition.channels.len()] += 1.0;
            }
            Average::VarianceOfMean => runs::add(sums.as_chunks_mut().0, samples, values),
        }
    }

    /// Values of a pixel's channels, over so many `samples`.
    pub fn values(&self, pixel: usize, samples: usize) -> impl Iterator<Item = f32> {
        let (stride, definition) = (stride(self.aov), self.aov.definition());
        let sums = &self.values[pixel * stride..][..stride];
        let channels = definition.channels.len();
        let first = [0, 1, 2].map(|channel| sums.get(channel).copied().unwrap_or_default());
        let values = match definition.average {
            Average::Samples => first.map(|sum| sum / samples as f64),
            Average::Present { otherwise } => {
                let count = sums[channels];
                first.map(|sum| if count > 0.0 { sum / count } else { otherwise.into() })
            }
            Average::First => first,
            Average::VarianceOfMean => runs::variance_of_mean(sums.as_chunks().0, samples),
        };
        values.into_iter().take(channels).map(|value| value as f32)
    }
}
