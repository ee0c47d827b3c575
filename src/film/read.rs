//! Reading an OpenEXR file back into an image.

use std::path::{Path, PathBuf};

use exr::meta::attribute::{AttributeValue, IntegerBounds};
use exr::meta::header::Header;
use glam::Vec3;

use super::exr::ATTRIBUTE_PREFIX;
use super::image::{BEAUTY, Channel, Image};
use super::plane::Aov;
use crate::asset::exr::{Colours, ExrFile};
use crate::asset::{Files, Flaw};

/// Failure to read an EXR: missing, unreadable, damaged, too large, or a kind of EXR that holds no plain picture.
#[derive(Debug, thiserror::Error)]
#[error("cannot read `{}`: {}", path.display(), flaw.problem)]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// Flaw found in it.
    pub flaw: Flaw,
}

/// Reads the EXR at `path`; see [`read_exr_with`].
///
/// # Errors
/// See [`ReadError`].
pub fn read_exr(path: &Path) -> Result<Image, ReadError> {
    read_exr_with(path, &Files::default())
}

/// Reads the EXR at `path`, all channels widened to f32, colours in linear Rec. 709.
///
/// The colours are called R, G and B whatever the layer that they are in; the other channels of that layer lose its
/// name too. Of a file of several parts, those count that have the same pixels as the colours. Planes come in the order
/// in which a render makes them, whatever the order in the file; unknown channels come last. Attributes are those that
/// [`super::write_exr`] wrote, sorted by name.
///
/// # Errors
/// See [`ReadError`].
pub fn read_exr_with(path: &Path, files: &Files) -> Result<Image, ReadError> {
    let unreadable = |flaw| ReadError { path: path.to_owned(), flaw };
    let bytes = files.read(path).map_err(|error| {
        unreadable(Flaw::new(error.to_string(), "give an OpenEXR picture, such as `render` writes"))
    })?;
    ExrFile::open(&bytes).and_then(|file| decode(&file, files)).map_err(unreadable)
}

/// A channel of the file that becomes one of the image.
struct ChannelSource {
    part: usize,
    channel: usize,
    name: String,
}

fn decode(file: &ExrFile, files: &Files) -> Result<Image, Flaw> {
    let colours = file.colours().ok();
    let first = || file.flat_parts().next().ok_or_else(|| Flaw::new("holds only deep data", "flatten it"));
    let main = colours.as_ref().map_or_else(first, |colours| Ok(colours.part))?;
    let (data, display) = (file.data_window(main), file.display_window(main));
    let shown = Shown::of(data, display)?;
    let sources = sources(file, main, colours.as_ref());
    let pixels = (shown.size.0 as u64).saturating_mul(shown.size.1 as u64);
    let needed = pixels.saturating_mul((sources.len() * size_of::<f32>()) as u64);
    let (width, height) = shown.size;
    files
        .memory()
        .check(format!("a picture of {width} × {height} pixels and {} channels", sources.len()), needed)?;

    let blank =
        |source: &ChannelSource| Channel { name: source.name.clone(), values: vec![0.0; width * height] };
    let mut image_channels: Vec<Channel> = sources.iter().map(blank).collect();
    for part in file.flat_parts() {
        let of_part = sources.iter().enumerate().filter(|(_, source)| source.part == part);
        let (places, channels): (Vec<usize>, Vec<usize>) =
            of_part.map(|(place, source)| (place, source.channel)).unzip();
        if channels.is_empty() {
            continue;
        }
        file.read(part, &channels, &files.memory(), |slot, x, y, value| {
            if let Some(index) = shown.index(x, y) {
                image_channels[places[slot]].values[index] = value;
            }
        })?;
    }
    if let Some(colours) = &colours {
        convert(file, colours, &mut image_channels);
    }
    Ok(Image {
        width: display.size.width(),
        height: display.size.height(),
        origin: shown.origin,
        size: shown.size,
        attributes: attributes(&file.headers()[main]),
        channels: sorted(image_channels),
    })
}

/// The part of the data window that lies within the display window.
struct Shown {
    /// First column and row, from those of the data window.
    start: (usize, usize),
    /// First column and row, from those of the display window.
    origin: (usize, usize),
    size: (usize, usize),
}

impl Shown {
    fn of(data: IntegerBounds, display: IntegerBounds) -> Result<Self, Flaw> {
        let mad = |error| Flaw::new(format!("its windows make no picture: {error}"), "save it again");
        data.validate(None).map_err(mad)?;
        display.validate(None).map_err(mad)?;
        let along = |(start, end): (i32, i32), (first, last): (i32, i32)| {
            let (from, to) = (start.max(first), end.min(last));
            let distance = |a: i32, b: i32| usize::try_from(i64::from(a) - i64::from(b)).ok();
            let size = distance(to, from).filter(|size| *size > 0)?;
            Some((distance(from, start)?, distance(from, first)?, size))
        };
        let (end, last) = (data.end(), display.end());
        let x = along((data.position.x(), end.x()), (display.position.x(), last.x()));
        let y = along((data.position.y(), end.y()), (display.position.y(), last.y()));
        let (x, y) = x.zip(y).ok_or_else(|| {
            Flaw::new(
                "its data window lies outside its display window",
                "save it again with all of its pixels",
            )
        })?;
        Ok(Self { start: (x.0, y.0), origin: (x.1, y.1), size: (x.2, y.2) })
    }

    /// Index of the pixel at a column and row of the data window, row by row.
    fn index(&self, x: usize, y: usize) -> Option<usize> {
        let (x, y) = (x.checked_sub(self.start.0)?, y.checked_sub(self.start.1)?);
        (x < self.size.0 && y < self.size.1).then_some(y * self.size.0 + x)
    }
}

/// The channels of the main part, its colours first, and of those parts that have the same pixels.
fn sources(file: &ExrFile, main: usize, colours: Option<&Colours>) -> Vec<ChannelSource> {
    let mut sources = Vec::new();
    if let Some(colours) = colours {
        // Luminance alone is three channels too.
        let list = colours.channels.list();
        let colour = |(index, name): (usize, &&str)| ChannelSource {
            part: main,
            channel: list.get(index).or(list.first()).copied().unwrap_or_default(),
            name: (*name).to_owned(),
        };
        sources.extend(BEAUTY[..3].iter().enumerate().map(colour));
    }
    let same = |part: &usize| {
        file.data_window(*part) == file.data_window(main)
            && file.display_window(*part) == file.display_window(main)
    };
    for part in file.flat_parts().filter(same) {
        for channel in 0..file.headers()[part].channels.list.len() {
            let is_colour = colours.is_some_and(|colours| colours.channels.list().contains(&channel));
            if part != main || !is_colour {
                let full = file.name(part, channel);
                let layer = colours.map(|colours| format!("{}.", colours.layer));
                let own = layer.and_then(|layer| full.strip_prefix(&layer).map(str::to_owned));
                sources.push(ChannelSource { part, channel, name: own.unwrap_or(full) });
            }
        }
    }
    sources
}

/// Makes the first three channels linear Rec. 709.
fn convert(file: &ExrFile, colours: &Colours, channels: &mut [Channel]) {
    let to_rgb = file.to_rgb(colours);
    let [red, green, blue, ..] = channels else { return };
    if to_rgb.is_identity() {
        return;
    }
    for ((r, g), b) in red.values.iter_mut().zip(&mut green.values).zip(&mut blue.values) {
        [*r, *g, *b] = to_rgb.apply(Vec3::new(*r, *g, *b)).to_array();
    }
}

/// In the order in which a render makes them.
fn sorted(mut channels: Vec<Channel>) -> Vec<Channel> {
    let aovs = Aov::ALL.iter().flat_map(|aov| aov.channels());
    let order: Vec<&str> = BEAUTY.iter().chain(aovs).copied().collect();
    channels.sort_by_key(|plane| order.iter().position(|name| *name == plane.name).unwrap_or(order.len()));
    channels
}

fn attributes(header: &Header) -> Vec<(String, String)> {
    let mut own: Vec<(String, String)> = header
        .own_attributes
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
    use crate::film::exr::write_exr;

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
        let aovs = Aov::ALL.iter().flat_map(|aov| aov.channels());
        let plane = |(i, name): (usize, &&str)| {
            let mut values = AWKWARD.to_vec();
            values.rotate_left(i % AWKWARD.len());
            Channel { name: name.to_string(), values }
        };
        Image {
            width: picture.0,
            height: picture.1,
            origin,
            size: (4, 3),
            channels: BEAUTY.iter().chain(aovs).enumerate().map(plane).collect(),
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
        image.channels.iter().map(|plane| plane.values.iter().map(|v| v.to_bits()).collect()).collect()
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
        image.channels[0].values[5] = f32::NAN;
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
        image.channels[2].values.pop();
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
