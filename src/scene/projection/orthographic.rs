//! Orthographic projection: parallel rays from a plane through the camera.

use glam::{DVec2, DVec3};

use super::local_ray::{LocalRay, PixelWidth};

/// Parallel rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthographic {
    /// Half of the height of what is seen, scene units.
    pub half_height: f64,
}

impl Orthographic {
    pub(super) fn ray(&self, film: DVec2, aspect: f64) -> LocalRay {
        let origin = DVec3::new((2.0 * film.x - 1.0) * aspect, 1.0 - 2.0 * film.y, 0.0);
        LocalRay { origin: self.half_height * origin, along: DVec3::Z }
    }

    pub(super) fn pixel(&self, height: usize) -> PixelWidth {
        PixelWidth { constant: 2.0 * self.half_height / height as f64, angle: 0.0 }
    }

    pub(super) fn sees_ball(&self, center: DVec3, radius: f64, aspect: f64) -> bool {
        let across = center.x.abs() - self.half_height * aspect;
        across.max(center.y.abs() - self.half_height).max(-center.z) <= radius
    }

    pub(super) fn nearest_start(&self, point: DVec3, near: f64, aspect: f64) -> DVec3 {
        let half = self.half_height * DVec2::new(aspect, 1.0);
        point.truncate().clamp(-half, half).extend(near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_parallel_and_start_on_the_picture_plane() {
        let projection = Orthographic { half_height: 3.0 };
        for (film, start) in [
            (DVec2::ZERO, DVec3::new(-6.0, 3.0, 0.0)),
            (DVec2::ONE, DVec3::new(6.0, -3.0, 0.0)),
            (DVec2::new(0.5, 0.25), DVec3::new(0.0, 1.5, 0.0)),
        ] {
            assert_eq!(projection.ray(film, 2.0), LocalRay { origin: start, along: DVec3::Z });
        }
        assert_eq!(projection.pixel(60).at(1e6), 0.1);
        let point = DVec3::new(1.0, -9.0, 5.0);
        assert_eq!(projection.nearest_start(point, 0.5, 2.0), DVec3::new(1.0, -3.0, 0.5));
    }

    #[test]
    fn balls_are_seen_beside_and_in_front_of_the_plane() {
        let sees = |x, y, z| Orthographic { half_height: 3.0 }.sees_ball(DVec3::new(x, y, z), 1.0, 2.0);
        assert!(sees(6.9, 0.0, 1e9) && sees(0.0, -3.9, 0.0) && sees(0.0, 0.0, -0.9));
        assert!(!sees(7.1, 0.0, 5.0) && !sees(0.0, 4.1, 5.0) && !sees(0.0, 0.0, -1.1));
    }
}
