//! Punctual lights: points, spots, and points at infinity.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::emitter::luminance;
use super::tree::Emission;

/// A punctual light, world space.
///
/// Intensities are radiant: linear RGB, radiance × scene units². Irradiance is radiance × steradian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Punctual {
    /// Shines alike in all directions.
    Point {
        /// Position.
        position: DVec3,
        /// Intensity.
        intensity: Vec3,
    },
    /// Shines into a cone, with a soft edge.
    Spot {
        /// Position.
        position: DVec3,
        /// Axis of the cone: unit vector in which the light travels.
        direction: DVec3,
        /// Intensity on the axis.
        intensity: Vec3,
        /// Cosine of the half-angle up to which the intensity is that on the axis.
        cos_inner: f64,
        /// Cosine of the half-angle beyond which there is no light, at most `cos_inner`.
        cos_outer: f64,
    },
    /// A point at infinity, such as the sun.
    Distant {
        /// Unit vector in which the light travels, at infinity.
        direction: DVec3,
        /// Irradiance of a surface that faces the light.
        irradiance: Vec3,
    },
}

impl Punctual {
    /// Intensity along the unit vector `direction`; for a distant light its irradiance, whatever the direction.
    ///
    /// Source of a spot's falloff: `KHR_lights_punctual`, "Inner and Outer Cone Angles", without its lower bound on
    /// the difference of the cosines: a spot whose angles are equal has a sharp edge.
    pub fn intensity_towards(&self, direction: DVec3) -> Vec3 {
        match *self {
            Self::Point { intensity, .. } => intensity,
            Self::Spot { direction: axis, intensity, cos_inner, cos_outer, .. } => {
                intensity * falloff(axis.dot(direction), cos_inner, cos_outer) as f32
            }
            Self::Distant { irradiance, .. } => irradiance,
        }
    }

    /// Position; `None` at infinity.
    pub fn position(&self) -> Option<DVec3> {
        match *self {
            Self::Point { position, .. } | Self::Spot { position, .. } => Some(position),
            Self::Distant { .. } => None,
        }
    }

    /// Unit vector in which all its light travels, at infinity; `None` of a light that is somewhere.
    pub fn direction(&self) -> Option<DVec3> {
        match *self {
            Self::Distant { direction, .. } => Some(direction),
            Self::Point { .. } | Self::Spot { .. } => None,
        }
    }

    /// Bounds, power and orientation cone for the light tree; `None` of a light at infinity.
    pub fn emission(&self) -> Option<Emission> {
        // A point shines as a small sphere does, a spot into the cone around its axis.
        let (position, axis, cos_normals, cos_emission, angle) = match *self {
            Self::Spot { position, direction, cos_outer, .. } => {
                (position, direction, 1.0, cos_outer, TAU * (1.0 - cos_outer))
            }
            Self::Point { position, .. } => (position, DVec3::Z, -1.0, 0.0, 2.0 * TAU),
            Self::Distant { .. } => return None,
        };
        let (power, both_sides) = (angle * luminance(self.peak()), false);
        Some(Emission { min: position, max: position, power, axis, cos_normals, cos_emission, both_sides })
    }

    /// Intensity where it is largest, or irradiance.
    pub fn peak(&self) -> Vec3 {
        match *self {
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Distant { irradiance, .. } => irradiance,
        }
    }

    /// True if there is any light at all.
    pub fn emits(&self) -> bool {
        self.peak() != Vec3::ZERO
    }

    /// Scales the brightness of the light by `factor`.
    pub fn scaled(mut self, factor: f32) -> Self {
        match &mut self {
            Self::Point { intensity: peak, .. }
            | Self::Spot { intensity: peak, .. }
            | Self::Distant { irradiance: peak, .. } => *peak *= factor,
        }
        self
    }
}

/// Fraction of the intensity on the axis at an angle from it, by the cosines; from 1 to 0.
fn falloff(cos: f64, cos_inner: f64, cos_outer: f64) -> f64 {
    if cos >= cos_inner {
        1.0
    } else if cos <= cos_outer {
        0.0
    } else {
        // Here cos_outer < cos < cos_inner, so that the divisor is not 0.
        ((cos - cos_outer) / (cos_inner - cos_outer)).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WARM: Vec3 = Vec3::new(4.0, 2.0, 1.0);

    /// A spot along −Y, half-angles in degrees.
    fn spot(inner: f64, outer: f64) -> Punctual {
        Punctual::Spot {
            position: DVec3::ZERO,
            direction: DVec3::NEG_Y,
            intensity: WARM,
            cos_inner: inner.to_radians().cos(),
            cos_outer: outer.to_radians().cos(),
        }
    }

    /// A unit vector that many degrees from −Y.
    fn away(degrees: f64) -> DVec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        DVec3::new(0.6 * sin, -cos, 0.8 * sin)
    }

    #[test]
    fn points_and_distant_lights_shine_alike_in_all_directions() {
        let point = Punctual::Point { position: DVec3::X, intensity: WARM };
        let distant = Punctual::Distant { direction: DVec3::X, irradiance: WARM };
        for direction in [DVec3::X, DVec3::NEG_X, away(30.0)] {
            assert_eq!(point.intensity_towards(direction), WARM);
            assert_eq!(distant.intensity_towards(direction), WARM);
        }
    }

    #[test]
    fn a_spot_falls_off_with_the_square_of_the_cosine_between_its_angles() {
        let light = spot(20.0, 60.0);
        assert_eq!(light.intensity_towards(away(0.0)), WARM);
        assert_eq!(light.intensity_towards(away(19.9)), WARM);
        assert_eq!(light.intensity_towards(away(60.1)), Vec3::ZERO);
        assert_eq!(light.intensity_towards(DVec3::Y), Vec3::ZERO);
        // Midway between the cosines: a quarter.
        let midway = (0.5 * (20f64.to_radians().cos() + 0.5)).acos().to_degrees();
        assert!(light.intensity_towards(away(midway)).abs_diff_eq(0.25 * WARM, 1e-6));
    }

    #[test]
    fn a_spot_with_equal_angles_has_a_sharp_edge() {
        for angle in [30.0, 90.0] {
            let light = spot(angle, angle);
            assert_eq!(light.intensity_towards(away(angle - 1e-6)), WARM);
            assert_eq!(light.intensity_towards(away(angle + 1e-6)), Vec3::ZERO);
        }
        assert_eq!(spot(0.0, 0.0).intensity_towards(DVec3::NEG_Y), WARM);
    }

    #[test]
    fn scaling_changes_the_brightness_alone() {
        let point = Punctual::Point { position: DVec3::X, intensity: WARM };
        assert_eq!(point.scaled(0.5), Punctual::Point { position: DVec3::X, intensity: 0.5 * WARM });
        let distant = Punctual::Distant { direction: DVec3::X, irradiance: WARM };
        assert_eq!(distant.scaled(2.0).peak(), 2.0 * WARM);
        let spot = spot(10.0, 20.0);
        assert_eq!(spot.scaled(2.0).scaled(0.5), spot);
        assert!(spot.emits() && !spot.scaled(0.0).emits());
    }
}
