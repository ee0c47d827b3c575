//! Pictures of roughness and metal, which MTL has apart and a material in one texture.

use rayon::prelude::*;

use crate::asset::flaw::Flaw;
use crate::asset::memory::Memory;
use crate::shade::{MipImage, Raster};

/// Roughness in green and metal in blue, of the red channels of two pictures; one that is not there is 1 all over. The
/// picture is as large as the larger of both.
///
/// # Errors
/// There is not enough memory.
pub fn together(pictures: [Option<&MipImage>; 2], memory: &Memory) -> Result<MipImage, Flaw> {
    let sizes = pictures.map(|picture| picture.map_or([1, 1], |picture| picture.size(0)));
    let [width, height] = [0, 1].map(|axis| sizes[0][axis].max(sizes[1][axis]));
    let bytes = (width * height) as u64 * MipImage::BYTES_PER_TEXEL;
    memory.check(format!("a texture of {width} × {height} texels"), bytes)?;
    let value = |picture: Option<&MipImage>, x: usize, y: usize| {
        let Some(picture) = picture else { return u16::MAX };
        let [of_width, of_height] = picture.size(0);
        let texel = picture.texel(0, [x * of_width / width, y * of_height / height]);
        (texel.x * f32::from(u16::MAX)).round() as u16
    };
    let texel = |index: usize| {
        let [roughness, metal] = pictures.map(|picture| value(picture, index % width, index / width));
        [u16::MAX, roughness, metal, u16::MAX]
    };
    let texels = (0..width * height).into_par_iter().map(texel).collect();
    Ok(MipImage::new(width, height, Raster::Linear(texels)))
}
