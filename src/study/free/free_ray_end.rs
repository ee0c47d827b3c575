//! Ends of rays with nothing in their way.

/// Status of a ray at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FreeRayEnd {
    /// It crossed the sphere outwards.
    Escaped,
    /// It falls through the horizon before.
    Captured,
    /// It leaves to infinity without ever crossing the sphere outwards.
    Missed,
    /// It took more steps than allowed.
    StepLimit,
    /// Its state is no longer finite.
    NonFinite,
}

impl FreeRayEnd {
    /// All, in order.
    pub const ALL: [Self; 5] =
        [Self::Escaped, Self::Captured, Self::Missed, Self::StepLimit, Self::NonFinite];

    /// As tables have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Escaped => "escaped",
            Self::Captured => "captured",
            Self::Missed => "missed",
            Self::StepLimit => "step-limit",
            Self::NonFinite => "non-finite",
        }
    }

    /// True if numbers failed, and not the ray.
    pub fn is_lost(self) -> bool {
        matches!(self, Self::StepLimit | Self::NonFinite)
    }
}
