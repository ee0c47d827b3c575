//! Perspective: rays through a pinhole or a thin lens.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::local_ray::{LocalRay, PixelWidth};
use super::thin_lens::ThinLens;

/// A pinhole or a thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perspective {
    /// Tangent of half the vertical field of view.
    pub tan_half_fov: f64,
    /// The lens; a pinhole without.
    pub lens: Option<ThinLens>,
}

impl Perspective {
    /// A pinhole of a vertical field of view in radians; `None` unless that is between 0 and π.
    pub fn new(vertical_fov: f64) -> Option<Self> {
        let tan_half_fov = libm::tan(0.5 * vertical_fov);
        let is_usable = tan_half_fov.is_finite() && tan_half_fov > 0.0 && vertical_fov < PI;
        is_usable.then_some(Self { tan_half_fov, lens: None })
    }

    pub(super) fn ray(&self, film: DVec2, aspect: f64, lens: DVec2) -> LocalRay {
        let x = (2.0 * film.x - 1.0) * self.tan_half_fov * aspect;
        let y = (1.0 - 2.0 * film.y) * self.tan_half_fov;
        let through_middle = DVec3::new(x, y, 1.0);
        let Some(thin) = self.lens else {
            return LocalRay { origin: DVec3::ZERO, along: through_middle };
        };
        let origin = thin.point(lens).extend(0.0);
        LocalRay { origin, along: through_middle - origin / thin.focus_distance }
    }

    pub(super) fn pixel(&self, height: usize) -> PixelWidth {
        PixelWidth { constant: 0.0, angle: 2.0 * self.tan_half_fov / height as f64 }
    }

    pub(super) fn sees_ball(&self, center: DVec3, radius: f64, aspect: f64) -> bool {
        let shown = libm::asin((radius / center.length()).min(1.0));
        let beyond = |side: f64, tan_half: f64| libm::atan2(side.abs(), center.z) - libm::atan(tan_half);
        let across = beyond(center.x, self.tan_half_fov * aspect);
        across.max(beyond(center.y, self.tan_half_fov)) <= shown
    }

    pub(super) fn horizontal_fov(&self, aspect: f64) -> f64 {
        2.0 * libm::atan(self.tan_half_fov * aspect)
    }

    pub(super) fn nearest_start(&self, point: DVec3, near: f64, aspect: f64) -> DVec3 {
        // Of the square around the lens, cut by the beam to the point in focus.
        let blur = self.lens.map_or(0.0, |lens| lens.radius * (1.0 - near / lens.focus_distance).abs());
        let half = near * self.tan_half_fov * DVec2::new(aspect, 1.0) + blur;
        point.truncate().clamp(-half, half).extend(near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIDDLE: DVec2 = DVec2::splat(0.5);

    fn lens(blades: u32) -> Perspective {
        let lens = ThinLens { radius: 0.3, focus_distance: 4.0, blades, rotation: 0.2 };
        Perspective { lens: Some(lens), ..Perspective::new(1.0).unwrap() }
    }

    #[test]
    fn corners_of_the_film_are_at_the_edges_of_the_field_of_view() {
        let pinhole = Perspective::new(1.0).unwrap();
        let corner = pinhole.ray(DVec2::ZERO, 2.0, MIDDLE);
        assert_eq!(corner.origin, DVec3::ZERO);
        let t = 0.5f64.tan();
        assert!(corner.along.abs_diff_eq(DVec3::new(-2.0 * t, t, 1.0), 1e-15));
        assert!((pinhole.horizontal_fov(2.0) - 2.0 * (2.0 * t).atan()).abs() < 1e-15);
        assert_eq!([0.0, PI, 7.0, f64::NAN].map(Perspective::new), [None; 4]);
    }

    #[test]
    fn rays_through_a_lens_meet_at_the_focus_distance_and_make_a_circle_elsewhere() {
        for (blades, film) in [(0, DVec2::new(0.2, 0.9)), (5, DVec2::new(0.7, 0.1))] {
            let thin = lens(blades);
            let middle = thin.ray(film, 1.5, MIDDLE);
            assert!(middle.origin.length() < 1e-15);
            let (mut widest, mut mean): (f64, DVec3) = (0.0, DVec3::ZERO);
            const SIDE: u32 = 40;
            for i in 0..SIDE * SIDE {
                let at = DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE)) / f64::from(SIDE - 1);
                let ray = thin.ray(film, 1.5, at);
                let in_focus = ray.origin + 4.0 * ray.along;
                assert!(in_focus.abs_diff_eq(4.0 * middle.along, 1e-14), "{in_focus}");
                // The circle of confusion of what is at depth d, in the plane there: R |d − f| / f.
                let there = ray.origin + 10.0 * ray.along - 10.0 * middle.along;
                (widest, mean) = (widest.max(there.length()), mean + there);
            }
            assert!((widest - 0.3 * 6.0 / 4.0).abs() < 1e-3, "{blades}: {widest}");
            assert!((mean / f64::from(SIDE * SIDE)).length() < 0.02, "{blades}: {mean}");
        }
    }

    #[test]
    fn the_start_nearest_to_a_point_is_on_the_lens_or_the_near_plane() {
        let pinhole = Perspective::new(1.0).unwrap();
        let point = DVec3::new(1.0, -7.0, 2.0);
        assert_eq!(pinhole.nearest_start(point, 0.0, 1.0), DVec3::ZERO);
        assert_eq!(lens(0).nearest_start(point, 0.0, 1.0), DVec3::new(0.3, -0.3, 0.0));
        let on_plane = pinhole.nearest_start(point, 2.0, 1.0);
        assert_eq!(on_plane, DVec3::new(1.0, -2.0 * pinhole.tan_half_fov, 2.0));
    }
}
