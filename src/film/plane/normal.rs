//! Shading normal at the first hit.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "World shading normal at the first hit, mean over all samples (zero where nothing is hit), not renormalised",
    channels: &["normal.X", "normal.Y", "normal.Z"],
    needs: Needs::CAMERA_RAY,
    value: Value::Vector(|sample| sample.first_hit().map(|hit| hit.normal)),
    average: Average::Samples,
};
