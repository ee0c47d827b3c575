//! State of a path from vertex to vertex: the cold columns, touched only where something happens.

use glam::Vec3;

use crate::math::columns::{columns, plain_field};
use crate::shade::Media;

/// Light that a path gathers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gathers {
    /// All.
    #[default]
    All,
    /// Only what the camera sees of lamps: directly, in mirrors and through glass. Such a path ends where it scatters.
    Lamps,
    /// All but that; all, once it has scattered.
    Beyond,
}

plain_field!(Media, Gathers);

columns! {
    /// A camera path under way.
    pub struct Path => PathBlock {
        /// Pixel, counted over the whole image row by row: keys the random numbers.
        pixel: u32,
        /// Sample of that pixel.
        sample: u32,
        /// Slot of its result in the tile's samples.
        slot: u32,
        /// Ray segments so far, the one in flight included.
        depth: u32,
        /// Product of bounce weights.
        throughput: Vec3,
        /// Light that it gathers.
        gathers: Gathers,
        /// Light gathered so far.
        radiance: Vec3,
        /// Dielectrics around the path.
        media: Media,
    }
}
