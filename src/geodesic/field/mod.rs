//! Rays in fields of refraction, in three dimensions.

mod control;
mod follow;
mod step;

pub use control::{FieldControl, FieldVerdict};
pub use follow::{FieldEnd, FieldJourney, at_infinity, follow_field};
pub use step::{FieldRays, FieldStep, alone, lane, set_lane};
