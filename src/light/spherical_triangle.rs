//! Triangles as an onlooker nearby sees them: points even in solid angle.
//!
//! References: Arvo 1995, "Stratified Sampling of Spherical Triangles", SIGGRAPH; for the solid angle van Oosterom,
//! Strackee 1983, IEEE Trans. Biomed. Eng. 30(2).

use std::f64::consts::TAU;

use glam::DVec3;

use crate::math::half_turn::angle;
use crate::math::sin_cos_turns::sin_cos;

/// A triangle on the unit sphere around an onlooker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalTriangle {
    /// Unit directions to the corners.
    corners: [DVec3; 3],
    /// Sine and cosine of the angle at the first corner.
    angle: (f64, f64),
    /// Solid angle, steradian; 0 of one that is too far away, or that is seen from within or close to its plane.
    solid_angle: f64,
}

/// Area over squared distance from which on points even in solid angle are worth their time: from further away they are
/// nearly those that are even over the area.
const NEAR: f64 = 0.1;
/// Least and greatest solid angle of triangles that are not seen from within or close to their planes.
const SEEN: [f64; 2] = [1e-3, 6.22];

impl SphericalTriangle {
    /// The triangle with these corners as it is seen from `x`; straight-line code.
    #[inline(always)]
    pub fn seen([a, b, c]: [DVec3; 3], x: DVec3) -> Self {
        let square = ((a + b + c) / 3.0).distance_squared(x);
        let area2 = 0.25 * (b - a).cross(c - a).length_squared();
        let triangle = Self::new([a - x, b - x, c - x]);
        let [least, most] = SEEN;
        let solid_angle = triangle.solid_angle;
        let is_seen =
            (area2 >= NEAR * NEAR * square * square) & (solid_angle >= least) & (solid_angle < most);
        Self { solid_angle: if is_seen { solid_angle } else { 0.0 }, ..triangle }
    }

    /// The triangle between three directions of any length. Between corners in the same or opposite directions its solid
    /// angle is 0.
    #[inline(always)]
    fn new([a, b, c]: [DVec3; 3]) -> Self {
        let (a, b, c) = (a.normalize_or_zero(), b.normalize_or_zero(), c.normalize_or_zero());
        let (ab, bc, ca) = (a.dot(b), b.dot(c), c.dot(a));
        let volume = a.dot(b.cross(c)).abs();
        let (sin, cos) = (volume, bc - ab * ca);
        let length = (sin * sin + cos * cos).sqrt();
        let solid_angle = if length > 0.0 { 2.0 * angle(volume, 1.0 + ab + bc + ca) } else { 0.0 };
        Self { corners: [a, b, c], angle: (sin / length, cos / length), solid_angle }
    }

    /// True if points even in solid angle are worth their time.
    #[inline(always)]
    pub fn is_seen(&self) -> bool {
        self.solid_angle > 0.0
    }

    /// A unit direction, from two numbers in [0, 1); straight-line code.
    #[inline(always)]
    pub fn sample(&self, u: f64, v: f64) -> DVec3 {
        let ([a, b, c], (sin, cos)) = (self.corners, self.angle);
        // The great circle through b that cuts off the share u of the triangle meets the side from a to c in d.
        let (s, t) = sin_cos(u * self.solid_angle / TAU);
        let (s, t) = (s * cos - t * sin, t * cos + s * sin);
        let (p, q) = (t - cos, s + sin * a.dot(b));
        let along = ((q * t - p * s) * cos - q) / ((q * s + p * t) * sin);
        let d = towards(a, c, along.clamp(-1.0, 1.0));
        towards(b, d, 1.0 - v * (1.0 - d.dot(b)))
    }

    /// Density over the area where it is seen, with this unit normal, of the direction to a point at this offset.
    #[inline(always)]
    pub fn density(&self, offset: DVec3, normal: DVec3) -> f64 {
        let square = offset.length_squared();
        offset.dot(normal).abs() / (square * square.sqrt() * self.solid_angle)
    }
}

/// The unit vector whose cosine to the unit vector `from` is `cos`, on the way to the unit vector `to`.
#[inline(always)]
fn towards(from: DVec3, to: DVec3, cos: f64) -> DVec3 {
    let across = (to - to.dot(from) * from).normalize_or_zero();
    (cos * from + (1.0 - cos * cos).max(0.0).sqrt() * across).normalize()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use rand::rngs::Xoshiro256PlusPlus;
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn an_octant_has_an_eighth_of_the_sphere() {
        let octant = SphericalTriangle::new([DVec3::X, 2.0 * DVec3::Y, 3.0 * DVec3::Z]);
        assert!((octant.solid_angle - FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn parts_of_a_triangle_get_points_by_their_solid_angles() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let mut number = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        for round in 0..40 {
            let mut corner = || DVec3::new(number(-1.0, 1.0), number(-1.0, 1.0), number(0.05, 1.0));
            let corners = [corner(), corner(), corner()];
            let triangle = SphericalTriangle::seen(corners, DVec3::ZERO);
            if !triangle.is_seen() {
                continue;
            }
            let [a, b, c] = corners;
            let (ab, bc, ca) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
            let parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
            let holds = |part: &[DVec3; 3], direction: DVec3| {
                let [a, b, c] = *part;
                let sides = [a.cross(b), b.cross(c), c.cross(a)].map(|side| side.dot(direction));
                sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
            };
            const SIDE: usize = 200;
            let mut counts = [0.0; 4];
            for i in 0..SIDE * SIDE {
                let (u, v) = ((i / SIDE) as f64 + 0.5, (i % SIDE) as f64 + 0.5);
                let direction = triangle.sample(u / SIDE as f64, v / SIDE as f64);
                assert!(direction.is_normalized());
                for (count, part) in counts.iter_mut().zip(&parts) {
                    *count += f64::from(u8::from(holds(part, direction)));
                }
            }
            for (count, part) in counts.into_iter().zip(parts) {
                let share = SphericalTriangle::new(part).solid_angle / triangle.solid_angle;
                let found = count / (SIDE * SIDE) as f64;
                assert!((found - share).abs() < 0.01, "{round}: {found} for {share}");
            }
        }
    }

    #[test]
    fn what_is_far_away_or_seen_edge_on_is_not_worth_while() {
        let triangle = [DVec3::X, DVec3::Y, DVec3::ZERO];
        let is_seen = |corners, x| SphericalTriangle::seen(corners, x).is_seen();
        assert!(is_seen(triangle, DVec3::splat(0.2)));
        assert!(!is_seen(triangle, 10.0 * DVec3::Z));
        assert!(!is_seen(triangle, DVec3::new(1.0, 1.0, 0.0)));
        assert!(!is_seen(triangle, DVec3::new(0.3, 0.3, 0.0)));
        assert!(!is_seen([DVec3::X; 3], DVec3::ZERO));
    }
}
