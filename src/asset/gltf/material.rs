//! glTF's metallic-roughness materials → the tracer's lobes.

use glam::Vec3;
use gltf::material::AlphaMode;

use super::texture::{TextureInfo, Textures};
use crate::asset::image::Encoding;
use crate::asset::notes::Notes;
use crate::shade::{
    Dielectric, Diffuse, Lobe, Maps, Material, Mirror, NormalMap, Opacity, TextureChannel, TextureId,
    VertexColors,
};

/// Largest roughness that counts as a perfect mirror or clear glass.
const SMOOTH: f32 = 0.05;
/// Index of refraction without `KHR_materials_ior`.
const DEFAULT_IOR: f32 = 1.5;
/// Opacity below which a masked surface is not there, where none is given.
const DEFAULT_CUTOFF: f32 = 0.5;
/// Largest emission, as in scene files.
const BRIGHTEST: f32 = 1e18;
/// Extension of materials that look the same in any light.
const UNLIT: &str = "KHR_materials_unlit";
/// Extensions of materials that are read here.
const READ: [&str; 5] = [
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_specular",
    UNLIT,
];

/// The nearest material that the tracer has; what is lost goes to `notes`.
pub(super) fn convert(material: &gltf::Material, textures: &mut Textures, notes: &mut Notes) -> Material {
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
    let mut map = |kind: &str, info: Option<gltf::texture::Info>| {
        info.and_then(|info| color_map(kind, &info, textures, notes, &name))
    };
    let maps = Maps {
        base_color: map("base colour", pbr.base_color_texture()),
        emission: map("emission", material.emissive_texture().filter(|_| emission != Vec3::ZERO)),
        normal: normal_map(material, textures, notes, &name),
        vertex_colors: VertexColors::Nothing,
    };
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
    if is_unlit(material) {
        let lobe = Lobe::Diffuse(Diffuse { albedo: Vec3::ZERO });
        let maps = Maps { emission: maps.base_color, ..Maps::default() };
        return Material { lobe, emission: base, emits_both_sides: true, maps, opacity };
    }
    Material {
        lobe: lobe(material, base, notes, &name),
        emission,
        emits_both_sides: material.double_sided(),
        maps,
        opacity,
    }
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

/// A texture of colours; `None` if it cannot be used.
fn color_map(
    kind: &str,
    info: &gltf::texture::Info,
    textures: &mut Textures,
    notes: &mut Notes,
    name: &str,
) -> Option<TextureId> {
    let texture = textures.read(&TextureInfo::new(info), Encoding::Color);
    texture
        .map_err(|problem| notes.add(format!("{kind} texture is ignored ({problem}), in material"), name))
        .ok()
}

fn normal_map(
    material: &gltf::Material,
    textures: &mut Textures,
    notes: &mut Notes,
    name: &str,
) -> Option<NormalMap> {
    let map = material.normal_texture().filter(|map| map.scale().is_finite())?;
    match textures.read(&TextureInfo::of_normals(&map), Encoding::Data) {
        Ok(texture) => Some(NormalMap { texture, scale: map.scale() }),
        Err(problem) => {
            notes.add(format!("normal texture is ignored ({problem}), in material"), name);
            None
        }
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

fn lobe(material: &gltf::Material, base: Vec3, notes: &mut Notes, name: &str) -> Lobe {
    let pbr = material.pbr_metallic_roughness();
    let smooth = pbr.roughness_factor() <= SMOOTH;
    let glass = material.transmission().is_some_and(|glass| glass.transmission_factor() >= 0.5);
    let metal = pbr.metallic_factor() >= 0.5;
    match (metal, glass, smooth) {
        (true, _, true) => return Lobe::Mirror(Mirror { reflectance: base }),
        (false, true, true) => {
            let ior = material.ior().filter(|ior| ior.is_finite() && *ior >= 1.0).unwrap_or(DEFAULT_IOR);
            return Lobe::Dielectric(Dielectric { ior, tint: base });
        }
        (true, ..) => notes.add("rough metal becomes diffuse, in material", name),
        (false, true, false) => notes.add("rough glass becomes diffuse, in material", name),
        (false, false, _) if specular_factor(material) > 0.0 => {
            notes.add("gloss on a non-metal is left out, in material", name);
        }
        (false, false, _) => {}
    }
    Lobe::Diffuse(Diffuse { albedo: base })
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
        ("occlusion", material.occlusion_texture().is_some()),
        ("transmission", transmission),
    ];
    for (kind, _) in textures.iter().filter(|(_, present)| *present) {
        notes.add(format!("{kind} texture is ignored, in material"), name);
    }
    let extensions = material.extensions().into_iter().flat_map(|map| map.keys());
    for extension in extensions.filter(|extension| !READ.contains(&extension.as_str())) {
        notes.add(format!("extension {extension} is ignored, in material"), name);
    }
}
