//! Material colour at the first hit.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "Colour of the material at the first hit, mean over all samples",
    channels: &["albedo.R", "albedo.G", "albedo.B"],
    needs: Needs::CAMERA_RAY,
    value: Value::Vector(|sample| sample.first_hit().map(|hit| hit.albedo.as_dvec3())),
    average: Average::Samples,
};
