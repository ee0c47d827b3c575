//! Perfect specular reflection.

use glam::{DVec3, Vec3};

use super::model::Bsdf;
use crate::shade::incidence::{Bounce, Incidence};

/// Perfect specular reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Reflected fraction of the radiance, no Fresnel factor.
    pub reflectance: Vec3,
}

impl Bsdf for Mirror {
    const NAME: &'static str = "mirror";
    const IS_SPECULAR: bool = true;

    #[inline(always)]
    fn sample(&self, incidence: &Incidence, _: impl FnOnce() -> f64, _: [f32; 4]) -> Option<Bounce> {
        let (normal, shading) = incidence.facing();
        let direction = reflect_above(incidence.direction, normal, shading);
        Some(Bounce { direction, weight: self.reflectance, density: 0.0, media: incidence.media })
    }

    fn albedo(&self) -> Vec3 {
        self.reflectance
    }
}

/// The mirror image of `direction` about a surface of unit normal `normal` (either side).
fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    (direction - 2.0 * direction.dot(normal) * normal).normalize()
}

/// Reflection about the shading normal, or about the geometric one where that would go through the surface.
pub(super) fn reflect_above(direction: DVec3, normal: DVec3, shading: DVec3) -> DVec3 {
    let out = reflect(direction, shading);
    if out.dot(normal) > 0.0 { out } else { reflect(direction, normal) }
}
