//! Rays in the axes of a camera, and their width.

use glam::DVec3;

/// A ray in the axes of its camera: x right, y up, z forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalRay {
    /// Start, relative to the camera.
    pub origin: DVec3,
    /// Way that it takes to the near plane or sphere at 1.
    pub along: DVec3,
}

/// Width of a pixel: a constant part, and a part that grows with distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelWidth {
    /// Scene units.
    pub constant: f64,
    /// Radians, in the middle of the picture.
    pub angle: f64,
}

impl PixelWidth {
    /// Width at a distance, scene units.
    pub fn at(&self, distance: f64) -> f64 {
        self.constant + self.angle * distance
    }
}
