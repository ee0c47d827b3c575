//! Ends of rays, by the outcome of their last move.

use std::convert::Infallible;

use super::transport::Outcome;
pub use crate::film::RayEnd;

impl RayEnd {
    /// All, in order.
    pub const ALL: [Self; 5] = [Self::Hit, Self::Escaped, Self::Captured, Self::StepLimit, Self::NonFinite];

    /// End of a ray by the outcome of its last move.
    pub fn of(end: &Outcome<Infallible>) -> Self {
        match *end {
            Outcome::Flying(never) => match never {},
            Outcome::Landed(_) => Self::Hit,
            Outcome::Escaped(_) => Self::Escaped,
            Outcome::Captured => Self::Captured,
            Outcome::StepLimit => Self::StepLimit,
            Outcome::NonFinite => Self::NonFinite,
        }
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hit => "hit",
            Self::Escaped => "escaped",
            Self::Captured => "captured",
            Self::StepLimit => "step limit",
            Self::NonFinite => "not finite",
        }
    }
}
