//! Local frame of a surface where light comes in: z along the normal.

use glam::DVec3;

use crate::math::frame::tangents;
use crate::shade::incidence::Incidence;

/// Largest square of the sine of the angle between vectors that are taken as parallel.
const PARALLEL: f64 = 1e-12;
/// Least cosine to the normal that is computed with.
const GRAZING: f64 = 1e-7;

/// Orthonormal frame around the normal that light is scattered about, on the side that it comes from.
#[derive(Clone, Copy, Debug)]
pub struct LocalFrame {
    x: DVec3,
    y: DVec3,
    /// Normal: the shading normal, or the geometric one where light comes from below that.
    pub z: DVec3,
    /// Geometric normal.
    normal: DVec3,
}

impl LocalFrame {
    /// Frame of an incidence, x along `tangent` as far as it is square to the normal; along anything without one.
    #[inline(always)]
    pub fn new(incidence: &Incidence, tangent: Option<DVec3>) -> Self {
        let &Incidence { direction, normal, shading_normal, .. } = incidence;
        let z = if -direction.dot(shading_normal) > GRAZING { shading_normal } else { normal };
        let across = tangent.map_or(DVec3::ZERO, |tangent| tangent - tangent.dot(z) * z);
        let (x, y) = if across.length_squared() > PARALLEL {
            let x = across.normalize();
            (x, z.cross(x))
        } else {
            tangents(z)
        };
        Self { x, y, z, normal }
    }

    /// The direction that light comes from.
    #[inline(always)]
    pub fn towards(&self, direction: DVec3) -> DVec3 {
        let w = self.local(-direction);
        DVec3 { z: w.z.max(GRAZING), ..w }
    }

    /// A world direction in the frame.
    #[inline(always)]
    pub fn local(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.dot(self.x), w.dot(self.y), w.dot(self.z))
    }

    /// The world direction of one in the frame, unit.
    #[inline(always)]
    pub fn world(&self, w: DVec3) -> DVec3 {
        (w.x * self.x + w.y * self.y + w.z * self.z).normalize()
    }

    /// Mirror image of a direction about the surface, if that is below it.
    #[inline(always)]
    pub fn image_above(&self, direction: DVec3) -> DVec3 {
        direction - 2.0 * direction.dot(self.normal).min(0.0) * self.normal
    }

    /// Mirror image of a direction above the surface, in the frame; `None` of one below.
    #[inline(always)]
    pub fn image_below(&self, direction: DVec3) -> Option<DVec3> {
        let height = direction.dot(self.normal);
        (height > 0.0).then(|| self.local(direction - 2.0 * height * self.normal))
    }

    /// Side of the surface on which an outgoing direction lies: 1 where light comes from, −1 beyond; 0 where the
    /// normals disagree and no light goes.
    #[inline(always)]
    pub fn side(&self, out: DVec3, local: DVec3) -> i8 {
        let geometric = out.dot(self.normal);
        if geometric > 0.0 && local.z > 0.0 {
            1
        } else if geometric < 0.0 && local.z < 0.0 {
            -1
        } else {
            0
        }
    }
}
