//! glTF's metallic-roughness materials → the tracer's lobes.

use glam::Vec3;
use gltf::material::AlphaMode;

use super::factors::Factors;
use super::maps::MapReader;
use super::texture::Textures;
use crate::asset::notes::Notes;
use crate::shade::{Bsdf, Dielectric, Diffuse, Lobe, Maps, Material, Opacity, Principled, TextureChannel};

/// Opacity below which a masked surface is not there, where none is given.
const DEFAULT_CUTOFF: f32 = 0.5;
/// Largest emission, as in scene files.
const BRIGHTEST: f32 = 1e18;
/// Extension of materials that look the same in any light.
const UNLIT: &str = "KHR_materials_unlit";
/// Extensions of materials that are read here.
const READ: [&str; 10] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    UNLIT,
    "KHR_materials_volume",
];

/// The nearest material that the tracer has; what is lost goes to `notes`.
pub(super) fn convert<'a>(
    gltf: &'a gltf::Gltf,
    material: &gltf::Material<'a>,
    textures: &mut Textures<'a>,
    notes: &mut Notes,
) -> Material {
    let name = name_of(material);
    note_ignored(material, notes, &name);
    let pbr = material.pbr_metallic_roughness();
    let [r, g, b, alpha] = pbr.base_color_factor();
    let colour = Vec3::new(r, g, b);
    let base = Vec3::select(colour.is_nan_mask(), Vec3::ZERO, colour).clamp(Vec3::ZERO, Vec3::ONE);
    if base != colour {
        notes.add("colours outside 0..1 are clamped, in material", &name);
    }
    let emission = emission(material, notes, &name);
    let mut factors = Factors::new(material);
    let is_unlit = is_unlit(material);
    let black = Lobe::Diffuse(Diffuse { albedo: Vec3::ZERO });
    let lobe = if is_unlit { black } else { lobe(&mut factors, base, notes, &name) };
    let attenuation = factors.attenuation();
    let (least_film, rotation) = (factors.least_film(), factors.anisotropy_rotation());
    if factors.is_clamped {
        notes.add("numbers outside of what the format allows are clamped, in material", &name);
    }
    let maps = MapReader { gltf, material, textures, notes, name: &name, least_film, rotation }
        .read(&lobe, emission != Vec3::ZERO && !is_unlit);
    let cutoff = match material.alpha_mode() {
        AlphaMode::Opaque => None,
        AlphaMode::Mask => Some(Some(material.alpha_cutoff().unwrap_or(DEFAULT_CUTOFF))),
        AlphaMode::Blend => Some(None),
    };
    let opacity = cutoff.map(|cutoff| Opacity {
        factor: if alpha.is_nan() { 1.0 } else { alpha.clamp(0.0, 1.0) },
        map: maps.base_color.filter(|map| textures.has_alpha(*map)).map(|map| (map, TextureChannel::Alpha)),
        by_vertices: false,
        cutoff,
    });
    if is_unlit {
        let maps = Maps { emission: maps.base_color, ..Maps::default() };
        return Material { lobe, emission: base, maps, opacity, ..Material::default() };
    }
    let emits_both_sides = material.double_sided();
    Material { lobe, attenuation, emission, emits_both_sides, maps, opacity }.with_coat_apart()
}

/// True if a material looks the same in any light: it emits its base colour, and reflects nothing.
pub(super) fn is_unlit(material: &gltf::Material) -> bool {
    material.extension_value(UNLIT).is_some()
}

fn name_of(material: &gltf::Material) -> String {
    match (material.name(), material.index()) {
        (Some(name), _) => name.to_owned(),
        (None, Some(index)) => format!("material {index}"),
        (None, None) => "the default material".to_owned(),
    }
}

fn emission(material: &gltf::Material, notes: &mut Notes, name: &str) -> Vec3 {
    let factor = Vec3::from(material.emissive_factor()) * material.emissive_strength().unwrap_or(1.0);
    if factor == Vec3::ZERO {
        return Vec3::ZERO;
    }
    if factor.is_nan() || factor.cmplt(Vec3::ZERO).any() {
        notes.add("emission that is negative or not a number is ignored, in material", name);
        return Vec3::ZERO;
    }
    if factor.max_element() > BRIGHTEST {
        notes.add("emission above 1e18 is clamped, in material", name);
    }
    factor.min(Vec3::splat(BRIGHTEST))
}

/// The lobe of a material: the simplest of those that scatter alike.
fn lobe(factors: &mut Factors, base: Vec3, notes: &mut Notes, name: &str) -> Lobe {
    let lobe = factors.principled(base);
    let Principled { ior, roughness, is_thin, .. } = lobe;
    let is_lambertian =
        lobe.metallic == 0.0 && Principled { base: Vec3::ZERO, ..lobe }.albedo() == Vec3::ZERO;
    if is_lambertian && lobe.transmission == 0.0 {
        return Lobe::Diffuse(Diffuse { albedo: base });
    }
    let clear = Principled { roughness, ior, is_thin, transmission: 1.0, ..Principled::PLAIN };
    if lobe == clear && roughness == 0.0 && !is_thin && !factors.is_transmission_mapped() {
        return Lobe::Dielectric(Dielectric { ior, tint: Vec3::ONE });
    }
    if lobe.transmission > 0.0 && is_thin {
        let kind =
            "glass without KHR_materials_volume is a wall without thickness, light is not bent, in material";
        notes.add(kind, name);
    }
    Lobe::Principled(lobe)
}

fn note_ignored(material: &gltf::Material, notes: &mut Notes, name: &str) {
    if material.occlusion_texture().is_some() {
        notes.add("occlusion texture is ignored, since light is traced, in material", name);
    }
    let extensions = material.extensions().into_iter().flat_map(|map| map.keys());
    for extension in extensions.filter(|extension| !READ.contains(&extension.as_str())) {
        notes.add(format!("extension {extension} is ignored, in material"), name);
    }
}
