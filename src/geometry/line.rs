//! Straight pieces of rays.

use glam::DVec3;

use crate::math::columns::columns;

columns! {
    /// A straight segment.
    #[derive(PartialEq)]
    pub struct Line => LineBlock {
        /// Start.
        p0: DVec3,
        /// End.
        p2: DVec3,
    }
}
