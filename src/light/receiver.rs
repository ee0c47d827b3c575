//! Receivers of light.

use glam::DVec3;

use super::tree::LitSide;
use crate::geometry::PrimitiveId;

/// A surface that is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// World position.
    pub position: DVec3,
    /// Unit normal on the side that is lit.
    pub normal: DVec3,
    /// Share of light that comes head-on for which light that grazes it counts: the sine of the angle by which shading
    /// normals lean, or the share of metal.
    pub grazing: f32,
    /// True if light from behind counts as well.
    pub both_sides: bool,
    /// The primitive that the position lies on.
    pub on: PrimitiveId,
}

impl Receiver {
    /// The only side that is lit.
    #[inline(always)]
    pub fn lit_side(&self) -> Option<LitSide> {
        (!self.both_sides).then_some(LitSide { normal: self.normal, grazing: self.grazing })
    }
}
