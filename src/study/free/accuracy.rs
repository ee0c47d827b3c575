//! Accuracy with which rays are followed.

use crate::scene::{Precision, StepperKind};

/// Accuracy with which rays are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// One of those that follow such rays: [`TableForm::steppers`](super::TableForm::steppers).
    pub stepper: StepperKind,
    /// Largest error of a ray's direction, all its steps together, radians at its start.
    pub tolerance: f64,
    /// Numbers that the orbit is followed in.
    pub precision: Precision,
}
