//! Place and orientation of a spacetime in the world.

use glam::{DMat3, DVec3};

use crate::math::frame;

/// Centre and axis of a spacetime.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World position of the centre.
    pub center: DVec3,
    /// World unit vector of the axis; of no effect without one.
    pub axis: DVec3,
}

impl Default for Placement {
    fn default() -> Self {
        DVec3::ZERO.into()
    }
}

impl From<DVec3> for Placement {
    /// About `center`, with the axis upwards, along +Y.
    fn from(center: DVec3) -> Self {
        Self { center, axis: DVec3::Y }
    }
}

impl Placement {
    /// Rotation from the world to coordinates with z along the axis.
    pub fn rotation(&self) -> DMat3 {
        let (x, y) = frame::tangents(self.axis);
        DMat3::from_cols(x, y, self.axis).transpose()
    }

    /// A world position, relative to the centre, with z along the axis.
    pub fn local(&self, point: DVec3) -> DVec3 {
        self.rotation() * (point - self.center)
    }
}
