//! Textures, of which the mean colour counts.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::buffers::{Buffers, ImageSource};
use crate::asset::image::decode_texture;

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
        let read =
            || self.buffers.image(image).and_then(|bytes| decode_texture(&bytes, &self.buffers.memory()));
        let mean = self.known.entry(image).or_insert_with(|| match read() {
            Ok(picture) => {
                let sum: DVec3 = picture.pixels.iter().map(|pixel| pixel.as_dvec3()).sum();
                Ok((sum / picture.pixels.len() as f64).as_vec3())
            }
            Err(flaw) => Err(flaw.problem),
        });
        mean.clone()
    }
}
