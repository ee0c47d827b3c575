//! Textures, of which the mean colour counts.

use std::collections::HashMap;

use glam::Vec3;

use super::buffers::{Buffers, ImageSource};
use crate::asset::image::mean_colour;

/// Mean colours of images, linear RGB; each image is decoded once.
pub(super) struct MeanColours<'a> {
    gltf: &'a gltf::Gltf,
    buffers: &'a Buffers<'a>,
    /// Or what is wrong with the image.
    known: HashMap<ImageSource<'a>, Result<Vec3, String>>,
}

impl<'a> MeanColours<'a> {
    /// No image is decoded yet.
    pub fn new(gltf: &'a gltf::Gltf, buffers: &'a Buffers<'a>) -> Self {
        Self { gltf, buffers, known: HashMap::new() }
    }

    /// The mean colour of a texture, or why there is none.
    pub fn of(&mut self, texture: &gltf::Texture) -> Result<Vec3, String> {
        let image = texture.source().and_then(|image| ImageSource::of(self.gltf, &image));
        let image = image.ok_or_else(|| "it has no image of a kind that can be read".to_owned())?;
        let read = || {
            let bytes = self.buffers.image(image)?;
            mean_colour(&bytes, &self.buffers.memory())
        };
        self.known.entry(image).or_insert_with(|| read().map_err(|flaw| flaw.problem)).clone()
    }
}
