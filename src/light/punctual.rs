//! Lights without extent.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::Emission;
use super::emitter::luminance;

/// A light without extent, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Punctual {
    /// p
    Point {
        /// w
        position: DVec3,
        /// i
        intensity: Vec3,
    },
    /// s
    Spot {
        /// w
        position: DVec3,
        /// d
        direction: DVec3,
        /// i
        intensity: Vec3,
        /// c
        cos_inner: f64,
        /// c
        cos_outer: f64,
    },
    /// d
    Distant {
        /// d
        direction: DVec3,
        /// i
        irradiance: Vec3,
    },
}

impl Punctual {
    /// i
    pub fn intensity_towards(&self, direction: DVec3) -> Vec3 {
        match *self {
            Punctual::Point { intensity, .. } => intensity,
            Punctual::Spot { direction: axis, intensity, cos_inner, cos_outer, .. } => {
                let t = ((axis.dot(direction) - cos_outer) / (cos_inner - cos_outer)).clamp(0.0, 1.0);
                intensity * (t * t) as f32
            }
            Punctual::Distant { irradiance, .. } => irradiance,
        }
    }

    /// Where it is; `None` at infinity.
    pub fn position(&self) -> Option<DVec3> {
        match *self {
            Punctual::Point { position, .. } | Punctual::Spot { position, .. } => Some(position),
            Punctual::Distant { .. } => None,
        }
    }

    /// Unit direction in which all its light travels; `None` if it has none.
    pub fn direction(&self) -> Option<DVec3> {
        match *self {
            Punctual::Distant { direction, .. } => Some(direction),
            Punctual::Point { .. } | Punctual::Spot { .. } => None,
        }
    }

    /// What the light tree is to know; `None` of a light at infinity.
    pub fn emission(&self) -> Option<Emission> {
        let position = self.position()?;
        // A point shines as a small sphere does, a spot into the cone around its axis.
        let (axis, cos_normals, cos_emission, angle, intensity) = match *self {
            Punctual::Spot { direction, cos_outer, intensity, .. } => {
                (direction, 1.0, cos_outer, TAU * (1.0 - cos_outer), intensity)
            }
            Punctual::Point { intensity, .. } => (DVec3::Z, -1.0, 0.0, 2.0 * TAU, intensity),
            Punctual::Distant { .. } => return None,
        };
        let power = angle * luminance(intensity);
        Some(Emission {
            min: position,
            max: position,
            power,
            axis,
            cos_normals,
            cos_emission,
            both_sides: false,
        })
    }
}
