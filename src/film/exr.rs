//! Writing an image as an OpenEXR file.
//!
//! One part, one layer without a name, ZIP in blocks of 16 rows, all channels 32-bit floats under the names of the
//! image's channels: the single-part layout in which compositors find `R`, `G`, `B`, `A`, `depth.Z` and so on.

use std::io::{self, Seek, SeekFrom, Write};

use exr::block::lines::LineRefMut;
use exr::error::Error;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, Image as File, Layer};
use exr::math::{RoundingMode, Vec2};
use exr::meta::attribute::{self, AttributeValue, IntegerBounds, LevelMode, LineOrder, SampleType, Text};
use exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use exr::prelude::{Compression, WritableImage};

use super::image::{Channel, Image};

/// Put before the names of the image's own attributes, so that none can collide with one that the format reserves.
pub(super) const ATTRIBUTE_PREFIX: &str = "warpfront.";
/// Bytes before the header: magic number and version.
const PREAMBLE: u64 = 8;

/// Writes `image` to `out`, which should be buffered.
///
/// Attributes become text attributes `warpfront.<name>`; `software` names this program and its version. The same image
/// gives the same bytes.
///
/// # Errors
/// Errors of `out`, and [`io::ErrorKind::InvalidData`] if the channels do not fill the data window or a name does not
/// fit the format.
pub fn write_exr(image: &Image, mut out: impl Write + Seek) -> io::Result<()> {
    if !image.is_consistent() {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "the channels do not fill the data window"));
    }
    let channels = image.channels.iter().map(|plane| channel(plane, image.size.0)).collect();
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(image.size, layer_attributes(image), encoding, AnyChannels::sort(channels));
    let display_window = IntegerBounds::from_dimensions((image.width, image.height));
    let file = File::new(ImageAttributes::new(display_window), layer);
    let written = file.write().to_buffered(&mut out).and_then(|()| {
        let headers = file.write().infer_meta_data();
        headers.iter().try_for_each(|header| sort_attributes(header, &mut out))
    });
    written.map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidData, other.to_string()),
    })
}

/// Writes the attributes once more, by name, over those of the only header: the crate keeps them in a hash map, whose
/// order differs from run to run.
fn sort_attributes(header: &Header, out: &mut (impl Write + Seek)) -> Result<(), Error> {
    let mut attributes: Vec<_> = header.all_named_attributes().collect();
    attributes.sort_by_key(|&(name, _)| name);
    out.seek(SeekFrom::Start(PREAMBLE))?;
    attributes.iter().try_for_each(|(name, value)| attribute::write(name, value, out))?;
    Ok(out.flush()?)
}

fn channel(plane: &Channel, width: usize) -> AnyChannel<Rows<'_>> {
    AnyChannel {
        name: text(&plane.name),
        sample_data: Rows { width, values: &plane.values },
        quantize_linearly: false,
        sampling: Vec2(1, 1),
    }
}

fn layer_attributes(image: &Image) -> LayerAttributes {
    let own = image
        .attributes
        .iter()
        .map(|(name, value)| (text(&format!("{ATTRIBUTE_PREFIX}{name}")), AttributeValue::Text(text(value))));
    LayerAttributes {
        layer_position: Vec2(image.origin.0 as i32, image.origin.1 as i32),
        software_name: Some(text(concat!("Warpfront ", env!("CARGO_PKG_VERSION")))),
        other: own.collect(),
        ..LayerAttributes::default()
    }
}

/// EXR text is UTF-8 by convention; the crate's checked constructor would allow Latin-1 only.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}

/// A plane, borrowed: the crate's own sample storage would need a copy of the picture.
#[derive(Clone, Copy)]
struct Rows<'a> {
    width: usize,
    values: &'a [f32],
}

impl<'a> WritableSamples<'a> for Rows<'_> {
    type Writer = Self;

    fn sample_type(&self) -> SampleType {
        SampleType::F32
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&'a self, _header: &Header) -> Self {
        *self
    }
}

impl SamplesWriter for Rows<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let start = line.location.position.y() * self.width + line.location.position.x();
        let row = &self.values[start..start + line.location.sample_count];
        // Writing to memory fails only if the line has another length than the row that was just cut to it.
        let _ = line.write_samples_from_slice(row);
    }
}
