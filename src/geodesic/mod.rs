//! Null geodesics of conformally flat spacetimes: orbits, steppers, error control, arcs.
//!
#![doc = include_str!("accuracy.md")]

mod arc;
mod control;
mod dop853;
mod dopri5;
mod follow;
mod leapfrog4;
mod lens;
mod orbit;
mod rk4;
mod rk4_paper;
mod rkf45;
mod rkn4;
mod rkn6;
mod stepper;
mod time;

pub use arc::{Arc, PlaneArc, fit_arc};
pub use control::{Control, Verdict};
pub use dop853::Dop853;
pub use dopri5::Dopri5;
pub use follow::{End, Journey, follow, until};
pub use leapfrog4::Leapfrog4;
pub use lens::{Connection, Lens, Site};
pub use orbit::{Launch, Phase, Step};
pub use rk4::Rk4;
pub use rk4_paper::rk4_paper;
pub use rkf45::Rkf45;
pub use rkn4::Rkn4;
pub use rkn6::Rkn6;
pub use stepper::{Estimate, Stepper, Trial};
pub use time::elapsed;
