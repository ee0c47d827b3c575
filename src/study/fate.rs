//! Fates of rays, by name.

use std::convert::Infallible;

use crate::trace::transport::Outcome;

/// How a ray ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    Hit,
    Escaped,
    Captured,
    StepLimit,
    NonFinite,
}

impl Fate {
    pub(super) const ALL: [Self; 5] =
        [Self::Hit, Self::Escaped, Self::Captured, Self::StepLimit, Self::NonFinite];

    pub(super) fn of(end: &Outcome<Infallible>) -> Self {
        match *end {
            Outcome::Flying(never) => match never {},
            Outcome::Landed(_) => Self::Hit,
            Outcome::Escaped(_) => Self::Escaped,
            Outcome::Captured => Self::Captured,
            Outcome::StepLimit => Self::StepLimit,
            Outcome::NonFinite => Self::NonFinite,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Hit => "hit",
            Self::Escaped => "escaped",
            Self::Captured => "captured",
            Self::StepLimit => "step limit",
            Self::NonFinite => "not finite",
        }
    }
}
