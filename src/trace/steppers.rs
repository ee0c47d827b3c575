//! From the name of a stepper to its code: the one table of them.

use crate::geodesic::{Dop853, Dopri5, Leapfrog4, Rk4, Rkf45, Rkn4, Rkn6, Stepper};
use crate::scene::StepperKind;

/// Visitor of the stepper that is named.
pub trait UseStepper {
    /// Result of the visit.
    type Output;

    /// Visits the stepper.
    fn with(self, stepper: impl Stepper + 'static) -> Self::Output;
}

/// Does `work` with the stepper of this name; `None` for the paper's scheme, which knows neither orbits nor tolerances.
pub fn with_stepper<U: UseStepper>(stepper: StepperKind, work: U) -> Option<U::Output> {
    match stepper {
        StepperKind::Rkn6 | StepperKind::Series | StepperKind::Quadrature => Some(work.with(Rkn6)),
        StepperKind::Dop853 => Some(work.with(Dop853)),
        StepperKind::Dopri5 => Some(work.with(Dopri5)),
        StepperKind::Rkf45 => Some(work.with(Rkf45)),
        StepperKind::Rkn4 => Some(work.with(Rkn4)),
        StepperKind::Rk4 => Some(work.with(Rk4)),
        StepperKind::Leapfrog4 => Some(work.with(Leapfrog4)),
        StepperKind::Rk4Paper => None,
    }
}
