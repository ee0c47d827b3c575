//! Sums over the samples of pixels, for one plane.

use std::iter::zip;

use super::plane::{Aov, Average};
use super::sample::Sample;

/// Sums of one plane over the samples of some pixels, in f64.
pub struct Sums {
    aov: Aov,
    /// Each pixel's channels, then the number of samples that have a value if the mean is over those.
    values: Vec<f64>,
}

/// Values that are kept of a pixel.
const fn stride(aov: Aov) -> usize {
    let definition = aov.definition();
    definition.channels.len() + matches!(definition.average, Average::Present { .. }) as usize
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

    /// Adds a sample to a pixel; `is_first` if it holds none.
    pub fn add(&mut self, pixel: usize, sample: &Sample, is_first: bool) {
        let definition = self.aov.definition();
        if matches!(definition.average, Average::First) && !is_first {
            return;
        }
        let Some(values) = definition.value.of(sample) else { return };
        let (sums, count) = self.of(pixel).split_at_mut(definition.channels.len());
        zip(sums, values).for_each(|(sum, value)| *sum += value);
        count.iter_mut().for_each(|count| *count += 1.0);
    }

    /// Values of a pixel's channels, whose mean colour is `color` over so many `samples`.
    pub fn values(&self, pixel: usize, color: [f64; 3], samples: f64) -> impl Iterator<Item = f32> {
        let (stride, definition) = (stride(self.aov), self.aov.definition());
        let (sums, count) = self.values[pixel * stride..][..stride].split_at(definition.channels.len());
        zip(sums, color).map(move |(&sum, color)| match definition.average {
            Average::Samples => (sum / samples) as f32,
            Average::Present { otherwise } => match count {
                [count] if *count > 0.0 => (sum / count) as f32,
                _ => otherwise,
            },
            Average::First => sum as f32,
            Average::BesideColor(value) => value(sum / samples, color, samples) as f32,
        })
    }
}
