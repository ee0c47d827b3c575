//! Entity at the first hit.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "Entity index + 1 of the first hit of the first sample, 0 where nothing is hit",
    channels: &["entity.ID"],
    needs: Needs::CAMERA_RAY,
    value: Value::Number(|sample| sample.first_hit().map(|hit| f64::from(hit.entity) + 1.0)),
    average: Average::First,
};
