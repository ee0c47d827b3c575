//! Pictures in memory, and the checks that each format needs before it decodes one.

use glam::Vec3;

use crate::asset::flaw::Flaw;
use crate::asset::memory::Memory;

/// Most pixels in a picture: 32768 × 16384.
const MAX_PIXELS: usize = 1 << 29;
/// Bytes per pixel of a picture that lights a scene: the picture and the table by which its lights are sampled.
pub(super) const BYTES_PER_PIXEL: u64 = (size_of::<Vec3>() + size_of::<f64>()) as u64;

/// A picture in linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear RGB, row-major, from the top; finite and not negative.
    pub pixels: Vec<Vec3>,
    /// Changes made, one line each.
    pub warnings: Vec<String>,
}

/// Refuses a picture without pixels, with too many, or with more than fit in memory at `bytes` for each.
pub(super) fn check_size(width: usize, height: usize, bytes: u64, memory: &Memory) -> Result<(), Flaw> {
    let pixels = match width.checked_mul(height) {
        Some(pixels @ 1..=MAX_PIXELS) => pixels as u64,
        _ => {
            return Err(Flaw::new(
                format!("a picture of {width} × {height} pixels cannot be used"),
                "use at least one pixel and at most 32768 × 16384",
            ));
        }
    };
    memory.check(format!("a picture of {width} × {height} pixels"), pixels * bytes)
}

/// A flaw of a file that its decoder refuses.
pub(super) fn undecodable(error: impl std::fmt::Display) -> Flaw {
    Flaw::new(format!("cannot be decoded: {error}"), "the file is damaged; save it again")
}
