//! The last vertex of a path: where its rays start, and the light ray that flies before the path goes on.

use glam::{DVec3, Vec3};

use crate::geometry::PrimitiveId;
use crate::light::Target;
use crate::shade::Media;

/// A surface that a path scattered at; only with light sampling.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vertex {
    /// World position.
    pub position: DVec3,
    /// Unit normal on the side that the path came from.
    pub normal: DVec3,
    /// Share of light that comes head-on for which light that grazes it counts.
    pub grazing: f32,
    /// True if it is lit from behind as well.
    pub both_sides: bool,
    /// The primitive it lies on.
    pub origin_prim: PrimitiveId,
    /// True if the path goes on.
    pub continues: bool,
    /// Unit direction in which it does.
    pub direction: DVec3,
    /// Density of that direction in solid angle; 0 if light sampling cannot choose it: at the camera, off a mirror.
    pub density: f64,
    /// The probability with which a light ray was sent out.
    pub chance: f64,
    /// True if the path has met mirrors or glass since.
    pub after_specular: bool,
    /// True if the ray in flight is a light ray.
    pub light_ray_in_flight: bool,
    /// Ray segments of the path up to the light ray, that included.
    pub depth: u32,
    /// Dielectrics around the light ray.
    pub media: Media,
    /// Target of the light ray.
    pub target: Target,
    /// Contribution to the path if the light ray gets there.
    pub brings: Vec3,
}
