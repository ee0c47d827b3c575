//! Latitude-longitude pictures of any format, told by their first bytes, with pixels that can light a scene.

use std::path::Path;

use glam::Vec3;

use super::picture::Picture;
use super::{hdr, latlong_exr, raster};
use crate::asset::error::AssetError;
use crate::asset::exr::ExrFile;
use crate::asset::files::Files;
use crate::asset::flaw::Flaw;
use crate::asset::memory::Memory;
use crate::asset::notes::Notes;

/// Infinite pixels become this, the largest half-float: a sun stays bright without poisoning sums.
const BRIGHTEST_HALF: f32 = 65504.0;
/// Largest finite pixel: products with a strength stay finite in 32 bits.
const BRIGHTEST: f32 = 1e18;

/// Reads a picture: `.exr` and `.hdr` are linear; `.png` and `.jpg` are sRGB and are made linear.
///
/// Negative and NaN pixels become 0, infinite ones 65504, ones above 1e18 that, with a warning.
///
/// # Errors
/// The file cannot be read or decoded, has no pixels, has more than 2²⁹ of them or more than fit in memory.
pub fn load(path: &Path, files: &Files) -> Result<Picture, AssetError> {
    let bytes = AssetError::read(path, files)?;
    let mut notes = Notes::default();
    let decoded = decode(path, &bytes, &files.memory(), &mut notes);
    let mut picture = decoded.map_err(|flaw| AssetError::content(path, flaw))?;
    clean(&mut picture, &mut notes);
    picture.warnings = notes.into_lines(&path.display().to_string());
    Ok(picture)
}

/// Decodes a picture by its first bytes; one that begins as none does, by its name.
fn decode(path: &Path, bytes: &[u8], memory: &Memory, notes: &mut Notes) -> Result<Picture, Flaw> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if ExrFile::is_exr(bytes) || extension == "exr" {
        return latlong_exr::decode(bytes, memory, notes);
    }
    if hdr::is_hdr(bytes) || extension == "hdr" {
        return hdr::decode(bytes, memory, notes);
    }
    if raster::is_known(bytes) || ["png", "jpg", "jpeg"].contains(&extension.as_str()) {
        return raster::decode(bytes, memory);
    }
    Err(Flaw::new(
        format!("`.{extension}` is not a picture that can be read"),
        "use .exr, .hdr, .png or .jpg",
    ))
}

fn clean(picture: &mut Picture, notes: &mut Notes) {
    let mut changed = 0;
    for pixel in &mut picture.pixels {
        let clean = Vec3::from(pixel.to_array().map(|value| match value {
            value if value.is_nan() => 0.0,
            value if value.is_infinite() => {
                if value > 0.0 {
                    BRIGHTEST_HALF
                } else {
                    0.0
                }
            }
            value => value.clamp(0.0, BRIGHTEST),
        }));
        changed += usize::from(clean != *pixel);
        *pixel = clean;
    }
    if changed > 0 {
        notes.add("pixels that were negative or not finite are clamped", changed.to_string());
    }
    if picture.width != 2 * picture.height {
        let size = format!("{} × {}", picture.width, picture.height);
        notes.add("not twice as wide as high, so stretched as a latitude-longitude picture", size);
    }
}

#[cfg(test)]
mod tests {
    use exr::prelude as exr_file;

    use super::*;

    #[test]
    fn eight_bit_pictures_become_linear() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.PNG");
        image::RgbImage::from_fn(2, 1, |x, _| image::Rgb([128 * x as u8, 255, 0])).save(&path).unwrap();
        let picture = load(&path, &Files::default()).unwrap();
        assert_eq!((picture.width, picture.height), (2, 1));
        assert!((picture.pixels[1] - Vec3::new(0.2158605, 1.0, 0.0)).length() < 1e-6);
        assert!(picture.warnings.is_empty());
    }

    #[test]
    fn exr_pixels_that_are_not_finite_are_clamped_with_one_warning() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        let values = [(1.0f32, 2.0f32, 3.0f32), (f32::NAN, -1.0, f32::INFINITY)];
        exr_file::write_rgb_file(&path, 2, 1, |x, _| values[x]).unwrap();
        let picture = load(&path, &Files::default()).unwrap();
        assert_eq!(picture.pixels, [Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 0.0, BRIGHTEST_HALF)]);
        assert_eq!(picture.warnings.len(), 1);
        assert!(picture.warnings[0].ends_with("clamped: 1"), "{:?}", picture.warnings);
    }

    #[test]
    fn damaged_pictures_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.exr", "a.png", "a.hdr", "a.jpg", "a.tiff"] {
            let path = folder.path().join(name);
            std::fs::write(&path, b"\x76\x2f\x31\x01 not really").unwrap();
            assert!(load(&path, &Files::default()).is_err(), "{name}");
        }
    }
}
