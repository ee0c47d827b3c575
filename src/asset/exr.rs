//! OpenEXR files: what their headers promise is held against the bytes that are there before anything is allocated.

use std::io::Cursor;
use std::ops::Range;

use exr::block::UncompressedBlock;
use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock, CompressedTileBlock};
use exr::meta::attribute::{EnvironmentMap, IntegerBounds, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData, magic_number};
use exr::prelude::{Compression, Vec2, f16};
use glam::Vec3;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::flaw::Flaw;
use super::memory::Memory;
use super::primaries::{REC709, ToRec709, luminance_weights};

/// Bytes of chunks that are decoded at a time.
const BATCH: usize = 1 << 26;
/// Most chunks that are decoded at a time.
const BATCH_CHUNKS: usize = 64;
/// Chunks from which threads pay.
const MANY_CHUNKS: usize = 32;
/// Most bytes that one byte can stand for: zlib's 1032, of numbers of 3 bytes that become 4.
const EXPANSION: usize = 1 << 11;
/// Most bytes that one byte can stand for in DWA, which packs blocks of 8 × 8 before.
const DWA_EXPANSION: usize = 1 << 17;
/// Numbers at the start of a chunk of DWA.
const DWA_COUNTERS: usize = 11;
/// Those that tell how large something is once it is decoded.
const DWA_SIZES: [usize; 5] = [1, 6, 7, 8, 9];
/// Last words of the names of layers that hold the picture itself.
const MAIN: [&str; 5] = ["combined", "rgba", "rgb", "beauty", "color"];

/// An OpenEXR file in memory, whose headers have been read.
pub struct ExrFile<'a> {
    bytes: &'a [u8],
    meta: MetaData,
    /// Byte range of each part's table that tells where its chunks are.
    tables: Vec<Range<usize>>,
}

/// The channels that hold a picture's colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Colours {
    /// The part they are in.
    pub part: usize,
    /// Prefix of the channels' own names, without the dot.
    pub prefix: String,
    /// The name of the layer, the part's included; may be empty.
    pub layer: String,
    /// Indices among the part's channels.
    pub channels: ColourChannels,
    /// Names of other layers that hold colours.
    pub others: Vec<String>,
}

/// The kinds of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourChannels {
    /// Red, green, blue.
    Rgb([usize; 3]),
    /// Luminance Y.
    Grey(usize),
    /// Luminance Y with the chroma RY = (R − Y)/Y and BY = (B − Y)/Y.
    Chroma([usize; 3]),
}

impl ColourChannels {
    /// The channels.
    pub fn list(&self) -> &[usize] {
        match self {
            Self::Rgb(all) | Self::Chroma(all) => all,
            Self::Grey(one) => std::slice::from_ref(one),
        }
    }
}

/// Turns samples of [`ColourChannels`] into linear Rec. 709.
pub struct ToRgb {
    channels: ColourChannels,
    /// Luminance of the file's red, green and blue.
    weights: Vec3,
    /// From the file's primaries.
    space: ToRec709,
}

impl ToRgb {
    /// True if the samples stay as they are.
    pub fn is_identity(&self) -> bool {
        self.space.matrix().is_none() && matches!(self.channels, ColourChannels::Rgb(_))
    }

    /// True if the file's primaries span no colour space, so that they are left alone.
    pub fn is_unclear(&self) -> bool {
        self.space == ToRec709::Impossible
    }

    /// The colour of a pixel's samples, in the order of [`ColourChannels::list`]; values that are not finite stay.
    pub fn apply(&self, samples: Vec3) -> Vec3 {
        let colour = match self.channels {
            ColourChannels::Rgb(_) => samples,
            ColourChannels::Grey(_) => Vec3::splat(samples.x),
            ColourChannels::Chroma(_) => {
                let (r, b) = ((samples.y + 1.0) * samples.x, (samples.z + 1.0) * samples.x);
                let g = (samples.x - r * self.weights.x - b * self.weights.z) / self.weights.y;
                Vec3::new(r, g, b)
            }
        };
        self.space.matrix().filter(|_| colour.is_finite()).map_or(colour, |matrix| matrix * colour)
    }
}

impl<'a> ExrFile<'a> {
    /// True if a file begins as an OpenEXR file does.
    pub fn is_exr(bytes: &[u8]) -> bool {
        bytes.starts_with(&magic_number::BYTES)
    }

    /// Reads the headers.
    ///
    /// # Errors
    /// They are damaged, or promise more chunks than the file can hold.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Flaw> {
        if !Self::is_exr(bytes) {
            return Err(Flaw::new(
                "is not an OpenEXR file",
                "give an OpenEXR picture, such as `render` writes",
            ));
        }
        let mut reader = Cursor::new(bytes);
        let meta = MetaData::read_from_buffered(&mut reader, false).map_err(undecodable)?;
        let mut start = reader.position() as usize;
        let mut tables = Vec::new();
        for header in &meta.headers {
            let length = header.chunk_count.checked_mul(size_of::<u64>());
            let end = length.and_then(|length| start.checked_add(length)).filter(|end| *end <= bytes.len());
            let end = end.ok_or_else(|| overstated(header, bytes.len()))?;
            tables.push(start..end);
            start = end;
        }
        Ok(Self { bytes, meta, tables })
    }

    /// The header of each part; a file without parts counts as one.
    pub fn headers(&self) -> &[Header] {
        &self.meta.headers
    }

    /// The parts that hold a sample per pixel and channel.
    pub fn flat_parts(&self) -> impl Iterator<Item = usize> {
        self.headers().iter().enumerate().filter(|(_, header)| !header.deep).map(|(part, _)| part)
    }

    /// The full name of a channel; in a file of several parts that of its part comes first.
    pub fn name(&self, part: usize, channel: usize) -> String {
        let header = &self.meta.headers[part];
        joined(&self.part_name(part), &text(header.channels.list[channel].name.as_slice()))
    }

    /// The name of a part of a file of several.
    fn part_name(&self, part: usize) -> String {
        let name = self.meta.headers[part].own_attributes.layer_name.as_ref();
        let name = name.filter(|_| self.meta.headers.len() > 1);
        name.map(|name| text(name.as_slice())).unwrap_or_default()
    }

    /// Finds the colours: channels without a layer, else those of Blender's `Combined` or the like, else the first
    /// layer with colours.
    ///
    /// # Errors
    /// There are none.
    pub fn colours(&self) -> Result<Colours, Flaw> {
        let mut found: Vec<Colours> = self.flat_parts().flat_map(|part| self.layers(part)).collect();
        let rank = |colours: &Colours| {
            let last = colours.layer.rsplit('.').next().unwrap_or_default().to_lowercase();
            let place = match last.as_str() {
                "" => 0,
                word if MAIN.contains(&word) => 1,
                _ => 2,
            };
            (!matches!(colours.channels, ColourChannels::Rgb(_)), place)
        };
        let best = (0..found.len()).min_by_key(|index| rank(&found[*index]));
        let mut best = best.map(|index| found.remove(index)).ok_or_else(|| self.colourless())?;
        best.others = found.into_iter().map(|other| other.layer).collect();
        Ok(best)
    }

    fn colourless(&self) -> Flaw {
        let mut names = Vec::new();
        for part in self.flat_parts() {
            let channels = 0..self.meta.headers[part].channels.list.len();
            names.extend(channels.map(|channel| self.name(part, channel)));
        }
        let there = match names.as_slice() {
            [] => "only deep data".to_owned(),
            names => format!("only the channels {}", names.join(", ")),
        };
        Flaw::new(format!("has no colours, {there}"), "save it with channels R, G and B, or Y")
    }

    /// The layers of a part that hold colours, in the file's order.
    fn layers(&self, part: usize) -> Vec<Colours> {
        let names: Vec<String> = self.meta.headers[part]
            .channels
            .list
            .iter()
            .map(|channel| text(channel.name.as_slice()))
            .collect();
        let split = |name: &str| match name.rsplit_once('.') {
            Some((prefix, own)) => (prefix.to_owned(), own.to_owned()),
            None => (String::new(), name.to_owned()),
        };
        let split: Vec<(String, String)> = names.iter().map(|name| split(name)).collect();
        let mut prefixes: Vec<&String> = split.iter().map(|(prefix, _)| prefix).collect();
        prefixes.dedup();
        let find = |prefix: &String, own: &[&str]| {
            split
                .iter()
                .position(|(p, name)| p == prefix && own.iter().any(|own| name.eq_ignore_ascii_case(own)))
        };
        let all = |prefix: &String, names: [&[&str]; 3]| {
            let [a, b, c] = names.map(|own| find(prefix, own));
            Some([a?, b?, c?])
        };
        let channels = |prefix: &String| {
            let rgb = all(prefix, [&["r", "red"], &["g", "green"], &["b", "blue"]]).map(ColourChannels::Rgb);
            let chroma = || all(prefix, [&["y"], &["ry"], &["by"]]).map(ColourChannels::Chroma);
            let has_x = find(prefix, &["x"]).is_some();
            // Y beside X is a coordinate.
            let grey = || find(prefix, &["y"]).filter(|_| !has_x).map(ColourChannels::Grey);
            rgb.or_else(chroma).or_else(grey)
        };
        let colours = |prefix: &String| {
            let layer = joined(&self.part_name(part), prefix);
            let others = Vec::new();
            channels(prefix).map(|channels| Colours { part, prefix: prefix.clone(), layer, channels, others })
        };
        prefixes.into_iter().filter_map(colours).collect()
    }

    /// The pixels that a part has.
    pub fn data_window(&self, part: usize) -> IntegerBounds {
        self.meta.headers[part].data_window()
    }

    /// The picture that a part has pixels of.
    pub fn display_window(&self, part: usize) -> IntegerBounds {
        self.meta.headers[part].shared_attributes.display_window
    }

    /// Conversion of samples of the colour channels to linear Rec. 709.
    pub fn to_rgb(&self, colours: &Colours) -> ToRgb {
        let chromaticities = self.meta.headers[colours.part].shared_attributes.chromaticities;
        ToRgb {
            channels: colours.channels,
            weights: luminance_weights(&chromaticities.unwrap_or(REC709)).as_vec3(),
            space: chromaticities.as_ref().map_or(ToRec709::Same, ToRec709::of),
        }
    }

    /// True if a part is said to be the six sides of a cube.
    pub fn is_cube_map(&self, part: usize) -> bool {
        self.meta.headers[part].own_attributes.environment_map == Some(EnvironmentMap::Cube)
    }

    /// Reads some channels of a part: gives `put` the index within `channels`, column and row within the data window,
    /// and value of each sample.
    ///
    /// # Errors
    /// The part is damaged, cut off, of a kind that cannot be read, or its chunks do not fit in memory.
    pub fn read(
        &self,
        part: usize,
        channels: &[usize],
        memory: &Memory,
        mut put: impl FnMut(usize, usize, usize, f32),
    ) -> Result<(), Flaw> {
        let header = &self.meta.headers[part];
        self.check(header)?;
        let chunks = self.chunks(part)?;
        let block = block_bytes(header)?;
        let at_once = (BATCH / block.max(1)).clamp(1, BATCH_CHUNKS);
        memory.check("a part of the picture", (3 * block as u64).saturating_mul(at_once as u64))?;
        let pool = if chunks.len() >= MANY_CHUNKS { ThreadPoolBuilder::new().build().ok() } else { None };
        for batch in chunks.chunks(at_once) {
            for decoded in self.decode(batch, pool.as_ref()) {
                let Some(decoded) = decoded? else { continue };
                for line in decoded.lines(&header.channels) {
                    let Some(slot) = channels.iter().position(|wanted| *wanted == line.location.channel)
                    else {
                        continue;
                    };
                    let Vec2(x, y) = line.location.position;
                    let sample_type = header.channels.list[line.location.channel].sample_type;
                    for (column, value) in samples(line.value, sample_type).enumerate() {
                        put(slot, x + column, y, value);
                    }
                }
            }
        }
        Ok(())
    }

    fn check(&self, header: &Header) -> Result<(), Flaw> {
        if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
            return Err(Flaw::new(
                "has channels of lower resolution than the picture, which cannot be read (luminance and chroma)",
                "save it with channels R, G and B",
            ));
        }
        if header.layer_size.area() == 0 {
            return Err(Flaw::new("has no pixels", "save it again"));
        }
        header.validate(self.meta.headers.len() > 1, &mut false, false).map_err(undecodable)
    }

    /// The bytes of each chunk of a part, with its coordinates.
    fn chunks(&self, part: usize) -> Result<Vec<&'a [u8]>, Flaw> {
        let header = &self.meta.headers[part];
        let table = self.bytes.get(self.tables[part].clone()).unwrap_or_default();
        let damaged = || undecodable("its table of chunks leads nowhere");
        let is_multipart = self.meta.requirements.is_multilayer();
        let number = |bytes: &[u8], at: usize| {
            let word: Option<[u8; 4]> = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
            word.and_then(|word| usize::try_from(i32::from_le_bytes(word)).ok())
        };
        let coordinates = if header.blocks == BlockDescription::ScanLines { 4 } else { 16 };
        let before = coordinates + if is_multipart { 4 } else { 0 };
        let mut chunks = Vec::with_capacity(header.chunk_count);
        for offset in table.as_chunks().0 {
            let offset = usize::try_from(u64::from_le_bytes(*offset)).map_err(|_| damaged())?;
            let rest = self.bytes.get(offset..).ok_or_else(damaged)?;
            if is_multipart && number(rest, 0) != Some(part) {
                return Err(damaged());
            }
            let size = number(rest, before).ok_or_else(damaged)?;
            chunks.push(rest.get(..before + 4 + size).ok_or_else(damaged)?);
        }
        let there: usize = chunks.iter().map(|chunk| chunk.len()).sum();
        let expansion = if is_dwa(header) { DWA_EXPANSION } else { EXPANSION };
        let promised = header.layer_size.area().saturating_mul(header.channels.bytes_per_pixel);
        if promised > there.saturating_mul(expansion) {
            return Err(overstated(header, self.bytes.len()));
        }
        Ok(chunks)
    }

    /// Decodes chunks; those of smaller versions of the picture are left out.
    fn decode(
        &self,
        chunks: &[&[u8]],
        pool: Option<&ThreadPool>,
    ) -> Vec<Result<Option<UncompressedBlock>, Flaw>> {
        let decode = |bytes: &&[u8]| {
            let chunk = Chunk::read(&mut &**bytes, &self.meta).map_err(undecodable)?;
            let is_smaller = match &chunk.compressed_block {
                CompressedBlock::Tile(tile) => !tile.coordinates.is_largest_resolution_level(),
                _ => false,
            };
            if is_smaller {
                return Ok(None);
            }
            self.check_dwa(&chunk)?;
            UncompressedBlock::decompress_chunk(chunk, &self.meta, false).map(Some).map_err(undecodable)
        };
        match pool {
            Some(pool) => pool.install(|| chunks.par_iter().map(decode).collect()),
            None => chunks.iter().map(decode).collect(),
        }
    }

    /// Refuses a chunk of DWA whose counters ask for more memory than its pixels can need: the decoder believes them.
    fn check_dwa(&self, chunk: &Chunk) -> Result<(), Flaw> {
        let header = &self.meta.headers[chunk.layer_index];
        let (CompressedBlock::ScanLine(CompressedScanLineBlock { compressed_pixels_le: data, .. })
        | CompressedBlock::Tile(CompressedTileBlock { compressed_pixels_le: data, .. })) =
            &chunk.compressed_block
        else {
            return Ok(());
        };
        let place = header.get_block_data_indices(&chunk.compressed_block).map_err(undecodable)?;
        let Vec2(width, height) =
            header.get_absolute_block_pixel_coordinates(place).map_err(undecodable)?.size;
        // Pixels that do not become smaller are not compressed, and have no counters.
        if !is_dwa(header) || data.len() == width * height * header.channels.bytes_per_pixel {
            return Ok(());
        }
        // Blocks are whole, and each sample of them may take as many bytes as two floats.
        let most = ((width + 8) * (height + 8)).saturating_mul(8 * header.channels.list.len()) as u64;
        let counters = data.as_chunks().0.iter().map(|counter| u64::from_le_bytes(*counter));
        let exceeds = |(index, counter): (usize, u64)| DWA_SIZES.contains(&index) && counter > most;
        if counters.take(DWA_COUNTERS).enumerate().any(exceeds) {
            return Err(undecodable("a chunk promises more than its pixels"));
        }
        Ok(())
    }
}

/// Names with a dot between them.
fn joined(first: &str, second: &str) -> String {
    match (first, second) {
        (only, "") | ("", only) => only.to_owned(),
        _ => format!("{first}.{second}"),
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Bytes of the largest chunk, decoded.
fn block_bytes(header: &Header) -> Result<usize, Flaw> {
    let Vec2(width, height) = header.max_block_pixel_size();
    let (width, height) = (width.min(header.layer_size.width()), height.min(header.layer_size.height()));
    let bytes = width.checked_mul(height).and_then(|area| area.checked_mul(header.channels.bytes_per_pixel));
    bytes.ok_or_else(|| undecodable("its chunks are larger than any memory"))
}

/// True if chunks are compressed by DWA, in either size.
fn is_dwa(header: &Header) -> bool {
    matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_))
}

/// The samples of a line as floats.
fn samples(bytes: &[u8], sample_type: SampleType) -> impl Iterator<Item = f32> {
    bytes.chunks_exact(sample_type.bytes_per_sample()).map(move |bytes| match (sample_type, bytes) {
        (SampleType::F16, &[a, b]) => f16::from_ne_bytes([a, b]).to_f32(),
        (SampleType::F32, &[a, b, c, d]) => f32::from_ne_bytes([a, b, c, d]),
        (SampleType::U32, &[a, b, c, d]) => u32::from_ne_bytes([a, b, c, d]) as f32,
        _ => f32::NAN,
    })
}

/// A file whose header promises more than it can hold.
fn overstated(header: &Header, bytes: usize) -> Flaw {
    let Vec2(width, height) = header.layer_size;
    Flaw::new(
        format!("its header promises {width} × {height} pixels, more than the file's {bytes} bytes can hold"),
        "the file is damaged or cut off; save or copy it again",
    )
}

fn undecodable(error: impl std::fmt::Display) -> Flaw {
    Flaw::new(format!("cannot be decoded: {error}"), "the file is damaged; save it again")
}
