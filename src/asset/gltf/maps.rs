//! Textures of a glTF material and its extensions.

use glam::Vec3;
use serde_json::Value;

use super::texture::{TextureInfo, Textures};
use crate::asset::image::Encoding;
use crate::asset::notes::Notes;
use crate::shade::{AnisotropyMap, FilmMap, Lobe, Maps, NormalMap, Principled, TextureId, VertexColors};

/// Reader of a material's textures.
pub(super) struct MapReader<'r, 'a> {
    pub gltf: &'a gltf::Gltf,
    pub material: &'r gltf::Material<'a>,
    pub textures: &'r mut Textures<'a>,
    pub notes: &'r mut Notes,
    /// Name of the material.
    pub name: &'r str,
    /// Thickness of a film where its texture is 0, nanometres.
    pub least_film: f32,
    /// Angle of the anisotropy from the tangent, radians.
    pub rotation: f32,
}

impl<'r, 'a> MapReader<'r, 'a> {
    /// Those that matter to a lobe, and to the emission if it is not black.
    pub fn read(&mut self, lobe: &Lobe, emits: bool) -> Maps {
        let pbr = self.material.pbr_metallic_roughness();
        let emission = self.material.emissive_texture().filter(|_| emits);
        let maps = Maps {
            base_color: self.plain("base colour", pbr.base_color_texture(), Encoding::Color),
            emission: self.plain("emission", emission, Encoding::Color),
            normal: self.normal(),
            vertex_colors: VertexColors::Nothing,
            ..Maps::default()
        };
        match lobe {
            Lobe::Principled(lobe) => self.layers(lobe, maps),
            Lobe::Diffuse(_) | Lobe::Mirror(_) | Lobe::Dielectric(_) | Lobe::Lacquered(_) => maps,
        }
    }

    /// Adds those of a lobe with its layers.
    fn layers(&mut self, lobe: &Principled, maps: Maps) -> Maps {
        let pbr = self.material.pbr_metallic_roughness();
        let metallic_roughness =
            self.plain("metal and roughness", pbr.metallic_roughness_texture(), Encoding::Data);
        let transmission = self.material.transmission().and_then(|clear| clear.transmission_texture());
        let transmission = transmission.filter(|_| lobe.transmission > 0.0);
        let (data, color) = (Encoding::Data, Encoding::Color);
        let transmission = self.plain("transmission", transmission, data);
        let is_coated = lobe.clearcoat > 0.0;
        let clearcoat_normal = if is_coated { self.clearcoat_normal() } else { None };
        let mut of = |is_used: bool, extension: &str, key: &str, encoding: Encoding| {
            if is_used { self.of_extension(extension, key, encoding) } else { None }
        };
        let is_opaque = lobe.metallic < 1.0 || metallic_roughness.is_some();
        let specular = "KHR_materials_specular";
        let (coat, sheen) = ("KHR_materials_clearcoat", "KHR_materials_sheen");
        let has_sheen = lobe.sheen_color != Vec3::ZERO;
        let (film, has_film) = ("KHR_materials_iridescence", lobe.iridescence > 0.0);
        Maps {
            metallic_roughness,
            specular: of(is_opaque, specular, "specularTexture", data),
            specular_color: of(is_opaque, specular, "specularColorTexture", color),
            transmission,
            clearcoat: of(is_coated, coat, "clearcoatTexture", data),
            clearcoat_roughness: of(is_coated, coat, "clearcoatRoughnessTexture", data),
            clearcoat_normal,
            sheen_color: of(has_sheen, sheen, "sheenColorTexture", color),
            sheen_roughness: of(has_sheen, sheen, "sheenRoughnessTexture", data),
            iridescence: of(has_film, film, "iridescenceTexture", data),
            film: of(has_film, film, "iridescenceThicknessTexture", data)
                .map(|texture| FilmMap { texture, range: [self.least_film, lobe.iridescence_thickness] }),
            anisotropy: (lobe.anisotropy > 0.0).then(|| self.anisotropy()),
            ..maps
        }
    }

    /// Normals of the coat.
    fn clearcoat_normal(&mut self) -> Option<NormalMap> {
        let (extension, key) = ("KHR_materials_clearcoat", "clearcoatNormalTexture");
        let texture = self.of_extension(extension, key, Encoding::Data)?;
        let scale = self.value(extension, key).and_then(|info| info.get("scale")?.as_f64());
        let scale = scale.map_or(1.0, |scale| scale as f32);
        scale.is_finite().then_some(NormalMap { texture, scale })
    }

    /// Direction of the anisotropy.
    fn anisotropy(&mut self) -> AnisotropyMap {
        let extension = "KHR_materials_anisotropy";
        let texture = self.of_extension(extension, "anisotropyTexture", Encoding::Data);
        let (sin, cos) = libm::sincosf(self.rotation);
        AnisotropyMap { texture, rotation: [sin, cos] }
    }

    /// A texture that the format itself has.
    fn plain(
        &mut self,
        kind: &str,
        info: Option<gltf::texture::Info<'a>>,
        encoding: Encoding,
    ) -> Option<TextureId> {
        self.texture(kind, &TextureInfo::new(&info?), encoding)
    }

    fn normal(&mut self) -> Option<NormalMap> {
        let map = self.material.normal_texture().filter(|map| map.scale().is_finite())?;
        let texture = self.texture("normal", &TextureInfo::of_normals(&map), Encoding::Data)?;
        Some(NormalMap { texture, scale: map.scale() })
    }

    /// A texture of an extension.
    fn of_extension(&mut self, extension: &str, key: &str, encoding: Encoding) -> Option<TextureId> {
        let info = self.value(extension, key)?;
        let number = |key: &str| info.get(key).and_then(Value::as_u64);
        let texture =
            number("index").and_then(|index| self.gltf.textures().nth(usize::try_from(index).ok()?));
        let Some(texture) = texture else {
            self.notes.add(format!("{key} is ignored (it names no texture), in material"), self.name);
            return None;
        };
        let uv_set = number("texCoord").map_or(0, |set| u32::try_from(set).unwrap_or(u32::MAX));
        let moved = info.get("extensions").and_then(|extensions| extensions.get("KHR_texture_transform"));
        let info = TextureInfo::moved(texture, uv_set, moved);
        self.texture(key, &info, encoding)
    }

    /// A texture; `None` if it cannot be used.
    fn texture(&mut self, kind: &str, info: &TextureInfo<'a>, encoding: Encoding) -> Option<TextureId> {
        let problem = |problem| format!("{kind} texture is ignored ({problem}), in material");
        let texture = self.textures.read(info, encoding);
        texture.map_err(|why| self.notes.add(problem(why), self.name)).ok()
    }

    fn value(&self, extension: &str, key: &str) -> Option<&'r Value> {
        let material: &'r gltf::Material<'a> = self.material;
        material.extension_value(extension)?.get(key)
    }
}
