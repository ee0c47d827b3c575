//! Material of a surface: one lobe and an emission.

use glam::Vec3;

/// The scattering lobe of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// Lambertian reflection, both sides. `albedo` in [0, 1] per channel.
    Diffuse {
        /// Reflected fraction of the irradiance.
        albedo: Vec3,
    },
    /// Perfect specular reflection.
    Mirror {
        /// Reflected fraction of the radiance, no Fresnel factor.
        reflectance: Vec3,
    },
    /// Smooth dielectric with exact unpolarised Fresnel reflectance.
    Dielectric {
        /// Index of refraction relative to vacuum.
        ior: f32,
        /// Factor on reflected and transmitted radiance.
        tint: Vec3,
    },
}

/// A material: a lobe and what the surface emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Scattering lobe.
    pub lobe: Lobe,
    /// Emitted radiance, the same in all directions.
    pub emission: Vec3,
    /// True if the back of the surface (against its normal) emits as well.
    pub emits_both_sides: bool,
}

impl Default for Material {
    /// Diffuse grey of albedo 0.8, glTF's and Blender's look for "no material".
    fn default() -> Self {
        Self {
            lobe: Lobe::Diffuse { albedo: Vec3::splat(0.8) },
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
        matches!(self.lobe, Lobe::Diffuse { albedo } if albedo != Vec3::ZERO)
    }

    /// True if light from one direction leaves in one or two: a mirror, glass.
    pub fn is_specular(&self) -> bool {
        match self.lobe {
            Lobe::Diffuse { .. } => false,
            Lobe::Mirror { .. } | Lobe::Dielectric { .. } => true,
        }
    }

    /// True if light goes through.
    pub fn is_dielectric(&self) -> bool {
        matches!(self.lobe, Lobe::Dielectric { .. })
    }

    /// The colour that the albedo AOV shows.
    pub fn albedo(&self) -> Vec3 {
        match self.lobe {
            Lobe::Diffuse { albedo } => albedo,
            Lobe::Mirror { reflectance } => reflectance,
            Lobe::Dielectric { tint, .. } => tint,
        }
    }
}
