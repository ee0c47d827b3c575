//! Null geodesics: orbits of conformally flat spacetimes, steppers, error control, arcs; spinning holes in [`kerr`].
//!
#![doc = include_str!("accuracy.md")]

mod arc;
mod areal_quadrature;
mod areal_series;
mod control;
mod dop853;
mod dopri5;
mod field;
mod follow;
pub mod kerr;
mod leapfrog4;
mod lens;
mod orbit;
mod orbit_stepper;
mod powers;
mod rk4;
mod rk4_paper;
mod rkf45;
mod rkn4;
mod rkn6;
mod sampled_arc;
mod space_arc;
mod stepper;
mod time;

pub use arc::{Arc, PlaneArc, fit_arc};
pub use areal_quadrature::{ArealJourney, ArealQuadrature, Passage};
pub use areal_series::ArealSeries;
pub use control::{Control, StepVerdict};
pub use dop853::Dop853;
pub use dopri5::Dopri5;
#[cfg(feature = "cli")]
pub(crate) use field::elapsed_in_field;
pub use field::{
    FieldConnection, FieldControl, FieldEnd, FieldJourney, FieldRays, FieldStep, FieldStop, FieldTarget,
    FieldVerdict, JoinLimits, alone, follow_field, join_by_way, join_in_field,
};
pub(crate) use field::{at_infinity, lane, set_lane};
pub use follow::{Journey, OrbitEnd, follow, until};
pub use leapfrog4::Leapfrog4;
pub use lens::{Connection, InwardBending, Lens, LensRay, RayDirections, Site, WeakBending};
pub use orbit::{Launch, Phase, Step};
pub use orbit_stepper::OrbitStepper;
pub use powers::{UsePowers, with_powers};
pub use rk4::Rk4;
pub use rk4_paper::rk4_paper;
pub use rkf45::Rkf45;
pub use rkn4::Rkn4;
pub use rkn6::Rkn6;
pub(crate) use sampled_arc::fit_sampled_arc;
pub(crate) use space_arc::{SpaceArc, fit_space_arc, halfway};
pub use stepper::{StepErrorModel, Stepper, Trial};
pub use time::elapsed;
