//! PNG and JPEG pictures, made linear.

use std::io::Cursor;

use glam::Vec3;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};

use super::picture::{BYTES_PER_PIXEL, Picture, check_size, undecodable};
use crate::asset::flaw::Flaw;
use crate::asset::memory::Memory;
use crate::shade::{MipImage, Raster};

/// Most memory of a picture while it is decoded, bytes per pixel: four channels of 16 bits.
const DECODED: u64 = 8;
/// The gamma of a PNG file that stands for sRGB.
const SRGB_GAMMA: f64 = 0.45455;
/// Bytes before the chunks of a PNG file.
const PNG_SIGNATURE: usize = 8;
/// Bytes of a chunk beside its data: length, kind and checksum.
const CHUNK_FRAME: usize = 12;
/// First bytes of a PNG file, up to its width and height.
const PNG_START: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR";

/// Bytes that chunks of a PNG file beside the pixels may take, such as a colour profile.
const BESIDE: u64 = 1 << 26;
/// Bytes per pixel of a row that decoding takes.
const ROWS: u64 = 64;

/// True if a file begins as a PNG or JPEG file does.
pub(super) fn is_known(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG") || bytes.starts_with(b"\xff\xd8\xff")
}

/// Decodes a PNG or JPEG file.
pub fn decode(bytes: &[u8], memory: &Memory) -> Result<Picture, Flaw> {
    let (decoded, transfer) = open(bytes, BYTES_PER_PIXEL, memory)?;
    Ok(Picture {
        width: decoded.width() as usize,
        height: decoded.height() as usize,
        pixels: colours(&decoded)
            .map(|colour| Vec3::from(colour.map(|value| transfer.linear(value))))
            .collect(),
        warnings: Vec::new(),
    })
}

/// Meaning of the samples of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Colours by the file's transfer function.
    Color,
    /// Numbers as they stand.
    Data,
}

/// Decodes a PNG or JPEG file for a texture: samples of 8 bits are kept.
pub fn texels(bytes: &[u8], encoding: Encoding, memory: &Memory) -> Result<MipImage, Flaw> {
    if !is_known(bytes) {
        return Err(Flaw::new("it is neither PNG nor JPEG", "convert it to PNG"));
    }
    let (decoded, transfer) = open(bytes, MipImage::BYTES_PER_TEXEL, memory)?;
    let linear = |value: f32| match encoding {
        Encoding::Color => transfer.linear(value),
        Encoding::Data => value,
    };
    let channels = usize::from(decoded.color().channel_count());
    let raster = if usize::from(decoded.color().bytes_per_pixel()) == channels {
        let table = Box::new(std::array::from_fn(|byte| linear(byte as f32 / f32::from(u8::MAX))));
        Raster::Encoded(with_alphas(decoded.as_bytes(), channels, u8::MAX), table)
    } else {
        let most = f32::from(u16::MAX);
        let table: Vec<u16> =
            (0..=u16::MAX).map(|v| (linear(f32::from(v) / most) * most).round() as u16).collect();
        let samples: Vec<u16> =
            decoded.as_bytes().as_chunks().0.iter().map(|&sample| u16::from_ne_bytes(sample)).collect();
        let texel = |[r, g, b, alpha]: [u16; 4]| {
            let [r, g, b] = [r, g, b].map(|value| table[usize::from(value)]);
            [r, g, b, alpha]
        };
        Raster::Linear(with_alphas(&samples, channels, u16::MAX).into_iter().map(texel).collect())
    };
    Ok(MipImage::new(decoded.width() as usize, decoded.height() as usize, raster))
}

/// Red, green, blue and opacity of pixels of one to four samples.
fn with_alphas<T: Copy>(samples: &[T], channels: usize, opaque: T) -> Vec<[T; 4]> {
    fn each<T: Copy, const N: usize>(samples: &[T], texel: impl Fn([T; N]) -> [T; 4]) -> Vec<[T; 4]> {
        samples.as_chunks().0.iter().map(|pixel| texel(*pixel)).collect()
    }
    match channels {
        1 => each(samples, |[grey]| [grey, grey, grey, opaque]),
        2 => each(samples, |[grey, alpha]| [grey, grey, grey, alpha]),
        3 => each(samples, |[r, g, b]| [r, g, b, opaque]),
        _ => each(samples, |texel| texel),
    }
}

/// Decodes the samples of a file for a picture of so many bytes per pixel, and tells what they mean.
fn open(bytes: &[u8], per_pixel: u64, memory: &Memory) -> Result<(DynamicImage, Transfer), Flaw> {
    // Before the crate sees it, which allocates rows.
    if let Some((width, height)) = png_size(bytes) {
        check_size(width, height, per_pixel + DECODED, memory)?;
    }
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(undecodable)?;
    let mut limits = image::Limits::no_limits();
    let width = png_size(bytes).map_or(0, |(width, _)| width as u64);
    limits.max_alloc = Some(BESIDE + ROWS * width);
    reader.limits(limits);
    let gamma = if reader.format() == Some(ImageFormat::Png) { png_gamma(bytes) } else { None };
    let mut decoder = reader.into_decoder().map_err(undecodable)?;
    let (width, height) = decoder.dimensions();
    check_size(width as usize, height as usize, per_pixel + DECODED, memory)?;
    decoder.set_limits(image::Limits::no_limits()).map_err(undecodable)?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(undecodable)?;
    Ok((decoded, gamma.map_or(Transfer::Srgb, Transfer::Gamma)))
}

/// Transfer function by which samples stand for light.
enum Transfer {
    /// IEC 61966-2-1.
    Srgb,
    /// A power, as a PNG file may tell.
    Gamma(f32),
}

impl Transfer {
    fn linear(&self, value: f32) -> f32 {
        match self {
            Self::Srgb if value <= 0.04045 => value / 12.92,
            Self::Srgb => libm::powf((value + 0.055) / 1.055, 2.4),
            Self::Gamma(gamma) => libm::powf(value, 1.0 / gamma),
        }
    }
}

/// Width and height of a PNG file.
fn png_size(bytes: &[u8]) -> Option<(usize, usize)> {
    let rest = bytes.strip_prefix(PNG_START)?;
    Some((number(rest, 0)?, number(rest, 4)?))
}

/// The gamma that a PNG file tells, unless it is that of sRGB or a better description overrides it.
fn png_gamma(bytes: &[u8]) -> Option<f32> {
    let mut rest = bytes.get(PNG_SIGNATURE..)?;
    let mut gamma = None;
    loop {
        let (length, kind) = (number(rest, 0)?, rest.get(4..8)?);
        match kind {
            b"sRGB" | b"iCCP" | b"cICP" => return None,
            b"gAMA" => gamma = number(rest, 8),
            b"IDAT" => break,
            _ => {}
        }
        rest = rest.get(length.checked_add(CHUNK_FRAME)?..)?;
    }
    let gamma = f64::from(u32::try_from(gamma?).ok()?) / 1e5;
    (gamma > 0.0 && (gamma - SRGB_GAMMA).abs() > 1e-3).then_some(gamma as f32)
}

/// A big-endian number of 32 bits.
fn number(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..at + 4)?.try_into().ok().map(|word| u32::from_be_bytes(word) as usize)
}

/// Red, green and blue of each pixel, 0 to 1.
fn colours(image: &DynamicImage) -> impl Iterator<Item = [f32; 3]> {
    let channels = usize::from(image.color().channel_count());
    let bytes = usize::from(image.color().bytes_per_pixel()) / channels;
    let value = move |sample: &[u8]| match *sample {
        [byte] => f32::from(byte) / f32::from(u8::MAX),
        [a, b] => f32::from(u16::from_ne_bytes([a, b])) / f32::from(u16::MAX),
        [a, b, c, d] => f32::from_ne_bytes([a, b, c, d]),
        _ => 0.0,
    };
    image.as_bytes().chunks_exact(channels * bytes).map(move |pixel| {
        let channel = |index: usize| value(&pixel[index * bytes..(index + 1) * bytes]);
        if channels < 3 { [channel(0); 3] } else { [0, 1, 2].map(channel) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn first_pixel(bytes: &[u8]) -> Vec3 {
        decode(bytes, &Memory::default()).unwrap().pixels[0]
    }

    /// `bytes` with a chunk behind the header chunk.
    fn with_chunk(bytes: &[u8], kind: &[u8], data: &[u8]) -> Vec<u8> {
        let checked: Vec<u8> = kind.iter().chain(data).copied().collect();
        let mut crc = u32::MAX;
        for byte in &checked {
            crc ^= u32::from(*byte);
            (0..8).for_each(|_| crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 });
        }
        let (head, tail) = bytes.split_at(33);
        [head, &(data.len() as u32).to_be_bytes(), &checked, &(!crc).to_be_bytes(), tail].concat()
    }

    #[test]
    fn grey_and_sixteen_bit_pictures_keep_their_values() {
        let grey = DynamicImage::ImageLuma16(image::ImageBuffer::from_pixel(2, 1, image::Luma([0x8000])));
        let pixel = first_pixel(&encoded(&grey, ImageFormat::Png));
        assert!((pixel - Vec3::splat(0.214_048_24)).length() < 1e-6, "{pixel}");
        let with_alpha =
            DynamicImage::ImageLumaA8(image::ImageBuffer::from_pixel(2, 1, image::LumaA([255, 7])));
        assert_eq!(first_pixel(&encoded(&with_alpha, ImageFormat::Png)), Vec3::ONE);
        let jpeg = encoded(
            &DynamicImage::ImageLuma8(image::ImageBuffer::from_pixel(8, 8, image::Luma([255]))),
            ImageFormat::Jpeg,
        );
        assert!((first_pixel(&jpeg) - Vec3::ONE).length() < 0.02);
    }

    #[test]
    fn texels_of_8_and_16_bits_are_the_linear_pixels() {
        let mixed = image::RgbImage::from_fn(16, 16, |x, y| {
            image::Rgb([(16 * x + y) as u8, 200, 255 * (x % 2) as u8])
        });
        let deep = DynamicImage::ImageRgb8(mixed.clone()).to_rgb16();
        for (image, tolerance) in
            [(DynamicImage::ImageRgb8(mixed), 0.0), (DynamicImage::ImageRgb16(deep), 8e-6)]
        {
            let bytes = encoded(&image, ImageFormat::Png);
            let pixels = decode(&bytes, &Memory::default()).unwrap().pixels;
            let texture = texels(&bytes, Encoding::Color, &Memory::default()).unwrap();
            let data = texels(&bytes, Encoding::Data, &Memory::default()).unwrap();
            for (index, pixel) in pixels.iter().enumerate() {
                let at = [index % 16, index / 16];
                let error = (texture.texel(0, at).truncate() - *pixel).abs().max_element();
                assert!(error <= tolerance && texture.texel(0, at).w == 1.0, "{error}");
                assert!((data.texel(0, at).y - 200.0 / 255.0).abs() < 1e-6);
            }
        }
        assert!(texels(b"no picture", Encoding::Color, &Memory::default()).is_err());
    }

    #[test]
    fn the_gamma_of_a_png_file_is_honoured() {
        let grey = DynamicImage::ImageLuma8(image::ImageBuffer::from_pixel(2, 1, image::Luma([51])));
        let plain = encoded(&grey, ImageFormat::Png);
        let linear = with_chunk(&plain, b"gAMA", &100_000u32.to_be_bytes());
        assert!((first_pixel(&linear) - Vec3::splat(0.2)).length() < 1e-6, "{}", first_pixel(&linear));
        let usual = with_chunk(&plain, b"gAMA", &45_455u32.to_be_bytes());
        assert_eq!(first_pixel(&usual), first_pixel(&plain));
    }

    #[test]
    fn a_header_of_mad_size_is_refused_before_the_rest_is_looked_at() {
        for (width, height) in [(u32::MAX, u32::MAX), (1 << 16, 1 << 16), (0, 5), (i32::MAX as u32, 1)] {
            let mut bytes = PNG_START.to_vec();
            bytes.extend([width.to_be_bytes(), height.to_be_bytes()].concat());
            bytes.extend([1, 0, 0, 0, 0, 0, 0, 0, 0]);
            let problem = decode(&bytes, &Memory::default()).unwrap_err().problem;
            assert!(problem.contains(&width.to_string()), "{problem}");
        }
    }
}
