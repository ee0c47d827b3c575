//! Textures of glTF materials.

use glam::DVec2;
use gltf::json::texture::{MagFilter, Sampler, WrappingMode};
use gltf::json::validation::Checked;
use serde_json::Value;

use super::buffers::{Buffers, ImageSource};
use crate::asset::image::Encoding;
use crate::asset::textures::TextureTable;
use crate::shade::{Texture, TextureId, UvTransform, Wrap};

/// Sets of texture coordinates that are read.
pub(super) const UV_SETS: usize = 8;

/// The textures read so far.
pub(super) struct Textures<'a> {
    gltf: &'a gltf::Gltf,
    buffers: &'a Buffers<'a>,
    table: TextureTable<ImageSource<'a>>,
}

/// Reference of a material to a texture.
pub(super) struct TextureInfo<'a> {
    texture: gltf::Texture<'a>,
    uv_set: u32,
    transform: UvTransform,
}

impl<'a> TextureInfo<'a> {
    /// That of a texture without a type of its own.
    pub fn new(info: &gltf::texture::Info<'a>) -> Self {
        Self::moved(info.texture(), info.tex_coord(), info.extension_value("KHR_texture_transform"))
    }

    /// That of a normal map.
    pub fn of_normals(map: &gltf::material::NormalTexture<'a>) -> Self {
        Self::moved(map.texture(), map.tex_coord(), map.extension_value("KHR_texture_transform"))
    }

    /// A texture by a set of coordinates, under the values of KHR_texture_transform.
    pub fn moved(texture: gltf::Texture<'a>, uv_set: u32, values: Option<&Value>) -> Self {
        let pair = |key: &str, default: f64| {
            let pair = values.and_then(|values| values.get(key)?.as_array());
            let number = |index: usize| pair.and_then(|pair| pair.get(index)?.as_f64()).unwrap_or(default);
            DVec2::new(number(0), number(1))
        };
        let rotation = values.and_then(|values| values.get("rotation")?.as_f64()).unwrap_or(0.0);
        let own_set = values.and_then(|values| u32::try_from(values.get("texCoord")?.as_u64()?).ok());
        let transform = UvTransform::new(pair("scale", 1.0), rotation, pair("offset", 0.0));
        Self { texture, uv_set: own_set.unwrap_or(uv_set), transform }
    }
}

impl<'a> Textures<'a> {
    /// No image is decoded yet.
    pub fn new(gltf: &'a gltf::Gltf, buffers: &'a Buffers<'a>) -> Self {
        Self { gltf, buffers, table: TextureTable::default() }
    }

    /// The texture that a material refers to, or why there is none.
    pub fn read(&mut self, info: &TextureInfo, encoding: Encoding) -> Result<TextureId, String> {
        let source = info.texture.source().and_then(|image| ImageSource::of(self.gltf, &image));
        let source = source.ok_or_else(|| "it has no image of a kind that can be read".to_owned())?;
        let read = || self.buffers.image(source);
        let image = self.table.image(source, encoding, &self.buffers.memory(), read)?;
        let uv_set = usize::try_from(info.uv_set).ok().filter(|&set| set < UV_SETS);
        let uv_set =
            uv_set.ok_or_else(|| format!("only the sets 0 to {} of coordinates are read", UV_SETS - 1))?;
        let samplers = &self.gltf.document.as_json().samplers;
        let sampler = info.texture.sampler().index().and_then(|index| samplers.get(index));
        let (wrap, is_nearest) = sampler.map_or(([Wrap::Repeat; 2], false), filtering);
        Ok(self.table.add(Texture { image, uv_set, transform: info.transform, wrap, is_nearest }))
    }

    /// True if a texture is not opaque all over.
    pub fn has_alpha(&self, texture: TextureId) -> bool {
        self.table.has_alpha(texture)
    }

    /// All textures.
    pub fn into_textures(self) -> Vec<Texture> {
        self.table.into_textures()
    }
}

/// Wrapping and filter of a sampler, by its JSON, since the crate's accessors panic at values that nothing checks.
fn filtering(sampler: &Sampler) -> ([Wrap; 2], bool) {
    let wrap = [sampler.wrap_s, sampler.wrap_t].map(|mode| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    });
    (wrap, sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)))
}
