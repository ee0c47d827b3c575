//! Null geodesics of conformally flat spacetimes: steppers, error control, dense output, arcs.

mod arc;
mod control;
mod dense;
mod rk4_paper;
mod rkn4;

pub use arc::{Arc, fit_arc};
pub use control::Control;
pub use dense::Dense;
pub use rk4_paper::PaperRk4;
pub use rkn4::{Step, rkn4};
