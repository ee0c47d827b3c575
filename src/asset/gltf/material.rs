//! glTF's metallic-roughness materials → the tracer's lobes.

use glam::{DVec3, Vec3};

use super::buffers::Buffers;
use crate::asset::image::decode_texture;
use crate::asset::notes::Notes;
use crate::shade::{Lobe, Material};

/// Largest roughness that counts as a perfect mirror or clear glass.
const SMOOTH: f32 = 0.05;
/// Index of refraction without `KHR_materials_ior`.
const DEFAULT_IOR: f32 = 1.5;
/// Extensions of materials that are read here.
const READ: [&str; 4] = [
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_specular",
];

/// The nearest material that the tracer has; what is lost goes to `notes`.
pub(super) fn convert(material: &gltf::Material, buffers: &Buffers, notes: &mut Notes) -> Material {
    let name = name_of(material);
    note_ignored(material, notes, &name);
    let [r, g, b, _] = material.pbr_metallic_roughness().base_color_factor();
    let colour = Vec3::new(r, g, b) * texture_mean(material, buffers, notes, &name);
    let base = Vec3::select(colour.is_nan_mask(), Vec3::ZERO, colour).clamp(Vec3::ZERO, Vec3::ONE);
    if base != colour {
        notes.add("colours outside 0..1 are clamped, in material", &name);
    }
    let emission = Vec3::from(material.emissive_factor()) * material.emissive_strength().unwrap_or(1.0);
    let usable = emission.is_finite() && emission.cmpge(Vec3::ZERO).all();
    if !usable {
        notes.add("emission that is negative or not finite is ignored, in material", &name);
    }
    Material {
        lobe: lobe(material, base, notes, &name),
        emission: if usable { emission } else { Vec3::ZERO },
        emits_both_sides: material.double_sided(),
    }
}

fn name_of(material: &gltf::Material) -> String {
    match (material.name(), material.index()) {
        (Some(name), _) => name.to_owned(),
        (None, Some(index)) => format!("material {index}"),
        (None, None) => "the default material".to_owned(),
    }
}

/// Mean of the base colour texture, white without one: walls and floors then reflect the right amount of light.
fn texture_mean(material: &gltf::Material, buffers: &Buffers, notes: &mut Notes, name: &str) -> Vec3 {
    let Some(texture) = material.pbr_metallic_roughness().base_color_texture() else {
        return Vec3::ONE;
    };
    let image = texture.texture().source();
    match buffers.image(&image).and_then(|bytes| decode_texture(&bytes, &buffers.memory())) {
        Ok(picture) => {
            notes.add("base colour texture is replaced by its mean, in material", name);
            let sum: DVec3 = picture.pixels.iter().map(|pixel| pixel.as_dvec3()).sum();
            (sum / picture.pixels.len() as f64).as_vec3()
        }
        Err(flaw) => {
            notes.add(format!("base colour texture is ignored ({}), in material", flaw.problem), name);
            Vec3::ONE
        }
    }
}

fn lobe(material: &gltf::Material, base: Vec3, notes: &mut Notes, name: &str) -> Lobe {
    let pbr = material.pbr_metallic_roughness();
    let smooth = pbr.roughness_factor() <= SMOOTH;
    let glass = material.transmission().is_some_and(|glass| glass.transmission_factor() >= 0.5);
    let metal = pbr.metallic_factor() >= 0.5;
    match (metal, glass, smooth) {
        (true, _, true) => return Lobe::Mirror { reflectance: base },
        (false, true, true) => {
            let ior = material.ior().filter(|ior| ior.is_finite() && *ior >= 1.0).unwrap_or(DEFAULT_IOR);
            return Lobe::Dielectric { ior, tint: base };
        }
        (true, ..) => notes.add("rough metal becomes diffuse, in material", name),
        (false, true, false) => notes.add("rough glass becomes diffuse, in material", name),
        (false, false, _) if specular_factor(material) > 0.0 => {
            notes.add("gloss on a non-metal is left out, in material", name);
        }
        (false, false, _) => {}
    }
    Lobe::Diffuse { albedo: base }
}

/// Strength of a non-metal's reflection; 0 makes the material an exact Lambertian.
fn specular_factor(material: &gltf::Material) -> f64 {
    let extension = material.extension_value("KHR_materials_specular");
    extension.and_then(|values| values.get("specularFactor")?.as_f64()).unwrap_or(1.0)
}

fn note_ignored(material: &gltf::Material, notes: &mut Notes, name: &str) {
    let pbr = material.pbr_metallic_roughness();
    let transmission = material.transmission().is_some_and(|glass| glass.transmission_texture().is_some());
    let textures = [
        ("metal and roughness", pbr.metallic_roughness_texture().is_some()),
        ("normal", material.normal_texture().is_some()),
        ("occlusion", material.occlusion_texture().is_some()),
        ("emission", material.emissive_texture().is_some()),
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
