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
    /// The primitive that the position lies on.
    pub on: PrimitiveId,
}
