//! Thin lenses: where rays go through them.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::math::concentric::concentric;
use crate::math::sin_cos_turns::sin_cos;

/// A lens whose rays from a point of the film meet at the distance that is in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Radius of the opening, of its corners if it has blades, scene units.
    pub radius: f64,
    /// Distance along the view direction of what is in focus, scene units.
    pub focus_distance: f64,
    /// Blades that leave a regular polygon open; 0 for a round opening.
    pub blades: u32,
    /// Angle of the polygon's first corner from the right, counter-clockwise as the camera sees it, radians.
    pub rotation: f64,
}

impl ThinLens {
    /// Point of the opening for one of the unit square, evenly spread; the middle for the middle.
    pub(super) fn point(&self, square: DVec2) -> DVec2 {
        let [distance, turns] = concentric(square.x, square.y);
        let way = if self.blades == 0 {
            on_circle(turns)
        } else {
            // Along the edges as the azimuth goes: areas of triangles stay in proportion to those of sectors.
            let along = turns * f64::from(self.blades);
            let corner = along.floor();
            let [one, next] = [corner, corner + 1.0].map(|corner| self.corner(corner));
            one.lerp(next, along - corner)
        };
        self.radius * distance.sqrt() * way
    }

    fn corner(&self, number: f64) -> DVec2 {
        let turns = number / f64::from(self.blades) + self.rotation / TAU;
        on_circle(turns - turns.floor())
    }
}

fn on_circle(turns: f64) -> DVec2 {
    let (sin, cos) = sin_cos(turns);
    DVec2::new(cos, sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_the_polygon_between_the_blades_evenly() {
        for blades in [3u32, 5, 8] {
            let lens = ThinLens { radius: 2.0, focus_distance: 1.0, blades, rotation: 0.4 };
            const SIDE: u32 = 300;
            let points = (0..SIDE * SIDE).map(|i| {
                let at = DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE)) + 0.5;
                lens.point(at / f64::from(SIDE))
            });
            // Of a regular polygon of circumradius R: ∫ r² dA / A = R² (2 + cos(2π/n)) / 6.
            let inside = 2.0 * (std::f64::consts::PI / f64::from(blades)).cos();
            let (mut moment, mut mean) = (0.0, DVec2::ZERO);
            for point in points {
                for edge in 0..blades {
                    let middle = (f64::from(edge) + 0.5) * TAU / f64::from(blades) + 0.4;
                    let beyond = point.dot(DVec2::new(middle.cos(), middle.sin())) - inside;
                    assert!(beyond < 1e-12, "{blades}: {point}");
                }
                (moment, mean) = (moment + point.length_squared(), mean + point);
            }
            let count = f64::from(SIDE * SIDE);
            let expected = 4.0 * (2.0 + (TAU / f64::from(blades)).cos()) / 6.0;
            assert!((moment / count / expected - 1.0).abs() < 1e-3, "{blades}: {}", moment / count);
            assert!((mean / count).length() < 1e-3, "{blades}: {mean}");
        }
    }
}
