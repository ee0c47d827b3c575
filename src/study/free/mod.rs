//! Rays followed where nothing is in the way, from any start to a sphere around the centre of the spacetime, as tables
//! have them.
//!
//! A family of spacetimes has one file with its [`TableForm`]: the columns that describe a ray, those that are found,
//! and how a ray is followed; and one line in [`TableForm::of`].

mod accuracy;
mod forms;
mod free_ray_end;
pub mod isotropic;
mod sensitivity;
mod several_holes;
pub(super) mod spinning;
mod table_form;
mod through_throat;

pub use accuracy::Accuracy;
pub use free_ray_end::FreeRayEnd;
pub(super) use table_form::other_chart;
pub use table_form::{Arrival, Cells, SphereCrossing, TableForm, Traced};
