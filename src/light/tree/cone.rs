//! Cones of normals.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::emission::Emission;

/// The directions into which a cluster of emitters shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Unit vector in the middle of the normals.
    pub axis: DVec3,
    /// Half-angle of the normals around the axis, radians in [0, π].
    pub normals: f64,
    /// Half-angle around each normal into which light goes, radians in [0, π/2].
    pub emission: f64,
    /// True if light goes around the opposite axis alike.
    pub both_sides: bool,
}

impl Cone {
    /// Of one emitter.
    pub fn new(emission: &Emission) -> Self {
        Self {
            axis: emission.axis,
            normals: libm::acos(emission.cos_normals.clamp(-1.0, 1.0)),
            emission: libm::acos(emission.cos_emission.clamp(0.0, 1.0)),
            both_sides: emission.both_sides,
        }
    }

    /// A cone that holds both: the narrowest for the axes as they are, or as one of them turned round if light goes to
    /// both sides.
    pub fn union(self, other: Cone) -> Cone {
        let (wide, narrow) = if self.normals >= other.normals { (self, other) } else { (other, self) };
        let both_sides = wide.both_sides || narrow.both_sides;
        let union = Cone { emission: wide.emission.max(narrow.emission), both_sides, ..wide };
        let dot = wide.axis.dot(narrow.axis);
        let (dot, towards) = if both_sides && dot < 0.0 { (-dot, -narrow.axis) } else { (dot, narrow.axis) };
        // Accurate at any angle, as neither acos nor asin is.
        let between = libm::atan2(wide.axis.cross(towards).length(), dot);
        if (between + narrow.normals).min(PI) <= wide.normals {
            return union;
        }
        let normals = 0.5 * (wide.normals + between + narrow.normals);
        match (towards - dot * wide.axis).try_normalize() {
            Some(across) if normals < PI => {
                let (sin, cos) = libm::sincos(normals - wide.normals);
                Cone { axis: cos * wide.axis + sin * across, normals, ..union }
            }
            _ => Cone { normals: PI, ..union },
        }
    }

    /// The solid angle into which light goes, weighted by the cosine to the nearest normal: the orientation measure of
    /// \[C\], twice that for both sides.
    pub fn measure(&self) -> f64 {
        let o = self.normals;
        let w = (o + self.emission).min(PI);
        let (sin, cos) = libm::sincos(o);
        let around = FRAC_PI_2 * (2.0 * w * sin - libm::cos(o - 2.0 * w) - 2.0 * o * sin + cos);
        let side = TAU * (1.0 - cos) + around;
        if self.both_sides { 2.0 * side } else { side }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn cone(axis: DVec3, normals: f64, both_sides: bool) -> Cone {
        Cone { axis, normals, emission: FRAC_PI_2, both_sides }
    }

    /// True if a normal lies in the cone.
    fn holds(cone: &Cone, normal: DVec3) -> bool {
        let angle = cone.axis.cross(normal).length().atan2(cone.axis.dot(normal));
        angle <= cone.normals + 1e-12 || (cone.both_sides && PI - angle <= cone.normals + 1e-12)
    }

    #[test]
    fn a_union_of_cones_holds_the_normals_of_both() {
        let mut normals = Vec::new();
        for i in 0..2000 {
            let (a, b) = (i as f64 * 0.7, i as f64 * 1.3);
            normals.push(DVec3::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos()));
        }
        for (i, pair) in normals.chunks_exact(2).take(200).enumerate() {
            let widths = [0.0, 0.1, 1.0, 2.0, 3.0, PI];
            let a = cone(pair[0], widths[i % 6], i % 5 == 0);
            let b = cone(pair[1], widths[(i / 6) % 6], i % 7 == 0);
            let union = a.union(b);
            assert!((union.axis.length() - 1.0).abs() < 1e-14);
            for normal in normals.iter().chain(pair).filter(|&&n| holds(&a, n) || holds(&b, n)) {
                assert!(holds(&union, *normal), "{a:?} {b:?} {union:?} {normal}");
            }
        }
    }

    #[test]
    fn a_union_of_cones_is_no_wider_than_it_must_be() {
        let union = cone(DVec3::X, 0.1, false).union(cone(DVec3::Y, 0.3, false));
        assert!((union.normals - 0.5 * (FRAC_PI_2 + 0.4)).abs() < 1e-15);
        let one = cone(DVec3::X, 0.1, true);
        assert_eq!(one.union(cone(DVec3::NEG_X, 0.1, false)), one);
        assert_eq!(cone(DVec3::X, 0.0, false).union(cone(DVec3::NEG_X, 0.0, false)).normals, PI);
    }

    #[test]
    fn the_measure_of_a_flat_emitter_is_pi_and_that_of_a_sphere_4_pi() {
        assert!((cone(DVec3::X, 0.0, false).measure() - PI).abs() < 1e-14);
        assert!((cone(DVec3::X, 0.0, true).measure() - TAU).abs() < 1e-14);
        assert!((cone(DVec3::X, PI, false).measure() - 2.0 * TAU).abs() < 1e-14);
    }
}
