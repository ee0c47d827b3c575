//! Variance of the mean colour, from the spread of runs of samples.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "Variance of the pixel's mean, per colour channel",
    channels: &["variance.R", "variance.G", "variance.B"],
    needs: Needs::NOTHING,
    value: Value::Vector(|sample| Some(sample.radiance.as_dvec3())),
    average: Average::VarianceOfMean,
};
