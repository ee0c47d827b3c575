//! Points where rays start, as a row of columns: launches run lane beside lane.

use glam::DVec3;

use super::transport::Start;
use crate::geometry::PrimitiveId;
use crate::math::columns::columns;

columns! {
    /// Start of a ray.
    pub struct LaunchPoint => LaunchPointBlock {
        /// World position.
        position: DVec3,
        /// Unit direction in the static frame.
        direction: DVec3,
        /// The primitive it lies on.
        origin_prim: PrimitiveId,
    }
}

impl From<Start> for LaunchPoint {
    fn from(Start { position, direction, origin_prim, carried: () }: Start) -> Self {
        Self { position, direction, origin_prim }
    }
}
