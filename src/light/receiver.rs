//! Receivers of light.

use glam::DVec3;

use crate::geometry::PrimitiveId;

/// A surface that is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// World position.
    pub position: DVec3,
    /// Unit normal on the side that is lit.
    pub normal: DVec3,
    /// True if light from behind counts as well.
    pub both_sides: bool,
    /// The primitive that the position lies on.
    pub on: PrimitiveId,
}

impl Receiver {
    /// Normal of the only side that is lit.
    #[inline(always)]
    pub fn lit_side(&self) -> Option<DVec3> {
        (!self.both_sides).then_some(self.normal)
    }
}
