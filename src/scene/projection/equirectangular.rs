//! Equirectangular projection: all directions, longitude across and latitude up.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::local_ray::{LocalRay, PixelWidth};

/// Angle from the left to the right, radians.
pub(super) const HORIZONTAL_FOV: f64 = TAU;
/// Width over height of pictures with square pixels at the horizon.
pub(super) const ASPECT: f64 = 2.0;

pub(super) fn ray(film: DVec2) -> LocalRay {
    let (sin, cos) = libm::sincos((film.x - 0.5) * TAU);
    // Beyond a pole, where filters reach, it goes on down the other side.
    let (height, across) = libm::sincos((0.5 - film.y) * PI);
    LocalRay { origin: DVec3::ZERO, along: DVec3::new(across * sin, height, across * cos) }
}

pub(super) fn pixel(height: usize) -> PixelWidth {
    PixelWidth { constant: 0.0, angle: PI / height as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_ahead_the_sides_behind_and_the_upper_edge_the_zenith() {
        let t = 0.5f64.sqrt();
        for (x, y, expected) in [
            (0.5, 0.5, DVec3::Z),
            (0.75, 0.5, DVec3::X),
            (0.25, 0.5, DVec3::NEG_X),
            (0.0, 0.5, DVec3::NEG_Z),
            (1.0, 0.5, DVec3::NEG_Z),
            (0.3, 0.0, DVec3::Y),
            (0.3, 1.0, DVec3::NEG_Y),
            (0.5, 0.25, DVec3::new(0.0, t, t)),
            (0.5, -0.25, DVec3::new(0.0, t, -t)),
        ] {
            let LocalRay { origin, along } = ray(DVec2::new(x, y));
            assert!(origin == DVec3::ZERO && along.abs_diff_eq(expected, 1e-15), "{x} {y}: {along}");
        }
    }
}
