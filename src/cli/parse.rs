//! Values on the command line: what is accepted, and what is said about the rest.
//!
//! clap puts the flag and the value before these messages; they say what to give instead.

use std::ffi::{OsStr, OsString};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use glam::DVec3;

use crate::film::Aov;
use crate::scene::{MAX_SEGMENTS, MAX_SPP, MAX_WINDING, Surroundings};
use crate::study::bench::Contender;

/// Longest side of a picture, pixels.
const MAX_SIDE: u64 = 65_536;

/// Most pixels of a picture whose rays are all kept in memory: a few GB.
const MAX_KEPT: usize = 1 << 24;

/// A whole number in `range`.
fn whole(text: &str, range: RangeInclusive<u64>) -> Result<u64, String> {
    let remedy = || format!("give a whole number from {} to {}", range.start(), range.end());
    text.parse().ok().filter(|number| range.contains(number)).ok_or_else(remedy)
}

/// A count that fits in 32 bits, at least 1.
pub(super) fn count(text: &str) -> Result<u32, String> {
    whole(text, 1..=u64::from(u32::MAX)).map(|number| number as u32)
}

/// A number of samples per pixel.
pub(super) fn samples(text: &str) -> Result<u32, String> {
    whole(text, 1..=u64::from(MAX_SPP)).map(|number| number as u32)
}

/// A number of ray segments in a path.
pub(super) fn segments(text: &str) -> Result<u32, String> {
    whole(text, 1..=u64::from(MAX_SEGMENTS)).map(|number| number as u32)
}

/// A number of ray segments before Russian roulette.
pub(super) fn roulette(text: &str) -> Result<u32, String> {
    whole(text, 0..=u64::from(u32::MAX)).map(|number| number as u32)
}

/// Any unsigned 64-bit number.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    whole(text, 0..=u64::MAX)
}

/// A number of threads; 0 means one per core.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    whole(text, 0..=1024).map(|number| number as usize)
}

/// A number of rays in flight per worker.
pub(super) fn batch(text: &str) -> Result<usize, String> {
    whole(text, 1..=1 << 20).map(|number| number as usize)
}

/// A winding order: rays of higher ones differ by less than rounding.
pub(super) fn winding(text: &str) -> Result<u32, String> {
    whole(text, 0..=u64::from(MAX_WINDING)).map(|number| number as u32)
}

/// Opponent of the wavefront in a race.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Baseline {
    /// One that renders.
    Contender(Contender),
    /// Record of a build before.
    Previous(PathBuf),
}

impl Baseline {
    /// Contender, if it is one.
    pub(super) fn contender(&self) -> Option<Contender> {
        match self {
            Self::Contender(contender) => Some(*contender),
            Self::Previous(_) => None,
        }
    }

    /// Path of a record, if it is one.
    pub(super) fn record(&self) -> Option<&Path> {
        match self {
            Self::Contender(_) => None,
            Self::Previous(path) => Some(path),
        }
    }
}

/// An opponent of the wavefront.
pub(super) fn baseline(text: &str) -> Result<Baseline, String> {
    if let Some(path) = text.strip_prefix("previous:") {
        return Ok(Baseline::Previous(PathBuf::from(path)));
    }
    Contender::from_str(text, false).map(Baseline::Contender).map_err(|_| {
        let names = Contender::value_variants().iter().map(|contender| contender.name());
        format!("give one of {}, previous:FILE.json", names.collect::<Vec<_>>().join(", "))
    })
}

/// A finite number.
fn finite(text: &str) -> Result<f64, String> {
    text.trim()
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
        .ok_or_else(|| "give a number".to_owned())
}

/// A finite number above zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|&number| number > 0.0)
        .ok_or_else(|| "give a number above 0, such as 1e-4".to_owned())
}

/// A finite number, 0 or above.
pub(super) fn bound(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|&number| number >= 0.0)
        .ok_or_else(|| "give a number from 0 up, such as 0.01".to_owned())
}

/// Stops of exposure: beyond ±60 every picture is black or white.
pub(super) fn exposure(text: &str) -> Result<f64, String> {
    let stops = finite(text).ok().filter(|stops| stops.abs() <= 60.0);
    stops.ok_or_else(|| "give a number of stops from -60 to 60".to_owned())
}

/// A number of bytes: `8G`, `1.5GiB`, `500MB`; units are binary.
pub(super) fn memory(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let end = text.find(|letter: char| letter.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let shift = match unit.to_ascii_lowercase().trim_end_matches('b').trim_end_matches('i') {
        "" => Some(0),
        "k" => Some(10),
        "m" => Some(20),
        "g" => Some(30),
        "t" => Some(40),
        _ => None,
    };
    let bytes = shift.zip(positive(number).ok()).map(|(shift, number)| number * (1u64 << shift) as f64);
    bytes.map(|bytes| bytes as u64).ok_or_else(|| "give a size such as 8G, 1.5GiB or 500M".to_owned())
}

/// `WxH` in pixels.
pub(super) fn size(text: &str) -> Result<(usize, usize), String> {
    let side = |side: &str| whole(side.trim(), 1..=MAX_SIDE).ok().map(|pixels| pixels as usize);
    text.split_once(['x', 'X', '×'])
        .and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| format!("give WIDTHxHEIGHT in pixels, such as 640x480, each from 1 to {MAX_SIDE}"))
}

/// A number of rays to draw.
pub(super) fn ray_count(text: &str) -> Result<u32, String> {
    whole(text, 1..=10_000).map(|number| number as u32)
}

/// An angle of up to a whole turn, degrees.
pub(super) fn angle(text: &str) -> Result<f64, String> {
    let angle = finite(text).ok().filter(|&degrees| degrees > 0.0 && degrees <= 360.0);
    angle.ok_or_else(|| "give an angle above 0 and up to 360, in degrees".to_owned())
}

/// `WxH` in pixels of a picture whose rays are all kept in memory.
pub(super) fn small_size(text: &str) -> Result<(usize, usize), String> {
    let small = size(text)?;
    if small.0 * small.1 <= MAX_KEPT {
        Ok(small)
    } else {
        Err(format!("give at most {MAX_KEPT} pixels in all"))
    }
}

/// Numbers `A,B,…`, as many as asked for.
fn numbers<T, const N: usize>(text: &str, number: impl Fn(&str) -> Option<T>) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text.split(',').map(|part| number(part.trim())).collect();
    numbers?.try_into().ok()
}

/// `X0,Y0,X1,Y1`: the pixels from (X0, Y0) up to but without (X1, Y1).
pub(super) fn crop(text: &str) -> Result<[usize; 4], String> {
    let numbers = numbers(text, |part| part.parse::<usize>().ok())
        .ok_or("give X0,Y0,X1,Y1 in whole pixels from the top left corner, such as 0,0,320,240".to_owned())?;
    let [x0, y0, x1, y1] = numbers;
    if x0 < x1 && y0 < y1 {
        Ok(numbers)
    } else {
        Err("the crop is empty: X1 must be above X0, and Y1 above Y0".to_owned())
    }
}

/// A part of `--aov`: one plane, or all.
#[derive(Clone, Debug)]
pub(super) struct Planes(pub(super) Vec<Aov>);

/// The name of a plane, or `all`.
pub(super) fn planes() -> impl TypedValueParser<Value = Planes> {
    let all = PossibleValue::new("all").help("All of these");
    let names =
        Aov::ALL.iter().map(|plane| PossibleValue::new(plane.name()).help(plane.about())).chain([all]);
    PossibleValuesParser::new(names)
        .map(|name| Planes(Aov::named(&name).map_or(Aov::ALL.to_vec(), |plane| vec![plane])))
}

/// `X,Y,Z`: a point or a direction, scene units.
pub(super) fn triple(text: &str) -> Result<[f64; 3], String> {
    numbers(text, |part| finite(part).ok()).ok_or_else(|| "give X,Y,Z, such as 0,1,0".to_owned())
}

/// `X,Y,Z,RS`: where a hole is and its Schwarzschild radius, scene units.
pub(super) fn black_hole(text: &str) -> Result<[f64; 5], String> {
    let number = |part: &str| finite(part).ok();
    let still = || numbers(text, number).map(|[x, y, z, radius]: [f64; 4]| [x, y, z, radius, 0.0]);
    numbers(text, number)
        .or_else(still)
        .filter(|[.., radius, spin]: &[f64; 5]| *radius > 0.0 && spin.abs() <= 1.0)
        .ok_or_else(|| {
            "give X,Y,Z,RS in scene units with a radius above 0, such as 0,0,0,1, and for a hole that spins about +Y its \
             spin a/M from -1 to 1, such as 0,0,0,1,0.9"
                .to_owned()
        })
}

/// Light from infinity: `sky`, `black`, one number or `R,G,B`, or else the name of a picture.
pub(super) fn surroundings(text: OsString) -> Result<Surroundings, String> {
    let colour = match text.to_str() {
        Some("sky") => return Ok(Surroundings::Sky),
        Some("black") => Some([0.0; 3]),
        Some(text) => match bound(text) {
            Ok(grey) => Some([grey; 3]),
            Err(_) => numbers(text, |part| bound(part).ok()),
        },
        None => None,
    };
    match colour.map(|colour| DVec3::from(colour).as_vec3()) {
        None => Ok(Surroundings::Image(PathBuf::from(text))),
        Some(colour) if colour.max_element() <= 1e18 => Ok(Surroundings::Color(colour)),
        Some(_) => Err("give radiances of at most 1e18".to_owned()),
    }
}

/// A duration such as `90s` or `1h30m`.
pub(super) fn duration(text: &str) -> Result<Duration, String> {
    humantime::parse_duration(text)
        .ok()
        .filter(|duration| !duration.is_zero())
        .ok_or_else(|| "give a time above 0 with its unit, such as 90s, 5m or 1h30m".to_owned())
}

/// `path.to.key=value`; whether the scene has such a key, the loader says.
pub(super) fn assignment(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((key, _)) if !key.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("give path.to.key=value, such as camera.vertical_fov=50".to_owned()),
    }
}

/// A file name that ends in `.exr`.
pub(super) fn exr(text: &OsStr) -> Result<PathBuf, String> {
    with_extension(text, &["exr"]).map_err(|remedy| match png(text) {
        Ok(_) => format!("{remedy}; --png names the PNG beside it"),
        Err(_) => remedy,
    })
}

/// A file name that ends in `.png`.
pub(super) fn png(text: &OsStr) -> Result<PathBuf, String> {
    with_extension(text, &["png"])
}

/// A file name that ends in `.json`.
pub(super) fn json(text: &OsStr) -> Result<PathBuf, String> {
    with_extension(text, &["json"])
}

/// True if this could be the name of a scene.
pub(super) fn names_a_scene(text: &str) -> bool {
    with_extension(OsStr::new(text), &["toml", "gltf", "glb", "obj"]).is_ok()
}

/// Prefix of file names.
pub(super) fn prefix(text: &OsStr) -> Result<PathBuf, String> {
    let named =
        Path::new(text).file_name().is_some() && !text.to_string_lossy().ends_with(std::path::is_separator);
    if named {
        Ok(text.into())
    } else {
        Err("give the name that the files begin with, such as study".to_owned())
    }
}

/// A file name of a picture or a table of rays.
pub(super) fn rays(text: &OsStr) -> Result<PathBuf, String> {
    with_extension(text, &["svg", "png", "csv"])
}

fn with_extension(text: &OsStr, extensions: &[&str]) -> Result<PathBuf, String> {
    let path = Path::new(text);
    let names_folder = text.to_string_lossy().ends_with(std::path::is_separator);
    match path.extension() {
        Some(found) if extensions.iter().any(|e| found.eq_ignore_ascii_case(e)) && !names_folder => {
            Ok(path.to_owned())
        }
        _ => Err(format!("give a file name that ends in .{}", extensions.join(" or ."))),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn sizes_of_memory_have_binary_units() {
        let cases = [("1", 1), ("2k", 2048), ("1.5GiB", 3 << 29), ("500MB", 500 << 20), (" 1 T", 1 << 40)];
        for (text, bytes) in cases {
            assert_eq!(memory(text), Ok(bytes), "{text}");
        }
        for text in ["", "G", "0", "-1G", "1X", "nan", "inf", "1GG"] {
            assert!(memory(text).is_err(), "{text}");
        }
    }

    #[test]
    fn good_values_are_read() {
        assert_eq!(size("640x480"), Ok((640, 480)));
        assert_eq!(crop("0, 1,2,3"), Ok([0, 1, 2, 3]));
        assert_eq!(black_hole("-1,2.5,0,1e-3"), Ok([-1.0, 2.5, 0.0, 1e-3, 0.0]));
        assert_eq!(duration("1h30m"), Ok(Duration::from_secs(5400)));
        assert_eq!(duration("90s"), Ok(Duration::from_secs(90)));
        assert_eq!(seed("18446744073709551615"), Ok(u64::MAX));
        assert_eq!(exposure("-1.5"), Ok(-1.5));
        assert_eq!(exr(OsStr::new("a/b.EXR")), Ok(PathBuf::from("a/b.EXR")));
        assert_eq!(assignment("a.b=c=d"), Ok("a.b=c=d".to_owned()));
        let around = |text: &str| surroundings(text.into()).unwrap();
        assert_eq!(around("sky"), Surroundings::Sky);
        assert_eq!(around("black"), Surroundings::Color(Vec3::ZERO));
        assert_eq!(around("0.5"), Surroundings::Color(Vec3::splat(0.5)));
        assert_eq!(around("1, 0.5,2"), Surroundings::Color(Vec3::new(1.0, 0.5, 2.0)));
        assert_eq!(around("a,b.hdr"), Surroundings::Image("a,b.hdr".into()));
    }

    #[test]
    fn bad_values_are_refused() {
        assert!(["0x4", "4x0", "4", "x", "-4x4", "99999999x1", "4x4x4", ""].iter().all(|s| size(s).is_err()));
        assert!(["0,0,0,5", "5,0,4,9", "1,2,3", "1,2,3,4,5", "-1,0,4,4"].iter().all(|s| crop(s).is_err()));
        assert!(
            ["0,0,0,0", "0,0,0,1,1.1", "0,0,0,-1", "0,0,0", "nan,0,0,1", "0,0,inf,1"]
                .iter()
                .all(|s| black_hole(s).is_err())
        );
        assert!(["0s", "90", "-5s", "soon", ""].iter().all(|s| duration(s).is_err()));
        assert!(["0", "-1e-3", "nan", "inf", "x"].iter().all(|s| positive(s).is_err()));
        assert!(bound("0") == Ok(0.0) && ["-1e-3", "nan", "inf", "x"].iter().all(|s| bound(s).is_err()));
        assert!(["0", "-1", "4294967296", "1.5"].iter().all(|s| count(s).is_err()));
        assert!(["nan", "1e9", "-61"].iter().all(|s| exposure(s).is_err()));
        assert!(["out", "out.png", ".exr", "out.exr/", ""].iter().all(|s| exr(OsStr::new(s)).is_err()));
        assert!(surroundings("1e19".into()).is_err());
        assert!(["", "key", "=1"].iter().all(|s| assignment(s).is_err()));
    }
}
