//! The disk of the sun.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::math::concentric::concentric;
use crate::math::frame::tangents;
use crate::math::sin_cos_turns;

/// A disk of even radiance at infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunDisk {
    /// Unit vector to its middle.
    pub middle: DVec3,
    /// Angular radius, radians.
    pub radius: f64,
    /// Radiance.
    pub radiance: Vec3,
    /// Square of the chord of the radius: solid angle over π.
    chord2: f64,
}

impl SunDisk {
    /// The disk that brings `irradiance` to a surface that faces it.
    pub fn new(middle: DVec3, radius: f64, irradiance: Vec3) -> Self {
        let chord2 = (2.0 * libm::sin(0.5 * radius)).powi(2);
        Self { middle, radius, radiance: irradiance / projected(radius) as f32, chord2 }
    }

    /// Irradiance of a surface that faces it.
    pub fn irradiance(&self) -> Vec3 {
        self.radiance * projected(self.radius) as f32
    }

    /// True if the sun is in this unit direction.
    pub fn covers(&self, direction: DVec3) -> bool {
        direction.distance_squared(self.middle) <= self.chord2
    }

    /// Solid angle.
    pub fn solid_angle(&self) -> f64 {
        PI * self.chord2
    }

    /// A unit direction of it, evenly, from two numbers in [0, 1).
    pub fn direction(&self, u: f64, v: f64) -> DVec3 {
        let [square, turns] = concentric(u, v);
        let height = 0.5 * square * self.chord2;
        let (sin, cos) = sin_cos_turns::sin_cos(turns);
        let (tangent, bitangent) = tangents(self.middle);
        let radius = (height * (2.0 - height)).sqrt();
        radius * (cos * tangent + sin * bitangent) + (1.0 - height) * self.middle
    }
}

/// Integral of the cosine to the middle over a disk of an angular radius.
fn projected(radius: f64) -> f64 {
    PI * libm::sin(radius).powi(2)
}
