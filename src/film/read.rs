//! Reading an OpenEXR file back into an image.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use exr::image::{AnyChannels, FlatSamples, Layer};
use exr::meta::attribute::{AttributeValue, IntegerBounds};
use exr::prelude::{ReadChannels, ReadLayers};

use super::exr::ATTRIBUTE_PREFIX;
use super::{Aov, BEAUTY, Image, Plane};

/// Why an EXR could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// Missing, unreadable, damaged, or a kind of EXR that holds no plain picture.
    #[error("cannot read `{}`: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: exr::error::Error,
    },
    /// The data window reaches beyond the display window.
    #[error("cannot read `{}`: its data window lies outside its display window", path.display())]
    Window {
        /// The file.
        path: PathBuf,
    },
}

/// Reads the first layer of the EXR at `path`, all channels widened to f32.
///
/// Planes come in the order in which a render makes them, whatever the order in the file; unknown channels come last.
/// Attributes are those that [`super::write_exr`] wrote, sorted by name.
///
/// # Errors
/// See [`ReadError`].
pub fn read_exr(path: &Path) -> Result<Image, ReadError> {
    let file = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|source| ReadError::File { path: path.to_owned(), source })?;
    let window = file.attributes.display_window;
    let layer = file.layer_data;
    let origin = origin_within(&layer, window).ok_or_else(|| ReadError::Window { path: path.to_owned() })?;
    Ok(Image {
        width: window.size.width(),
        height: window.size.height(),
        origin,
        size: (layer.size.width(), layer.size.height()),
        attributes: attributes(&layer),
        planes: planes(layer.channel_data),
    })
}

/// Where the data window starts within the display window, if it lies within.
fn origin_within(layer: &Layer<AnyChannels<FlatSamples>>, window: IntegerBounds) -> Option<(usize, usize)> {
    let start = layer.attributes.layer_position - window.position;
    let origin = (usize::try_from(start.x()).ok()?, usize::try_from(start.y()).ok()?);
    let within = origin.0 + layer.size.width() <= window.size.width()
        && origin.1 + layer.size.height() <= window.size.height();
    within.then_some(origin)
}

fn planes(channels: AnyChannels<FlatSamples>) -> Vec<Plane> {
    let mut planes: Vec<Plane> = channels
        .list
        .into_iter()
        .map(|channel| Plane {
            name: String::from_utf8_lossy(channel.name.as_slice()).into_owned(),
            values: match channel.sample_data {
                FlatSamples::F32(values) => values,
                other => other.values_as_f32().collect(),
            },
        })
        .collect();
    let aovs = Aov::value_variants().iter().flat_map(|aov| aov.channels());
    let order: Vec<&str> = BEAUTY.iter().chain(aovs).copied().collect();
    planes.sort_by_key(|plane| order.iter().position(|name| *name == plane.name).unwrap_or(order.len()));
    planes
}

fn attributes(layer: &Layer<AnyChannels<FlatSamples>>) -> Vec<(String, String)> {
    let mut own: Vec<(String, String)> = layer
        .attributes
        .other
        .iter()
        .filter_map(|(name, value)| {
            let AttributeValue::Text(value) = value else {
                return None;
            };
            let name = std::str::from_utf8(name.as_slice()).ok()?.strip_prefix(ATTRIBUTE_PREFIX)?;
            Some((name.to_owned(), String::from_utf8_lossy(value.as_slice()).into_owned()))
        })
        .collect();
    own.sort();
    own
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::film::write_exr;

    const AWKWARD: [f32; 12] = [
        0.0,
        -0.0,
        1e30,
        -1e30,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MIN_POSITIVE / 4.0,
        -f32::MIN_POSITIVE / 8.0,
        f32::MAX,
        f32::MIN,
        1.0 / 3.0,
        16_777_215.0,
    ];

    fn every_plane(origin: (usize, usize), picture: (usize, usize)) -> Image {
        let aovs = Aov::value_variants().iter().flat_map(|aov| aov.channels());
        let plane = |(i, name): (usize, &&str)| {
            let mut values = AWKWARD.to_vec();
            values.rotate_left(i % AWKWARD.len());
            Plane { name: name.to_string(), values }
        };
        Image {
            width: picture.0,
            height: picture.1,
            origin,
            size: (4, 3),
            planes: BEAUTY.iter().chain(aovs).enumerate().map(plane).collect(),
            attributes: [("entity.1", "Würfel"), ("seed", "0"), ("version", "0.1.0")]
                .map(|(name, value)| (name.to_owned(), value.to_owned()))
                .to_vec(),
        }
    }

    fn round_trip(image: &Image) -> Image {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        write_exr(image, std::fs::File::create(&path).unwrap()).unwrap();
        read_exr(&path).unwrap()
    }

    fn bits(image: &Image) -> Vec<Vec<u32>> {
        image.planes.iter().map(|plane| plane.values.iter().map(|v| v.to_bits()).collect()).collect()
    }

    #[test]
    fn an_image_comes_back_bit_for_bit() {
        let image = every_plane((0, 0), (4, 3));
        let back = round_trip(&image);
        assert_eq!(bits(&back), bits(&image));
        assert_eq!(back, image);
    }

    #[test]
    fn not_a_number_survives_the_round_trip() {
        let mut image = every_plane((0, 0), (4, 3));
        image.planes[0].values[5] = f32::NAN;
        assert_eq!(bits(&round_trip(&image)), bits(&image));
    }

    #[test]
    fn a_crop_keeps_its_place_in_the_picture() {
        let image = every_plane((7, 2), (20, 10));
        assert_eq!(round_trip(&image), image);
    }

    #[test]
    fn the_header_names_the_program_and_compresses_with_zip() {
        let mut bytes = Cursor::new(Vec::new());
        write_exr(&every_plane((0, 0), (4, 3)), &mut bytes).unwrap();
        let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes.into_inner()), true).unwrap();
        let header = &meta.headers[0];
        assert_eq!(header.compression, exr::prelude::Compression::ZIP16);
        let software = header.own_attributes.software_name.as_ref().unwrap().to_string();
        assert_eq!(software, concat!("Warpfront ", env!("CARGO_PKG_VERSION")));
    }

    #[test]
    fn the_same_image_gives_the_same_bytes() {
        let mut image = every_plane((0, 0), (4, 3));
        image.attributes = (0..20).map(|i| (format!("entity.{i}"), format!("name {i}"))).collect();
        let bytes = || {
            let mut bytes = Cursor::new(Vec::new());
            write_exr(&image, &mut bytes).unwrap();
            bytes.into_inner()
        };
        let first = bytes();
        assert!((0..20).all(|_| bytes() == first));
    }

    #[test]
    fn planes_that_do_not_fill_the_window_are_refused() {
        let mut image = every_plane((0, 0), (4, 3));
        image.planes[2].values.pop();
        let error = write_exr(&image, Cursor::new(Vec::new())).unwrap_err();
        assert_eq!(error.kind(), std::io::ErrorKind::InvalidData);
    }

    #[test]
    fn a_damaged_file_is_an_error_that_names_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.exr");
        std::fs::write(&path, b"v/1\x01 but no more").unwrap();
        assert!(read_exr(&path).unwrap_err().to_string().contains("broken.exr"));
    }
}
