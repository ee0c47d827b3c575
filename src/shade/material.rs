//! Material of a surface: one lobe and an emission.

use glam::Vec3;

use super::bsdf::{Diffuse, Lobe, Principled};
use super::media::InterfaceCrossing;

/// A material: a lobe and what the surface emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Scattering lobe.
    pub lobe: Lobe,
    /// Share of light that is absorbed inside of it per length that observers at rest measure, if that is short.
    pub attenuation: Vec3,
    /// Emitted radiance, the same in all directions.
    pub emission: Vec3,
    /// True if the back of the surface (against its normal) emits as well.
    pub emits_both_sides: bool,
}

impl Default for Material {
    /// Diffuse grey of albedo 0.8, glTF's and Blender's look for "no material".
    fn default() -> Self {
        Self {
            lobe: Lobe::Diffuse(Diffuse { albedo: Vec3::splat(0.8) }),
            attenuation: Vec3::ZERO,
            emission: Vec3::ZERO,
            emits_both_sides: true,
        }
    }
}

impl Material {
    /// True if the surface emits light at all.
    pub fn emits(&self) -> bool {
        self.emission != Vec3::ZERO
    }

    /// True if light from one direction leaves in many: light sampling helps.
    pub fn spreads_light(&self) -> bool {
        !self.lobe.is_specular() && self.lobe.albedo() != Vec3::ZERO
    }

    /// True if light from one direction leaves in one or two and no others: a mirror, glass.
    pub fn is_specular(&self) -> bool {
        self.lobe.is_specular()
    }

    /// True if light enters what is beyond the surface.
    pub fn is_dielectric(&self) -> bool {
        self.lobe.ior().is_some()
    }

    /// The material with light that microfacets scatter more than once given back, or not.
    pub fn with_multiscatter(self, multiscatter: bool) -> Self {
        match self.lobe {
            Lobe::Principled(lobe) => {
                Self { lobe: Lobe::Principled(Principled { multiscatter, ..lobe }), ..self }
            }
            Lobe::Diffuse(_) | Lobe::Mirror(_) | Lobe::Dielectric(_) => self,
        }
    }

    /// The colour that the albedo AOV shows.
    pub fn albedo(&self) -> Vec3 {
        self.lobe.albedo()
    }
}

/// Share of light that a medium absorbs per length, if that is short: it leaves `colour` after `distance`.
pub fn attenuation(colour: Vec3, distance: f32) -> Vec3 {
    colour.map(|share| if share < 1.0 { -libm::logf(share.max(f32::MIN_POSITIVE)) / distance } else { 0.0 })
}

/// Index of refraction of what light goes into through faces of `materials`, relative to that of what it comes from.
pub fn relative_index(materials: &[Material], crossing: &InterfaceCrossing) -> f64 {
    let index = |medium: Option<u32>| {
        medium.and_then(|medium| materials[medium as usize].lobe.ior()).map_or(1.0, f64::from)
    };
    index(crossing.into.current()) / index(crossing.from)
}
