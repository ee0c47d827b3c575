//! Emission of one emitter, as a light tree sees it.

use glam::DVec3;

/// Bounds, power and orientation cone of one emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Least corner of the world bounds.
    pub min: DVec3,
    /// Greatest corner of the world bounds.
    pub max: DVec3,
    /// Radiant power, any unit, not negative.
    pub power: f64,
    /// Unit vector in the middle of the normals.
    pub axis: DVec3,
    /// Cosine of the half-angle of the cone of normals around the axis; −1: all directions, as of a sphere.
    pub cos_normals: f64,
    /// Cosine of the half-angle around each normal into which it emits, in [0, 1]; 0: a hemisphere, as of a Lambertian
    /// emitter.
    pub cos_emission: f64,
    /// True if it emits against its normals as well.
    pub both_sides: bool,
}
