//! Rays followed where nothing is in the way, from any start to a sphere around the centre of the spacetime, as tables
//! have them.
//!
//! A family of spacetimes has one file with its [`Form`]: the columns that describe a ray, those that are found, and how
//! a ray is followed; and one line in [`Form::of`].

mod accuracy;
mod form;
pub mod isotropic;
mod lengths;
mod sensitivity;
mod several_holes;
mod spinning;
mod status;

pub use accuracy::Accuracy;
pub use form::{Arrival, Cells, Form, SphereCrossing, Traced};
pub use status::FreeRayEnd;
