//! Latitude-longitude pictures: EXR, HDR, PNG, JPEG.

mod hdr;
mod latlong;
mod latlong_exr;
mod picture;
mod raster;

pub use latlong::load;
pub use picture::Picture;
pub(super) use raster::{Encoding, texels};
