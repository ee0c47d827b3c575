//! Sides of a wormhole: the two worlds that its throat joins.

use glam::DVec3;

/// World of a place, a ray or a light. Where there is no wormhole, all of them are on the near side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Side {
    /// The world of a wormhole's `center`; the only one elsewhere.
    #[default]
    Near,
    /// The world of its `far_center`.
    Far,
}

impl Side {
    /// Both, near first.
    pub const BOTH: [Self; 2] = [Self::Near, Self::Far];

    /// The side beyond the throat.
    pub fn other(self) -> Self {
        match self {
            Self::Near => Self::Far,
            Self::Far => Self::Near,
        }
    }

    /// Name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Near => "near",
            Self::Far => "far",
        }
    }
}

/// Point at infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtInfinity {
    /// World that it is at infinity of.
    pub side: Side,
    /// Unit direction to it.
    pub direction: DVec3,
}

impl AtInfinity {
    /// Point of the near side, in a unit direction.
    pub fn near(direction: DVec3) -> Self {
        Self { side: Side::Near, direction }
    }
}
