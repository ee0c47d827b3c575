//! Narrow beams: how wide they get along a ray.

use glam::DVec3;

use crate::spacetime::Side;

/// Widths of narrow beams in a spacetime in which they are known in closed form.
pub trait Beams: Send + Sync {
    /// Widths across the ray, scene units, of a beam of one radian from a place in the world of a side, where its ray leaves
    /// in a unit direction, to another, where it arrives travelling in one: in the plane of its orbit, and out of that.
    fn widths(&self, from: ((Side, DVec3), DVec3), to: ((Side, DVec3), DVec3)) -> Option<[f64; 2]>;
}
