//! Rays in fields of refraction, in three dimensions.

mod connect;
mod control;
mod follow;
mod legs;
mod step;
#[cfg(feature = "cli")]
mod time;

pub use connect::{FieldConnection, FieldTarget, JoinLimits, join_in_field};
pub use control::{FieldControl, FieldVerdict};
pub(crate) use follow::at_infinity;
pub use follow::{FieldEnd, FieldJourney, follow_field};
pub use legs::{FieldStop, join_by_way};
pub use step::{FieldRays, FieldStep, alone};
pub(crate) use step::{lane, set_lane};
#[cfg(feature = "cli")]
pub(crate) use time::elapsed_in_field;
