//! Depth: length of the camera ray to the first hit.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "Coordinate path length from the camera to the first hit, scene units; infinite where nothing is hit",
    channels: &["depth.Z"],
    needs: Needs::LENGTH,
    value: Value::Number(|sample| sample.first_hit().map(|hit| hit.length)),
    average: Average::Present { otherwise: f32::INFINITY },
};
