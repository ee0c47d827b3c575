//! Place and orientation of a spacetime in the world.

use glam::{DMat3, DVec3};

use super::mouths::Mouths;
use crate::math::frame;

/// Centre and axis of a spacetime, and of a wormhole the centre in the far world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World position of the centre.
    pub center: DVec3,
    /// World unit vector of the axis; of no effect without one.
    pub axis: DVec3,
    /// Centre in the far world of a wormhole; of no effect without one.
    pub far_center: DVec3,
    /// Rotation of the far world of a wormhole; of no effect without one.
    pub far_rotation: DMat3,
}

impl Default for Placement {
    fn default() -> Self {
        DVec3::ZERO.into()
    }
}

impl From<DVec3> for Placement {
    /// About `center` in both worlds of a wormhole, with the axis upwards, along +Y, and nothing rotated.
    fn from(center: DVec3) -> Self {
        Self { center, axis: DVec3::Y, far_center: center, far_rotation: DMat3::IDENTITY }
    }
}

impl From<Mouths> for Placement {
    fn from(mouths: Mouths) -> Self {
        let Mouths { near, far: far_center, rotation: far_rotation } = mouths;
        Self { far_center, far_rotation, ..near.into() }
    }
}

impl Placement {
    /// Centres of a wormhole here.
    pub fn mouths(&self) -> Mouths {
        Mouths { near: self.center, far: self.far_center, rotation: self.far_rotation }
    }

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
