//! Record of one path, from which the planes of its pixel are made.

use glam::{DVec3, Vec3};

use super::ray_end::RayEnd;
use crate::spacetime::Side;

/// Record that one path leaves in its pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Radiance that it found.
    pub radiance: Vec3,
    /// End of its camera ray, if some plane [needs](super::Needs) it.
    pub camera_ray: Option<&'a CameraRay>,
    /// March steps of all its rays; 0 unless some plane needs them.
    pub steps: u32,
}

/// End of a camera ray.
#[derive(Clone, Copy, Debug, Default)]
pub struct CameraRay {
    /// Fate of the ray; all that follows but the side and the length is of a hit only.
    pub fate: RayEnd,
    /// Side of a wormhole on which it ends, on a surface or at infinity.
    pub side: Option<Side>,
    /// Coordinate path length, scene units; 0 unless some plane needs it.
    pub length: f64,
    /// World position.
    pub position: DVec3,
    /// World shading normal.
    pub normal: DVec3,
    /// Colour of the material.
    pub albedo: Vec3,
    /// Entity index.
    pub entity: u32,
}

impl Sample<'_> {
    /// The camera ray, if it met a surface.
    pub fn first_hit(&self) -> Option<&CameraRay> {
        self.camera_ray.filter(|ray| ray.fate == RayEnd::Hit)
    }
}
