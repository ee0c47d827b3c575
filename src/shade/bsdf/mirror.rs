//! Perfect specular reflection.

use glam::{DVec3, Vec3};

use super::model::Bsdf;
use super::variation::Variation;
use crate::math::columns::columns;
use crate::shade::incidence::{Bounce, Incidence};

columns! {
    /// Perfect specular reflection.
    #[derive(PartialEq)]
    pub struct Mirror => MirrorBlock {
        /// Reflected fraction of the radiance, no Fresnel factor.
        reflectance: Vec3,
    }
}

impl Bsdf for Mirror {
    const NAME: &'static str = "mirror";

    #[inline(always)]
    fn sample(&self, incidence: &Incidence, _: [f32; 4]) -> Bounce {
        let &Incidence { direction, normal, shading_normal, .. } = incidence;
        let direction = reflect_above(direction, normal, shading_normal);
        Bounce { direction, weight: self.reflectance, density: 0.0, crosses: false }
    }

    fn varied(self, &Variation { color, .. }: &Variation) -> Self {
        Self { reflectance: color * self.reflectance }
    }

    fn albedo(&self) -> Vec3 {
        self.reflectance
    }

    fn is_specular(&self) -> bool {
        true
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
