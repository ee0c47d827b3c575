//! Variance of the mean colour: sample variance over the number of samples.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "Variance of the pixel's mean, per colour channel",
    channels: &["variance.R", "variance.G", "variance.B"],
    needs: Needs::NOTHING,
    value: Value::Vector(|sample| {
        let radiance = sample.radiance.as_dvec3();
        Some(radiance * radiance)
    }),
    average: Average::BesideColor(|square, mean, samples| {
        let spread = (square - mean * mean).max(0.0);
        spread / (samples - 1.0).max(1.0)
    }),
};
