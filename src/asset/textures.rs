//! Textures of a model, whose images are decoded once each.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::Arc;

use super::flaw::Flaw;
use super::image::{Encoding, texels};
use super::memory::Memory;
use crate::shade::{MipImage, Texture, TextureId};

/// Textures in the making; `K` names an image.
pub(super) struct TextureTable<K> {
    textures: Vec<Texture>,
    /// Or what is wrong with an image.
    images: HashMap<(K, Encoding), Result<Arc<MipImage>, String>>,
}

impl<K> Default for TextureTable<K> {
    fn default() -> Self {
        Self { textures: Vec::new(), images: HashMap::new() }
    }
}

impl<K: Eq + Hash> TextureTable<K> {
    /// An image, whose file `read` gives, or why there is none.
    pub fn image<B: AsRef<[u8]>>(
        &mut self,
        name: K,
        encoding: Encoding,
        memory: &Memory,
        read: impl FnOnce() -> Result<B, Flaw>,
    ) -> Result<Arc<MipImage>, String> {
        let decode = || texels(read()?.as_ref(), encoding, memory).map(Arc::new);
        let known = self.images.entry((name, encoding));
        known.or_insert_with(|| decode().map_err(|flaw| flaw.problem)).clone()
    }

    /// Adds a texture.
    pub fn add(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId((self.textures.len() - 1) as u32)
    }

    /// True if a texture is not opaque all over.
    pub fn has_alpha(&self, TextureId(id): TextureId) -> bool {
        self.textures[id as usize].image.has_alpha()
    }

    /// All textures.
    pub fn into_textures(self) -> Vec<Texture> {
        self.textures
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec4;

    use super::*;

    #[test]
    fn an_image_is_decoded_once_for_each_meaning_of_its_samples() {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_pixel(2, 1, image::Rgb([255, 188, 0]));
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let (mut table, memory) = (TextureTable::default(), Memory::default());
        let color = table.image("a", Encoding::Color, &memory, || Ok(bytes.get_ref())).unwrap();
        assert!((color.texel(0, [1, 0]) - Vec4::new(1.0, 0.5028865, 0.0, 1.0)).length() < 1e-6);
        let again =
            table.image("a", Encoding::Color, &memory, || -> Result<Vec<u8>, Flaw> { panic!("read again") });
        assert!(Arc::ptr_eq(&again.unwrap(), &color));
        let data = table.image("a", Encoding::Data, &memory, || Ok(bytes.get_ref())).unwrap();
        assert_eq!(data.texel(0, [1, 0]).y, 188.0 / 255.0);
        assert!(table.image("b", Encoding::Color, &memory, || Ok(b"no picture")).is_err());
    }
}
