//! Equidistant fisheye, as domes use it: distance from the middle of the picture is angle from the view direction.

use glam::{DVec2, DVec3};

use super::local_ray::{LocalRay, PixelWidth};

/// A disk that touches the nearer edges of the picture; beside it there is nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fisheye {
    /// Angle between the middle and the rim, up to π, radians.
    pub half_fov: f64,
}

/// Width over height of a picture that the disk fills best.
pub(super) const ASPECT: f64 = 1.0;

impl Fisheye {
    pub(super) fn ray(&self, film: DVec2, aspect: f64) -> Option<LocalRay> {
        let place = DVec2::new(2.0 * film.x - 1.0, 1.0 - 2.0 * film.y);
        let place = place * DVec2::new(aspect.max(1.0), aspect.recip().max(1.0));
        let distance = place.length();
        if distance > 1.0 {
            return None;
        }
        let (sin, cos) = libm::sincos(distance * self.half_fov);
        let stretch = if distance > 0.0 { sin / distance } else { self.half_fov };
        Some(LocalRay { origin: DVec3::ZERO, along: (stretch * place).extend(cos) })
    }

    pub(super) fn pixel(&self, width: usize, height: usize) -> PixelWidth {
        PixelWidth { constant: 0.0, angle: 2.0 * self.half_fov / width.min(height) as f64 }
    }

    pub(super) fn sees_ball(&self, center: DVec3, radius: f64) -> bool {
        let shown = libm::asin((radius / center.length()).min(1.0));
        libm::atan2(center.truncate().length(), center.z) - self.half_fov <= shown
    }

    /// As wide as the disk, which a picture of any shape holds.
    pub(super) fn horizontal_fov(&self) -> f64 {
        2.0 * self.half_fov
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn distance_from_the_middle_is_angle_and_beside_the_disk_there_is_nothing() {
        let fisheye = Fisheye { half_fov: 0.75 * PI };
        for aspect in [1.0, 0.5, 2.0] {
            for (azimuth, distance) in [(0.0f64, 0.0), (0.0, 1.0), (0.3, 0.25), (2.0, 0.5), (-1.2, 0.999)] {
                let place = distance * DVec2::new(azimuth.cos(), azimuth.sin());
                let film =
                    place * DVec2::new(0.5 / f64::max(aspect, 1.0), -0.5 * f64::min(aspect, 1.0)) + 0.5;
                let LocalRay { origin, along } = fisheye.ray(film, aspect).unwrap();
                let (sin, cos) = (distance * fisheye.half_fov).sin_cos();
                let expected = DVec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos);
                assert!(origin == DVec3::ZERO && along.abs_diff_eq(expected, 1e-14), "{aspect}: {along}");
            }
        }
        for (film, aspect) in [(DVec2::ZERO, 1.0), (DVec2::new(0.9, 0.5), 2.0), (DVec2::new(0.5, 0.9), 0.5)] {
            assert_eq!(fisheye.ray(film, aspect), None);
        }
    }

    #[test]
    fn balls_are_seen_up_to_the_rim() {
        let fisheye = Fisheye { half_fov: 0.5 * PI };
        assert!(fisheye.sees_ball(DVec3::new(5.0, 0.0, -0.9), 1.0));
        assert!(!fisheye.sees_ball(DVec3::new(5.0, 0.0, -1.1), 1.0));
        assert!(Fisheye { half_fov: PI }.sees_ball(DVec3::new(0.0, 0.0, -5.0), 1e-3));
    }
}
