//! Radiance pictures (`.hdr`, `.pic`): the header is read here, the pixels by the `image` crate.

use std::io::{Cursor, Read};

use exr::meta::attribute::Chromaticities;
use exr::prelude::Vec2;
use glam::Vec3;
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;

use super::picture::{BYTES_PER_PIXEL, Picture, check_size, undecodable};
use crate::asset::flaw::Flaw;
use crate::asset::memory::Memory;
use crate::asset::notes::Notes;
use crate::asset::primaries::ToRec709;

/// First bytes of a file; programs write their own name behind.
const MAGIC: &[u8] = b"#?";
/// The least number of bytes of a row.
const ROW_BYTES: usize = 4;

/// Content of a header.
struct Header {
    /// Factors by which pixels have been multiplied, red, green, blue.
    factors: Vec3,
    primaries: Option<Chromaticities>,
    orientation: Orientation,
    /// Runs of pixels in the file.
    runs: usize,
    /// Pixels of a run.
    length: usize,
}

/// Order of pixels.
#[derive(Clone, Copy)]
struct Orientation {
    /// Runs are columns.
    by_column: bool,
    /// X falls.
    mirrored: bool,
    /// Y grows upwards.
    upwards: bool,
}

/// True if a file begins as a Radiance picture does.
pub(super) fn is_hdr(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Decodes a Radiance picture.
pub(super) fn decode(bytes: &[u8], memory: &Memory, notes: &mut Notes) -> Result<Picture, Flaw> {
    let (header, data) = parse(bytes, notes)?;
    let Header { orientation, runs, length, .. } = header;
    let (width, height) = if orientation.by_column { (runs, length) } else { (length, runs) };
    if runs.saturating_mul(ROW_BYTES) > data.len() {
        return Err(Flaw::new(
            format!("its header promises {width} × {height} pixels, more than {} bytes can hold", data.len()),
            "the file is damaged or cut off; save or copy it again",
        ));
    }
    check_size(width, height, BYTES_PER_PIXEL + size_of::<Vec3>() as u64, memory)?;
    // In the order that the crate knows.
    let plain = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {runs} +X {length}\n");
    let decoder = HdrDecoder::new(Cursor::new(plain).chain(data)).map_err(undecodable)?;
    let mut values = vec![0; decoder.total_bytes() as usize];
    decoder.read_image(&mut values).map_err(undecodable)?;

    let space = header.primaries.as_ref().map_or(ToRec709::Same, ToRec709::of);
    if space == ToRec709::Impossible {
        notes.add("a line of the header is ignored: it spans no colour space", "PRIMARIES");
    }
    let matrix = space.matrix();
    let pixel = |run: usize, at: usize| {
        let bytes = values.as_chunks::<4>().0.get(3 * (run * length + at)..).unwrap_or_default();
        let value = |channel: usize| f32::from_ne_bytes(bytes.get(channel).copied().unwrap_or_default());
        let pixel = Vec3::new(value(0), value(1), value(2)) / header.factors;
        matrix.map_or(pixel, |matrix| matrix * pixel)
    };
    let pixels = (0..width * height).map(|index| {
        let x = if orientation.mirrored { width - 1 - index % width } else { index % width };
        let y = if orientation.upwards { height - 1 - index / width } else { index / width };
        if orientation.by_column { pixel(x, y) } else { pixel(y, x) }
    });
    Ok(Picture { width, height, pixels: pixels.collect(), warnings: Vec::new() })
}

/// Reads the header; the rest is the pixels.
fn parse<'a>(bytes: &'a [u8], notes: &mut Notes) -> Result<(Header, &'a [u8]), Flaw> {
    let mut rest = bytes;
    let mut factors = Vec3::ONE;
    let mut primaries = None;
    loop {
        let line = next_line(&mut rest)?;
        if line.is_empty() {
            break;
        }
        let Some((key, value)) = line.split_once('=').filter(|_| !line.starts_with('#')) else {
            continue;
        };
        let numbers =
            || value.split_whitespace().map(str::parse::<f32>).collect::<Result<Vec<f32>, _>>().ok();
        match key.trim() {
            "FORMAT" if value.trim() != "32-bit_rle_rgbe" => {
                return Err(Flaw::new(
                    format!("holds pixels of the format `{}`", value.trim()),
                    "save it as RGBE, for instance with Radiance's ra_xyze -r",
                ));
            }
            "EXPOSURE" | "COLORCORR" => {
                let factor = match numbers().as_deref() {
                    Some(&[all]) => Vec3::splat(all),
                    Some(&[r, g, b]) => Vec3::new(r, g, b),
                    _ => Vec3::ZERO,
                };
                if factor.is_finite() && factor.cmpgt(Vec3::ZERO).all() {
                    factors *= factor;
                } else {
                    notes.add("a line of the header is ignored: not a positive factor", line);
                }
            }
            "PRIMARIES" => match numbers().as_deref() {
                Some(&[rx, ry, gx, gy, bx, by, wx, wy]) => {
                    let [red, green, blue, white] =
                        [(rx, ry), (gx, gy), (bx, by), (wx, wy)].map(|(x, y)| Vec2(x, y));
                    primaries = Some(Chromaticities { red, green, blue, white });
                }
                _ => notes.add("a line of the header is ignored: not 8 numbers", line),
            },
            _ => {}
        }
    }
    let (orientation, runs, length) = resolution(&next_line(&mut rest)?)?;
    Ok((Header { factors, primaries, orientation, runs, length }, rest))
}

/// The next line without its end.
fn next_line(rest: &mut &[u8]) -> Result<String, Flaw> {
    let end =
        rest.iter().position(|byte| *byte == b'\n').ok_or_else(|| undecodable("the header has no end"))?;
    let line = String::from_utf8_lossy(&rest[..end]).trim().to_owned();
    *rest = &rest[end + 1..];
    Ok(line)
}

/// A line such as `-Y 512 +X 1024`: the orientation, the number of runs, and their length.
fn resolution(line: &str) -> Result<(Orientation, usize, usize), Flaw> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let odd = || undecodable(format!("`{line}` is no size such as `-Y 512 +X 1024`"));
    let &[first, runs, second, length] = words.as_slice() else {
        return Err(odd());
    };
    let by_column = match (first, second) {
        ("-Y" | "+Y", "-X" | "+X") => false,
        ("-X" | "+X", "-Y" | "+Y") => true,
        _ => return Err(odd()),
    };
    let has = |axis| first == axis || second == axis;
    let orientation = Orientation { by_column, mirrored: has("-X"), upwards: has("+Y") };
    let number = |word: &str| word.parse::<u32>().map(|number| number as usize).map_err(|_| odd());
    Ok((orientation, number(runs)?, number(length)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pixels 1, 2, 3 (first run) and 4, 5, 6 under a header.
    fn decoded(header: &str) -> Result<(Picture, Vec<String>), Flaw> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.extend((1..=6u8).flat_map(|value| [value * 32, 0, 0, 131]));
        let mut notes = Notes::default();
        let picture = decode(&bytes, &Memory::default(), &mut notes)?;
        Ok((picture, notes.into_lines("a.hdr")))
    }

    fn reds(header: &str) -> Vec<f32> {
        let (picture, _) = decoded(header).unwrap();
        picture.pixels.iter().map(|pixel| pixel.x).collect()
    }

    #[test]
    fn pixels_are_divided_by_all_exposures_and_corrections() {
        let (picture, notes) =
            decoded("#?RGBE\r\nEXPOSURE=2\nEXPOSURE = 0.5\nCOLORCORR=4 1 1\n\n-Y 2 +X 3\n").unwrap();
        assert_eq!(picture.pixels[1], Vec3::new(0.5, 0.0, 0.0));
        assert_eq!(notes, Vec::<String>::new());
        let (picture, notes) = decoded("#?RADIANCE\nEXPOSURE=bright\n\n-Y 2 +X 3\n").unwrap();
        assert_eq!((picture.pixels[1].x, notes.len()), (2.0, 1));
    }

    #[test]
    fn every_orientation_is_turned_upright() {
        for (size, expected) in [
            ("-Y 2 +X 3", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            ("+Y 2 +X 3", [4.0, 5.0, 6.0, 1.0, 2.0, 3.0]),
            ("-Y 2 -X 3", [3.0, 2.0, 1.0, 6.0, 5.0, 4.0]),
            ("+X 2 -Y 3", [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]),
            ("-X 2 +Y 3", [6.0, 3.0, 5.0, 2.0, 4.0, 1.0]),
        ] {
            assert_eq!(reds(&format!("#?RADIANCE\n\n{size}\n")), expected, "{size}");
        }
    }

    #[test]
    fn headers_that_promise_more_than_there_is_are_refused() {
        for size in ["-Y 16384 +X 32768", "-Y 4294967295 +X 4294967295", "-Y 2", "Y 2 X 3", "-Y 2 +X -3"] {
            assert!(decoded(&format!("#?RADIANCE\n\n{size}\n")).is_err(), "{size}");
        }
        assert!(
            decoded("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 2 +X 3\n")
                .unwrap_err()
                .problem
                .contains("xyze")
        );
        assert!(decoded("#?RADIANCE\n").is_err());
    }
}
