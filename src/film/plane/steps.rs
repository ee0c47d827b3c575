//! March steps of a path.

use super::definition::{Average, Definition, Needs, Value};

pub const PLANE: Definition = Definition {
    about: "Mean number of march steps per path, all its rays together",
    channels: &["steps.N"],
    needs: Needs::STEPS,
    value: Value::Number(|sample| Some(f64::from(sample.steps))),
    average: Average::Samples,
};
