//! State of a path from vertex to vertex: cold rows, touched only where something happens, one or two cache lines each.

use glam::Vec3;

use crate::shade::Media;

/// Light that a path gathers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gathers {
    /// All.
    All,
    /// Only what the camera sees of lamps: directly, in mirrors and through glass. Such a path ends where it scatters.
    Lamps,
    /// All but that; all, once it has scattered.
    Beyond,
}

/// A camera path under way.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Pixel, counted over the whole image row by row: keys the random numbers.
    pub pixel: u32,
    /// Sample of that pixel.
    pub sample: u32,
    /// Slot of its result in the tile's samples.
    pub slot: u32,
    /// Ray segments so far, the one in flight included.
    pub depth: u32,
    /// Surfaces so far that it might have passed through.
    pub looks: u32,
    /// Product of bounce weights.
    pub throughput: Vec3,
    /// Light that it gathers.
    pub gathers: Gathers,
    /// Light gathered so far.
    pub radiance: Vec3,
    /// Dielectrics around the path.
    pub media: Media,
}
