//! Position of the first hit.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "World position of the first hit, mean over the samples that hit",
    channels: &["position.X", "position.Y", "position.Z"],
    needs: Needs::CAMERA_RAY,
    value: Value::Vector(|sample| sample.first_hit().map(|hit| hit.position)),
    average: Average::Present { otherwise: 0.0 },
};
