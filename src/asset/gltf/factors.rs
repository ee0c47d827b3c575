//! Numbers of a glTF material and its extensions.

use glam::Vec3;

use crate::shade::{Principled, attenuation};

/// Range of fractions.
const UNIT: (f32, f32) = (0.0, 1.0);
/// Index of refraction without `KHR_materials_ior`.
const DEFAULT_IOR: f32 = 1.5;
/// Largest index of refraction.
const MOST_IOR: f32 = 100.0;
/// Distances at which the colour of a volume is seen.
const DISTANCES: (f32, f32) = (1e-18, f32::INFINITY);
/// Thickness of the thickest film, nanometres: above, colours of films are grey.
const THICKEST_FILM: f32 = 1e6;

/// Reader of a material's numbers.
pub(super) struct Factors<'a> {
    material: &'a gltf::Material<'a>,
    /// True if one was not in its range.
    pub is_clamped: bool,
}

impl<'a> Factors<'a> {
    /// A reader.
    pub fn new(material: &'a gltf::Material<'a>) -> Self {
        Self { material, is_clamped: false }
    }

    /// The lobe that all of them describe, with this base colour.
    pub fn principled(&mut self, base: Vec3) -> Principled {
        let pbr = self.material.pbr_metallic_roughness();
        let transmission = self.material.transmission().map_or(0.0, |clear| clear.transmission_factor());
        let ior = self.material.ior().unwrap_or(DEFAULT_IOR);
        Principled {
            base,
            metallic: self.clamped(pbr.metallic_factor(), UNIT, 1.0),
            roughness: self.clamped(pbr.roughness_factor(), UNIT, 1.0),
            anisotropy: self.number("KHR_materials_anisotropy", "anisotropyStrength", 0.0, UNIT),
            ior: self.clamped(ior, (1.0, MOST_IOR), DEFAULT_IOR),
            specular: self.number("KHR_materials_specular", "specularFactor", 1.0, UNIT),
            specular_color: self.colour("KHR_materials_specular", "specularColorFactor", Vec3::ONE, f32::MAX),
            transmission: self.clamped(transmission, UNIT, 0.0),
            is_thin: !self.has_volume(),
            clearcoat: self.number("KHR_materials_clearcoat", "clearcoatFactor", 0.0, UNIT),
            clearcoat_roughness: self.number(
                "KHR_materials_clearcoat",
                "clearcoatRoughnessFactor",
                0.0,
                UNIT,
            ),
            sheen_color: self.colour("KHR_materials_sheen", "sheenColorFactor", Vec3::ZERO, 1.0),
            sheen_roughness: self.number("KHR_materials_sheen", "sheenRoughnessFactor", 0.0, UNIT),
            iridescence: self.number("KHR_materials_iridescence", "iridescenceFactor", 0.0, UNIT),
            iridescence_ior: self.number("KHR_materials_iridescence", "iridescenceIor", 1.3, (1.0, MOST_IOR)),
            iridescence_thickness: self.number(
                "KHR_materials_iridescence",
                "iridescenceThicknessMaximum",
                400.0,
                (0.0, THICKEST_FILM),
            ),
            ..Principled::PLAIN
        }
    }

    /// Thickness of a film where its texture is 0, nanometres.
    pub fn least_film(&mut self) -> f32 {
        self.number("KHR_materials_iridescence", "iridescenceThicknessMinimum", 100.0, (0.0, THICKEST_FILM))
    }

    /// Angle of the anisotropy from the tangent, radians counter-clockwise.
    pub fn anisotropy_rotation(&mut self) -> f32 {
        self.number("KHR_materials_anisotropy", "anisotropyRotation", 0.0, (f32::MIN, f32::MAX))
    }

    /// Share of light that the volume inside absorbs per length, if that is short; nothing if there is no volume.
    pub fn attenuation(&mut self) -> Vec3 {
        let colour = self.colour("KHR_materials_volume", "attenuationColor", Vec3::ONE, 1.0);
        let distance = self.number("KHR_materials_volume", "attenuationDistance", f32::INFINITY, DISTANCES);
        if self.has_volume() { attenuation(colour, distance) } else { Vec3::ZERO }
    }

    /// True if a texture tells where light goes through.
    pub fn is_transmission_mapped(&self) -> bool {
        self.material.transmission().is_some_and(|clear| clear.transmission_texture().is_some())
    }

    /// True if the surface encloses a volume.
    fn has_volume(&mut self) -> bool {
        self.number("KHR_materials_volume", "thicknessFactor", 0.0, (0.0, f32::MAX)) > 0.0
    }

    fn number(&mut self, extension: &str, key: &str, default: f32, range: (f32, f32)) -> f32 {
        let value = self.material.extension_value(extension).and_then(|values| values.get(key)?.as_f64());
        value.map_or(default, |value| self.clamped(value as f32, range, default))
    }

    fn colour(&mut self, extension: &str, key: &str, default: Vec3, most: f32) -> Vec3 {
        let values = self.material.extension_value(extension).and_then(|values| values.get(key)?.as_array());
        let Some([r, g, b]) = values.map(Vec::as_slice) else { return default };
        let [r, g, b] = [(r, 0), (g, 1), (b, 2)].map(|(value, channel): (&serde_json::Value, usize)| {
            let value = value.as_f64().map_or(default[channel], |value| value as f32);
            self.clamped(value, (0.0, most), default[channel])
        });
        Vec3::new(r, g, b)
    }

    fn clamped(&mut self, value: f32, (least, most): (f32, f32), default: f32) -> f32 {
        let clamped = if value.is_nan() { default } else { value.clamp(least, most) };
        self.is_clamped |= clamped != value;
        clamped
    }
}
