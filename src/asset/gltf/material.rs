//! glTF's metallic-roughness materials → the tracer's lobes.

use glam::Vec3;

use super::factors::Factors;
use super::texture::Textures;
use crate::asset::notes::Notes;
use crate::shade::{Bsdf, Dielectric, Diffuse, Lobe, Material, Principled};

/// Largest emission, as in scene files.
const BRIGHTEST: f32 = 1e18;
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
    "KHR_materials_unlit",
    "KHR_materials_volume",
];

/// The nearest material that the tracer has; what is lost goes to `notes`.
pub(super) fn convert(material: &gltf::Material, textures: &mut Textures, notes: &mut Notes) -> Material {
    let name = name_of(material);
    note_ignored(material, notes, &name);
    let pbr = material.pbr_metallic_roughness();
    let [r, g, b, _] = pbr.base_color_factor();
    let texture = pbr.base_color_texture().map(|info| info.texture());
    let colour = Vec3::new(r, g, b) * mean("base colour", texture, textures, notes, &name);
    let base = Vec3::select(colour.is_nan_mask(), Vec3::ZERO, colour).clamp(Vec3::ZERO, Vec3::ONE);
    if base != colour {
        notes.add("colours outside 0..1 are clamped, in material", &name);
    }
    if material.extension_value("KHR_materials_unlit").is_some() {
        let lobe = Lobe::Diffuse(Diffuse { albedo: Vec3::ZERO });
        notes.add("unlit surfaces emit their base colour, and so light what is around, in material", &name);
        return Material { lobe, emission: base, ..Material::default() };
    }
    let emission = emission(material, textures, notes, &name);
    let mut factors = Factors::new(material);
    let (lobe, attenuation) = (lobe(&mut factors, base, notes, &name), factors.attenuation());
    if factors.is_clamped {
        notes.add("numbers outside of what the format allows are clamped, in material", &name);
    }
    Material { lobe, attenuation, emission, emits_both_sides: material.double_sided() }
}

fn name_of(material: &gltf::Material) -> String {
    match (material.name(), material.index()) {
        (Some(name), _) => name.to_owned(),
        (None, Some(index)) => format!("material {index}"),
        (None, None) => "the default material".to_owned(),
    }
}

/// Mean of a texture, white without one: walls, floors and lamps then give the right amount of light.
fn mean(
    kind: &str,
    texture: Option<gltf::Texture>,
    textures: &mut Textures,
    notes: &mut Notes,
    name: &str,
) -> Vec3 {
    match texture.map(|texture| textures.of(&texture)) {
        None => Vec3::ONE,
        Some(Ok(mean)) => {
            notes.add(format!("{kind} texture is replaced by its mean, in material"), name);
            mean
        }
        Some(Err(problem)) => {
            notes.add(format!("{kind} texture is ignored ({problem}), in material"), name);
            Vec3::ONE
        }
    }
}

fn emission(material: &gltf::Material, textures: &mut Textures, notes: &mut Notes, name: &str) -> Vec3 {
    let factor = Vec3::from(material.emissive_factor()) * material.emissive_strength().unwrap_or(1.0);
    if factor == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let texture = material.emissive_texture().map(|info| info.texture());
    let emission = factor * mean("emission", texture, textures, notes, name);
    if emission.is_nan() || emission.cmplt(Vec3::ZERO).any() {
        notes.add("emission that is negative or not a number is ignored, in material", name);
        return Vec3::ZERO;
    }
    if emission.max_element() > BRIGHTEST {
        notes.add("emission above 1e18 is clamped, in material", name);
    }
    emission.min(Vec3::splat(BRIGHTEST))
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
    if lobe == clear && roughness == 0.0 && !is_thin {
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
    let pbr = material.pbr_metallic_roughness();
    let transmission = material.transmission().is_some_and(|glass| glass.transmission_texture().is_some());
    let textures = [
        ("metal and roughness", pbr.metallic_roughness_texture().is_some()),
        ("normal", material.normal_texture().is_some()),
        ("occlusion", material.occlusion_texture().is_some()),
        ("transmission", transmission),
    ];
    for (kind, _) in textures.iter().filter(|(_, present)| *present) {
        notes.add(format!("{kind} texture is ignored, in material"), name);
    }
    if material.alpha_mode() != gltf::material::AlphaMode::Opaque {
        notes.add("opacity is ignored, in material", name);
    }
    let extensions = material.extensions().into_iter().flat_map(|map| map.keys());
    for extension in extensions.filter(|extension| !READ.contains(&extension.as_str())) {
        notes.add(format!("extension {extension} is ignored, in material"), name);
    }
}
