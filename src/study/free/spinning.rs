//! Rays around a spinning hole, in ingoing Cartesian Kerr–Schild coordinates.

use super::super::input_error::{Input, InputError};
use super::Form;
use crate::scene::StepperKind;

/// Form of the tables.
pub(super) static FORM: Form = Form {
    needed: &["x0", "y0", "z0", "px0", "py0", "pz0", "r_out"],
    optional: &[],
    results: &["x1", "y1", "z1", "px1", "py1", "pz1", "t", "Lz", "Q", "sens"],
    crossing: ["x1", "y1", "z1", "px1", "py1", "pz1", "sens"],
    steppers: &[StepperKind::Dop853],
    stepper: None,
    trace: |_, _, _| Err(renders_only()),
    arrive: |_, _, _| Err(renders_only()),
};

fn renders_only() -> InputError {
    InputError {
        input: Input::Spacetime,
        cause: "rays around a spinning hole run in renders only".to_owned(),
        remedy: "give another --spacetime".to_owned(),
    }
}
