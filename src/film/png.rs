//! PNG preview of a picture, tone-mapped.

use std::io::{self, Write};

use glam::Vec3;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::image::{BEAUTY, Image};
use super::tone::to_srgb8;

/// Writes the data window of `image` as 8-bit sRGB, made brighter by `exposure` stops and tone mapped; with alpha if
/// the background is `transparent`, else opaque.
///
/// Colours are premultiplied, so that leaving alpha out shows them over black. A PNG with alpha holds them divided by
/// it.
///
/// # Errors
/// Errors of `out`, and [`io::ErrorKind::InvalidData`] if the image has no `R`, `G`, `B` or is too large for a PNG.
pub fn write_png(image: &Image, exposure: f64, transparent: bool, out: impl Write) -> io::Result<()> {
    let [Some(red), Some(green), Some(blue), Some(alpha)] = BEAUTY.map(|name| image.channel(name)) else {
        return Err(invalid("the picture has no colour channels"));
    };
    if !image.is_consistent() {
        return Err(invalid("the channels do not fill the data window"));
    }
    let gain = libm::exp2(exposure) as f32;
    let colors = red.iter().zip(green).zip(blue).map(|((&r, &g), &b)| Vec3::new(r, g, b));
    if transparent {
        let pixels = colors.zip(alpha).map(|(color, &alpha)| {
            // Without alpha there is nothing to be seen, and 0/0 is black.
            let [r, g, b] = to_srgb8(color / alpha, gain);
            [r, g, b, (255.0 * alpha).round() as u8]
        });
        write_pixels(&pixels.collect::<Vec<_>>(), image.size, ExtendedColorType::Rgba8, out)
    } else {
        let pixels: Vec<[u8; 3]> = colors.map(|color| to_srgb8(color, gain)).collect();
        write_rgb8(&pixels, image.size, out)
    }
}

/// Writes `pixels`, 8-bit sRGB row by row, of a picture of `size` as they are.
///
/// # Errors
/// Errors of `out`, and [`io::ErrorKind::InvalidData`] if `pixels` do not fill `size` or are too many for a PNG.
pub fn write_rgb8(pixels: &[[u8; 3]], size: (usize, usize), out: impl Write) -> io::Result<()> {
    write_pixels(pixels, size, ExtendedColorType::Rgb8, out)
}

fn write_pixels<const CHANNELS: usize>(
    pixels: &[[u8; CHANNELS]],
    size: (usize, usize),
    color: ExtendedColorType,
    out: impl Write,
) -> io::Result<()> {
    let (Ok(width), Ok(height)) = (u32::try_from(size.0), u32::try_from(size.1)) else {
        return Err(invalid("the picture is too large for a PNG"));
    };
    if pixels.len() != size.0 * size.1 {
        return Err(invalid("the pixels do not fill the picture"));
    }
    let encoder = PngEncoder::new(out);
    encoder.write_image(pixels.as_flattened(), width, height, color).map_err(|error| match error {
        ImageError::IoError(error) => error,
        other => io::Error::other(other),
    })
}

fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::image::Channel;

    fn picture(values: [f32; 2]) -> Image {
        Image {
            width: 9,
            height: 9,
            origin: (3, 4),
            size: (2, 1),
            channels: BEAUTY.map(|name| Channel { name: name.to_owned(), values: values.to_vec() }).to_vec(),
            attributes: Vec::new(),
        }
    }

    fn decoded(values: [f32; 2], exposure: f64) -> image::RgbImage {
        let mut bytes = Vec::new();
        write_png(&picture(values), exposure, false, &mut bytes).unwrap();
        let image = image::load_from_memory(&bytes).unwrap();
        assert_eq!(image.color(), image::ColorType::Rgb8);
        image.to_rgb8()
    }

    #[test]
    fn the_preview_shows_the_data_window_in_srgb() {
        let image = decoded([0.214_041, 0.0], 0.0);
        assert_eq!(image.dimensions(), (2, 1));
        assert_eq!(image.get_pixel(0, 0).0, [127; 3]);
        assert_eq!(image.get_pixel(1, 0).0, [0; 3]);
    }

    #[test]
    fn a_stop_doubles() {
        assert_eq!(decoded([0.1, 0.2], 1.0).get_pixel(0, 0), decoded([0.1, 0.2], 0.0).get_pixel(1, 0));
    }

    #[test]
    fn a_transparent_preview_holds_straight_colours_and_their_alpha() {
        let mut image = picture([0.25, 0.0]);
        for (plane, value) in image.channels.iter_mut().zip([0.107_020_5, 0.0, 0.107_020_5, 0.5]) {
            plane.values[0] = value;
        }
        let mut bytes = Vec::new();
        write_png(&image, 0.0, true, &mut bytes).unwrap();
        let image = image::load_from_memory(&bytes).unwrap();
        assert_eq!(image.color(), image::ColorType::Rgba8);
        let image = image.to_rgba8();
        assert_eq!((image.get_pixel(0, 0).0, image.get_pixel(1, 0).0), ([127, 0, 127, 128], [0; 4]));
    }

    #[test]
    fn a_picture_without_colour_is_refused() {
        let mut image = picture([0.0; 2]);
        image.channels.remove(1);
        assert!(write_png(&image, 0.0, false, Vec::new()).is_err());
    }
}
