//! Pictures as other programs write them: layers, windows, colour spaces, and headers that promise too much.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image as File, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{Chromaticities, EnvironmentMap, IntegerBounds, SampleType};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{Blocks, Compression, LineOrder, WritableImage, f16};
use glam::Vec3;
use tempfile::TempDir;
use warpfront::asset::{Files, Picture, load_image};
use warpfront::film::read_exr;

/// Width and height of the data.
const SIZE: Vec2<usize> = Vec2(6, 3);

/// Names of channels and their values.
type Channels = Vec<(&'static str, f32)>;

/// An EXR file about to be written: each channel has one value everywhere.
#[derive(Clone)]
struct Exr {
    parts: Vec<(Option<&'static str>, Channels)>,
    size: Vec2<usize>,
    position: Vec2<i32>,
    display: IntegerBounds,
    chromaticities: Option<Chromaticities>,
    map: Option<EnvironmentMap>,
    compression: Compression,
    blocks: Blocks,
    half: bool,
}

impl Exr {
    fn with(channels: &[(&'static str, f32)]) -> Self {
        Self::with_parts(vec![(None, channels.to_vec())])
    }

    fn with_parts(parts: Vec<(Option<&'static str>, Channels)>) -> Self {
        Self {
            parts,
            size: SIZE,
            position: Vec2(0, 0),
            display: IntegerBounds::from_dimensions(SIZE),
            chromaticities: None,
            map: None,
            compression: Compression::ZIP16,
            blocks: Blocks::ScanLines,
            half: false,
        }
    }

    fn rgb() -> Self {
        Self::with(&[("R", 0.25), ("G", 0.5), ("B", 0.75)])
    }

    fn bytes(&self) -> Vec<u8> {
        let layer = |(name, channels): &(Option<&'static str>, Channels)| {
            let samples = |value: f32| match self.half {
                true => FlatSamples::F16(vec![f16::from_f32(value); self.size.area()]),
                false => FlatSamples::F32(vec![value; self.size.area()]),
            };
            let channels =
                channels.iter().map(|(name, value)| AnyChannel::new(*name, samples(*value))).collect();
            let attributes = LayerAttributes {
                layer_name: name.map(Into::into),
                layer_position: self.position,
                environment_map: self.map,
                ..LayerAttributes::default()
            };
            let (compression, blocks) = (self.compression, self.blocks);
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            Layer::new(self.size, attributes, encoding, AnyChannels::sort(channels))
        };
        let attributes =
            ImageAttributes { chromaticities: self.chromaticities, ..ImageAttributes::new(self.display) };
        let layers: Vec<_> = self.parts.iter().map(layer).collect();
        let mut bytes = Cursor::new(Vec::new());
        File::from_layers(attributes, layers).write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }
}

/// A file in a folder of its own.
struct Place {
    _folder: TempDir,
    path: PathBuf,
}

impl Place {
    fn with(name: &str, bytes: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        Self { _folder: folder, path }
    }
}

fn picture(bytes: &[u8]) -> Result<Picture, String> {
    let place = Place::with("sky.exr", bytes);
    load_image(&place.path, &Files::default()).map_err(|error| error.to_string())
}

/// The colour of a sky that has one, and the warnings but for the one about its shape.
fn colour(bytes: &[u8]) -> (Vec3, Vec<String>) {
    let picture = picture(bytes).unwrap();
    let first = picture.pixels[0];
    assert!(picture.pixels.iter().all(|pixel| (*pixel - first).length() < 1e-6));
    (first, picture.warnings)
}

/// The planes as `compare` sees them: name and first value.
fn planes(bytes: &[u8]) -> Vec<(String, f32)> {
    let place = Place::with("a.exr", bytes);
    let image = read_exr(&place.path).unwrap();
    image.channels.into_iter().map(|plane| (plane.name, plane.values[0])).collect()
}

/// What is said of a file that can be used neither as a sky nor to compare.
fn refusals(bytes: &[u8]) -> [String; 2] {
    let place = Place::with("bad.exr", bytes);
    let sky = load_image(&place.path, &Files::default()).unwrap_err().to_string();
    let compared = read_exr(&place.path).unwrap_err().to_string();
    assert!(sky.contains("bad.exr") && compared.contains("bad.exr"), "{sky}\n{compared}");
    [sky, compared]
}

const COLOUR: Vec3 = Vec3::new(0.25, 0.5, 0.75);

#[test]
fn colours_come_from_the_unnamed_layer_or_from_combined_or_from_the_first() {
    let rgb = |r, g, b| [(r, 0.25), (g, 0.5), (b, 0.75)];
    let other = [("A.R", 9.0), ("A.G", 9.0), ("A.B", 9.0)];
    let blender = rgb("ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B");
    for (layers, told) in [
        (rgb("R", "G", "B").to_vec(), None),
        ([rgb("R", "G", "B"), other].concat(), None),
        (blender.to_vec(), None),
        ([other, blender].concat(), Some("ViewLayer.Combined")),
        ([rgb("A.R", "A.G", "A.B"), [("Z.R", 9.0), ("Z.G", 9.0), ("Z.B", 9.0)]].concat(), Some("A")),
        (rgb("red", "green", "blue").to_vec(), None),
    ] {
        let (found, warnings) = colour(&Exr::with(&layers).bytes());
        assert_eq!(found, COLOUR, "{layers:?}");
        let named = told.is_none_or(|layer| warnings[0].ends_with(&format!(": {layer}")));
        assert!(named && warnings.len() == usize::from(told.is_some()), "{warnings:?}");
    }
}

#[test]
fn a_multilayer_file_compares_under_plain_names() {
    let blender = Exr::with(&[
        ("ViewLayer.Combined.A", 1.0),
        ("ViewLayer.Combined.B", 0.75),
        ("ViewLayer.Combined.G", 0.5),
        ("ViewLayer.Combined.R", 0.25),
        ("ViewLayer.Depth.Z", 7.0),
    ]);
    let named = |name: &str, value| (name.to_owned(), value);
    let expected = [
        named("R", 0.25),
        named("G", 0.5),
        named("B", 0.75),
        named("A", 1.0),
        named("ViewLayer.Depth.Z", 7.0),
    ];
    assert_eq!(planes(&blender.bytes()), expected);
    let parts = Exr::with_parts(vec![
        (Some("depth"), vec![("Z", 7.0)]),
        (Some("rgba"), vec![("A", 1.0), ("B", 0.75), ("G", 0.5), ("R", 0.25)]),
    ]);
    assert_eq!(colour(&parts.bytes()).0, COLOUR);
    assert_eq!(planes(&parts.bytes())[..4], expected[..4]);
    assert_eq!(planes(&parts.bytes())[4], named("depth.Z", 7.0));
}

#[test]
fn luminance_is_grey_and_with_chroma_it_is_a_colour() {
    assert_eq!(colour(&Exr::with(&[("Y", 0.25)]).bytes()).0, Vec3::splat(0.25));
    assert_eq!(planes(&Exr::with(&[("Y", 0.25)]).bytes()).iter().map(|(_, v)| *v).sum::<f32>(), 0.75);
    let luminance = COLOUR.dot(Vec3::new(0.2126, 0.7152, 0.0722));
    let chroma = [("RY", COLOUR.x / luminance - 1.0), ("BY", COLOUR.z / luminance - 1.0), ("Y", luminance)];
    let (found, _) = colour(&Exr::with(&chroma).bytes());
    assert!((found - COLOUR).length() < 1e-3, "{found}");
    let [sky, _] = refusals(&{
        let mut bytes = Exr::with(&chroma).bytes();
        let at = find(&bytes, b"RY\0") + 3 + 8;
        bytes[at..at + 8].copy_from_slice(&[2, 0, 0, 0, 2, 0, 0, 0]);
        bytes
    });
    assert!(sky.contains("lower resolution"), "{sky}");
}

#[test]
fn files_without_colours_say_which_channels_there_are() {
    let place =
        Place::with("z.exr", &Exr::with(&[("depth.Z", 1.0), ("normal.X", 0.0), ("normal.Y", 0.0)]).bytes());
    let message = load_image(&place.path, &Files::default()).unwrap_err().to_string();
    assert!(message.contains("channels depth.Z, normal.X, normal.Y"), "{message}");
    assert_eq!(read_exr(&place.path).unwrap().channels.len(), 3);
    let cube = Exr { map: Some(EnvironmentMap::Cube), ..Exr::rgb() };
    assert!(picture(&cube.bytes()).unwrap_err().contains("cube map"));
}

#[test]
fn a_sky_is_its_display_window_and_black_outside_its_data_window() {
    let display = |x, y, w, h| IntegerBounds::new(Vec2(x, y), Vec2(w, h));
    let smaller = Exr { display: display(-2, 0, 12, 6), position: Vec2(-1, 2), ..Exr::rgb() };
    let found = picture(&smaller.bytes()).unwrap();
    assert_eq!((found.width, found.height), (12, 6));
    for (index, pixel) in found.pixels.iter().enumerate() {
        let inside = (1..7).contains(&(index % 12)) && (2..5).contains(&(index / 12));
        assert_eq!(*pixel, if inside { COLOUR } else { Vec3::ZERO }, "{index}");
    }
    assert!(found.warnings[0].contains("data window"), "{:?}", found.warnings);
    let larger = Exr { display: display(1, 1, 4, 2), ..Exr::rgb() };
    let found = picture(&larger.bytes()).unwrap();
    assert_eq!((found.width, found.height, found.pixels), (4, 2, vec![COLOUR; 8]));
    assert_eq!(found.warnings, Vec::<String>::new());
    let image = read_exr(&Place::with("a.exr", &larger.bytes()).path).unwrap();
    assert_eq!((image.width, image.height, image.origin, image.size), (4, 2, (0, 0), (4, 2)));
    let outside = Exr { display: display(6, 0, 4, 2), ..Exr::rgb() };
    for message in refusals(&outside.bytes()) {
        assert!(message.contains("outside its display window"), "{message}");
    }
    let vast = Exr { display: display(0, 0, 32768, 16384), ..Exr::rgb() };
    assert!(picture(&vast.bytes()).unwrap_err().contains("its display window"));
}

#[test]
fn other_primaries_become_rec_709() {
    let acescg = Chromaticities {
        red: Vec2(0.713, 0.293),
        green: Vec2(0.165, 0.83),
        blue: Vec2(0.128, 0.044),
        white: Vec2(0.32168, 0.33767),
    };
    let file = Exr { chromaticities: Some(acescg), ..Exr::rgb() }.bytes();
    let expected = Vec3::new(0.0535, 0.5299, 0.7943);
    assert!((colour(&file).0 - expected).length() < 1e-3, "{}", colour(&file).0);
    let compared = planes(&file).iter().map(|(_, value)| *value).collect::<Vec<_>>();
    assert!((Vec3::from_slice(&compared) - expected).length() < 1e-3);
    let rec709 = Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.3, 0.6),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.329),
    };
    assert_eq!(colour(&Exr { chromaticities: Some(rec709), ..Exr::rgb() }.bytes()).0, COLOUR);
}

/// Kinds of files that the crate writes.
fn kinds() -> impl Iterator<Item = Exr> {
    use Compression::{B44, B44A, DWAA, DWAB, PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    let all = [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24, B44, B44A, DWAA(None), DWAB(None)];
    let blocks = [Blocks::ScanLines, Blocks::Tiles(Vec2(4, 2))];
    all.into_iter().flat_map(move |compression| {
        blocks.into_iter().flat_map(move |blocks| {
            [false, true].map(|half| Exr { compression, blocks, half, size: Vec2(8, 4), ..Exr::rgb() })
        })
    })
}

#[test]
fn every_compression_is_read_in_rows_and_tiles() {
    for kind in kinds() {
        let (found, _) =
            colour(&Exr { display: IntegerBounds::from_dimensions(kind.size), ..kind.clone() }.bytes());
        assert!((found - COLOUR).length() < 2e-3, "{:?} {:?} {found}", kind.compression, kind.blocks);
    }
}

fn find(bytes: &[u8], what: &[u8]) -> usize {
    bytes.windows(what.len()).position(|window| window == what).unwrap()
}

/// The file with other numbers in its data window, and in its display window if that is small.
fn with_window(kind: &Exr, window: [i32; 4]) -> Vec<u8> {
    let mut bytes = kind.bytes();
    let numbers: Vec<u8> = window.iter().flat_map(|number| number.to_le_bytes()).collect();
    for name in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let at = find(&bytes, name.as_bytes()) + name.len() + 4;
        bytes[at..at + 16].copy_from_slice(&numbers);
    }
    bytes
}

#[test]
fn headers_that_promise_more_than_there_is_are_refused_before_anything_is_allocated() {
    let far = i32::MAX / 2;
    for kind in kinds().filter(|kind| kind.half) {
        for window in [
            [0, 0, 32767, 16383],
            [0, 0, 59999, 59999],
            [0, 0, 0, far - 2],
            [0, 0, far - 2, 0],
            [0, 0, far - 2, far - 2],
            [i32::MIN, i32::MIN, i32::MAX, i32::MAX],
        ] {
            let _ = refusals(&with_window(&kind, window));
        }
    }
}

#[test]
fn sizes_of_tiles_and_chunks_are_held_against_the_file() {
    let tiled = Exr { blocks: Blocks::Tiles(Vec2(4, 2)), ..Exr::rgb() };
    let mut bytes = tiled.bytes();
    let name = b"tiles\0tiledesc\0";
    let at = find(&bytes, name) + name.len() + 4;
    for side in [0x7fff_ffffu32, 0x1000_0000, 0] {
        bytes[at..at + 4].copy_from_slice(&side.to_le_bytes());
        bytes[at + 4..at + 8].copy_from_slice(&side.to_le_bytes());
        let _ = refusals(&bytes);
    }
    let plain = Exr { compression: Compression::Uncompressed, ..Exr::rgb() }.bytes();
    let row = SampleType::F32.bytes_per_sample() * 3 * SIZE.0;
    let size = find(&plain, &(row as u32).to_le_bytes());
    for claimed in [i32::MAX, -1, i32::MIN] {
        let mut bytes = plain.clone();
        bytes[size..size + 4].copy_from_slice(&claimed.to_le_bytes());
        let _ = refusals(&bytes);
    }
}

/// Any number of 32 bits (Marsaglia's xorshift).
fn next(state: &mut u32) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    *state as usize
}

#[test]
fn damaged_files_are_errors_or_pictures() {
    let mut state = 1;
    for kind in kinds() {
        let whole = kind.bytes();
        for _ in 0..25 {
            let mut bytes = whole.clone();
            for _ in 0..1 + next(&mut state) % 3 {
                let at = next(&mut state) % bytes.len();
                bytes[at] = match next(&mut state) % 4 {
                    0 => 0,
                    1 => 0xff,
                    2 => bytes[at] ^ 1 << (next(&mut state) % 8),
                    _ => next(&mut state) as u8,
                };
            }
            if next(&mut state).is_multiple_of(8) {
                bytes.truncate(next(&mut state) % bytes.len());
            }
            let place = Place::with("a.exr", &bytes);
            let _ = (load_image(&place.path, &Files::default()), read_exr(&place.path));
        }
    }
}
