//! Side of a wormhole on which the camera ray ends.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "Side on which the camera ray of the first sample ends: 1 near, 2 far side of a wormhole, 0 where it is lost",
    channels: &["side.ID"],
    needs: Needs::CAMERA_RAY,
    value: Value::Number(|sample| sample.camera_ray?.side.map(|side| f64::from(side as u8) + 1.0)),
    average: Average::First,
};
