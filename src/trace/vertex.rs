//! The last vertex of a path: where its rays start, and the light ray that flies before the path goes on.

use glam::{DVec3, Vec3};

use crate::geometry::PrimitiveId;
use crate::light::Target;
use crate::math::columns::{columns, plain_field};
use crate::shade::Media;

plain_field!(Target);

columns! {
    /// A surface that a path scattered at; only with light sampling.
    pub struct Vertex => VertexBlock {
        /// World position.
        position: DVec3,
        /// Unit normal on the side that the path came from.
        normal: DVec3,
        /// The primitive it lies on.
        origin_prim: PrimitiveId,
        /// True if the path goes on.
        continues: bool,
        /// Unit direction in which it does.
        direction: DVec3,
        /// Density of that direction in solid angle; 0 if light sampling cannot choose it: at the camera, off a mirror.
        density: f64,
        /// The probability with which a light ray was sent out.
        chance: f64,
        /// True if the path has met mirrors or glass since.
        after_specular: bool,
        /// True if the ray in flight is a light ray.
        light_ray_in_flight: bool,
        /// Ray segments of the path up to the light ray, that included.
        depth: u32,
        /// Dielectrics around the light ray.
        media: Media,
        /// Target of the light ray.
        target: Target,
        /// Contribution to the path if the light ray gets there.
        brings: Vec3,
    }
}
