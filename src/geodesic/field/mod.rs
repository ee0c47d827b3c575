//! Rays in fields of refraction, in three dimensions.

mod control;
mod follow;
mod step;

pub use control::{FieldControl, FieldVerdict};
pub use follow::{FieldEnd, FieldJourney, follow_field};
pub use step::{FieldRays, FieldStep, lane, set_lane};
