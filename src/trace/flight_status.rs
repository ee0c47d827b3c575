//! State of a ray in flight.

use crate::math::columns::plain_field;

/// State of a ray after a step that met nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FlightStatus {
    /// It flies on.
    #[default]
    Flies,
    /// It leaves to infinity.
    Leaves,
    /// It falls through the horizon.
    Falls,
    /// It took more steps than allowed.
    StepLimit,
    /// Its state is no longer finite.
    NonFinite,
}

plain_field!(FlightStatus);
