//! Textures, of which the mean colour counts.

use glam::Vec3;

use super::buffers::{Buffers, ImageSource};
use crate::asset::mean_color::MeanColors;

/// Mean colours of textures, linear RGB.
pub(super) struct Textures<'a> {
    gltf: &'a gltf::Gltf,
    buffers: &'a Buffers<'a>,
    means: MeanColors<ImageSource<'a>>,
}

impl<'a> Textures<'a> {
    /// No image is decoded yet.
    pub fn new(gltf: &'a gltf::Gltf, buffers: &'a Buffers<'a>) -> Self {
        Self { gltf, buffers, means: MeanColors::default() }
    }

    /// The mean colour of a texture, or why there is none.
    pub fn of(&mut self, texture: &gltf::Texture) -> Result<Vec3, String> {
        let image = texture.source().and_then(|image| ImageSource::of(self.gltf, &image));
        let image = image.ok_or_else(|| "it has no image of a kind that can be read".to_owned())?;
        self.means.of(image, &self.buffers.memory(), || self.buffers.image(image))
    }
}
