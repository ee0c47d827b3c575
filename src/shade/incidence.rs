//! Incidence of light on a surface, and its continuation.

use glam::{DVec3, Vec3};

use super::media::{InterfaceCrossing, Media};

/// Incidence of light on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Incidence {
    /// Unit direction of travel.
    pub direction: DVec3,
    /// Unit geometric normal, towards the front.
    pub normal: DVec3,
    /// Unit shading normal.
    pub shading_normal: DVec3,
    /// Index of the material met.
    pub material: u32,
    /// Dielectrics around the path.
    pub media: Media,
    /// Through what light goes that is refracted.
    pub crossing: InterfaceCrossing,
}

/// A sampled continuation of a path.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// Unit direction of travel.
    pub direction: DVec3,
    /// BSDF × cosine / density.
    pub weight: Vec3,
    /// Density of the direction in solid angle; 0 for a lobe of a single direction.
    pub density: f64,
    /// Dielectrics around the path from here on.
    pub media: Media,
}

impl Incidence {
    /// Geometric and shading normal on the side that the light comes from.
    pub fn facing(&self) -> (DVec3, DVec3) {
        let flip = |n: DVec3, against: DVec3| if n.dot(against) > 0.0 { -n } else { n };
        let normal = flip(self.normal, self.direction);
        (normal, flip(self.shading_normal, -normal))
    }
}
