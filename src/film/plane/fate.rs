//! End of the camera ray.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "Fate of the camera ray of the first sample: 1 hit, 2 escaped, 3 captured, 4 step limit, 5 non-finite",
    channels: &["fate.ID"],
    needs: Needs::CAMERA_RAY,
    value: Value::Number(|sample| sample.camera_ray.map(|ray| f64::from(ray.fate as u8))),
    average: Average::First,
};
