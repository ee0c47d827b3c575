//! Narrow beams: how wide they get along a ray.

use glam::DVec3;

use crate::spacetime::Side;

/// A ray that a narrow beam surrounds.
#[derive(Clone, Copy, Debug)]
pub struct BeamRay {
    /// Side and world position of its start.
    pub from: (Side, DVec3),
    /// Unit direction in which it leaves.
    pub leaving: DVec3,
    /// Side and world position of its end.
    pub to: (Side, DVec3),
    /// Unit direction of travel in which it arrives.
    pub arriving: DVec3,
}

/// Widths of narrow beams in a spacetime in which they are known in closed form.
pub trait Beams: Send + Sync {
    /// Widths across the ray, scene units, of a beam of one radian: in the plane of its orbit, and out of that.
    fn widths(&self, ray: &BeamRay) -> Option<[f64; 2]>;

    /// [`Self::widths`] of many: calls `each` for every one, in order.
    fn all_widths(&self, rays: &[BeamRay], each: &mut dyn FnMut(usize, Option<[f64; 2]>));
}
