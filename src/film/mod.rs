//! From sample sums to files.
//!
#![doc = include_str!("channels.md")]

pub mod atomic;
mod exr;
mod image;
mod plane;
mod png;
mod ray_end;
mod read;
mod runs;
mod sample;
mod sums;
mod tone;
mod wanted;

pub use self::exr::write_exr;
pub use self::image::{BEAUTY, Channel, Image};
pub use self::plane::Aov;
pub(crate) use self::plane::Needs;
pub use self::png::{write_png, write_rgb8};

pub use self::ray_end::RayEnd;
pub use self::read::{ReadError, read_exr, read_exr_with};
pub(crate) use self::sample::{CameraRay, Sample};
pub(crate) use self::sums::Sums;
pub(crate) use self::wanted::Wanted;
