//! From sample sums to files.
//!
#![doc = include_str!("channels.md")]

pub mod atomic;
mod exr;
mod image;
mod png;
mod read;
mod tone;

pub use self::exr::write_exr;
pub use self::image::{Aov, BEAUTY, Image, Plane};
pub use self::png::{write_png, write_rgb8};
pub use self::read::{ReadError, read_exr, read_exr_with};
