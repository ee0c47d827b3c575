//! Incidence of light on a surface, and what a lobe makes of it: rows, so that lobes are kernels.

use glam::{DVec3, Vec3};

use crate::math::columns::columns;

columns! {
    /// Incidence of light on a surface.
    pub struct Incidence => IncidenceBlock {
        /// Unit direction of travel.
        direction: DVec3,
        /// Unit geometric normal on the side that the light comes from.
        normal: DVec3,
        /// Unit shading normal on that side.
        shading_normal: DVec3,
        /// Index of refraction beyond the surface relative to that before it; 1 where light does not go through.
        eta: f64,
    }
}

columns! {
    /// A sampled continuation of a path.
    pub struct Bounce => BounceBlock {
        /// Unit direction of travel.
        direction: DVec3,
        /// BSDF × cosine / density; 0 if the path is absorbed.
        weight: Vec3,
        /// Density of the direction in solid angle; 0 for a lobe of a single direction.
        density: f64,
        /// True if it goes through the surface.
        crosses: bool,
    }
}

columns! {
    /// Response of a lobe to light from a direction.
    pub struct Response => ResponseBlock {
        /// BSDF × cosine.
        bsdf: Vec3,
        /// Density with which a bounce takes that direction, in solid angle; 0 where no light goes.
        density: f64,
    }
}

impl Incidence {
    /// Incidence on a surface with these unit normals, geometric and shading, towards its front.
    #[inline(always)]
    pub fn new(direction: DVec3, normal: DVec3, shading_normal: DVec3, eta: f64) -> Self {
        let flip = |n: DVec3, against: DVec3| if n.dot(against) > 0.0 { -n } else { n };
        let normal = flip(normal, direction);
        Self { direction, normal, shading_normal: flip(shading_normal, -normal), eta }
    }
}
