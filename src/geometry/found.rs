//! Answer of a search.

use glam::DVec3;

use super::PrimitiveId;

/// Something found along a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// World position of the crossing.
    pub point: DVec3,
    /// Primitive that is hit.
    pub primitive: PrimitiveId,
}
