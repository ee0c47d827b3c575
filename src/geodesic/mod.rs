//! Null geodesics of conformally flat spacetimes: steppers, error control, dense output, arcs.

mod arc;
mod control;
mod dense;
mod rk4_paper;
mod rkn4;
mod rkn5;
mod stepper;

pub use arc::{Arc, fit_arc};
pub use control::{Control, Verdict};
pub use dense::Dense;
pub use rk4_paper::PaperRk4;
pub use rkn4::Rkn4;
pub use rkn5::Rkn5;
pub use stepper::{Step, Stepper};
