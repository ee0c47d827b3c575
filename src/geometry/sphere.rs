//! Sphere against line and arc.

use glam::DVec3;

use super::line::Line;
use super::primitives::Sphere;
use crate::geodesic::Arc;
use crate::math::bernstein::{first_sign_change, positive};
use crate::math::columns::columns;

/// First crossing of `sphere` by `line`; infinite if there is none.
///
/// In f64 throughout: walls that are spheres of radius 1e5 lose their shape in f32.
#[inline(always)]
pub fn cross_line(line: &Line, sphere: &Sphere, starts_on: bool) -> f64 {
    let along = line.p2 - line.p0;
    let from = line.p0 - sphere.center;
    let a = along.length_squared();
    let b = from.dot(along);
    let r2 = sphere.radius * sphere.radius;
    let c = from.length_squared() - r2;
    let end = (line.p2 - sphere.center).length_squared() - r2;
    let (outside, crosses) = (positive(c), positive(c) != positive(end));
    // Distance of the line from the centre, without the cancellation of b² − a c (Hearn & Baker; RTG I, ch. 7).
    let nearest = from - (b / a) * along;
    let half2 = a * (r2 - nearest.length_squared());
    let q = -(b + half2.max(0.0).sqrt().copysign(b));
    let s = if outside == b.is_sign_negative() { c / q } else { q / a };
    let dips = outside & (b < 0.0) & (b > -a) & (half2 > 0.0);
    let crossing = if crosses | dips { s.clamp(0.0, 1.0) } else { f64::INFINITY };
    // |from| is the radius: a s² + 2 b s = 0 has the other root −2b/a. At the very end it counts: from there on, the
    // sphere is left for a segment that starts on it.
    let other = -2.0 * b / a;
    let other = if (other > 0.0) & (other <= 1.0) { other } else { f64::INFINITY };
    if starts_on { other } else { crossing }
}

columns! {
    /// An arc as spheres see it: from its start.
    pub struct FromStart => FromStartBlock {
        /// Its start.
        start: DVec3,
        /// Middle control point, from the start.
        middle: DVec3,
        /// End, from the start.
        end: DVec3,
        /// |middle|².
        middle2: f64,
        /// middle · end.
        both: f64,
        /// |end|².
        end2: f64,
        /// Weight of the middle control point.
        w: f64,
    }
}

impl FromStart {
    /// Of `arc`.
    #[inline(always)]
    pub fn of(arc: &Arc) -> Self {
        let (middle, end) = (arc.p1 - arc.p0, arc.p2 - arc.p0);
        let (middle2, both, end2) = (middle.length_squared(), middle.dot(end), end.length_squared());
        Self { start: arc.p0, middle, end, middle2, both, end2, w: arc.w }
    }

    /// Polynomial that changes its sign where the arc crosses a sphere, as Bernstein coefficients: a quartic, the
    /// square of the distance from the centre less `radius2`, times the square of the weight. For an arc that
    /// `starts_on` the sphere, its start defines the radius, and the quartic is divided by its root there.
    #[inline(always)]
    pub fn along(&self, center: DVec3, radius2: f64, starts_on: bool) -> [f64; 5] {
        let Self { start, middle, end, middle2, both, end2, w } = *self;
        let from = start - center;
        let excess = from.length_squared() - radius2;
        let excess = if starts_on { 0.0 } else { excess };
        let (to_middle, to_end) = (from.dot(middle), from.dot(end));
        let first = w * (excess + to_middle);
        let at_middle = excess + (to_middle + to_middle) + middle2;
        let second = ((excess + to_end) + (w + w) * w * at_middle) * (1.0 / 3.0);
        let third = w * (excess + to_middle + to_end + both);
        let last = excess + (to_end + to_end) + end2;
        // Divided by s it is a cubic, whose degree is raised again.
        let cubic = [4.0 * first, second + second, 4.0 / 3.0 * third, last];
        let pick = |left: f64, whole: f64| if starts_on { left } else { whole };
        [
            pick(cubic[0], excess),
            pick(0.25 * cubic[0] + 0.75 * cubic[1], first),
            pick(0.5 * (cubic[1] + cubic[2]), second),
            pick(0.75 * cubic[2] + 0.25 * cubic[3], third),
            last,
        ]
    }
}

/// First crossing of `sphere` by `arc`; infinite if there is none.
#[inline(always)]
pub fn cross_arc(arc: &Arc, sphere: &Sphere, starts_on: bool) -> f64 {
    let radius2 = sphere.radius * sphere.radius;
    first_sign_change(FromStart::of(arc).along(sphere.center, radius2, starts_on)).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_enters_leaves_and_misses() {
        let sphere = Sphere { center: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 };
        let line = |from: [f64; 3], to: [f64; 3]| Line { p0: from.into(), p2: to.into() };
        let close = |s: f64, e: f64| (s - e).abs() < 1e-15;
        assert!(close(cross_line(&line([1.0, 2.0, 1.0], [1.0, 2.0, 5.0]), &sphere, false), 0.375));
        assert!(close(cross_line(&line([1.0, 2.0, 3.0], [1.0, 2.0, 5.0]), &sphere, false), 0.25));
        assert!(close(cross_line(&line([1.0, 2.0, 2.75], [1.0, 2.0, 3.75]), &sphere, false), 0.75));
        assert!(close(cross_line(&line([1.0, 2.0, 3.25], [1.0, 2.0, 4.25]), &sphere, false), 0.25));
        assert_eq!(cross_line(&line([1.0, 2.0, 4.0], [1.0, 2.0, 5.0]), &sphere, false), f64::INFINITY);
        assert_eq!(cross_line(&line([1.6, 2.0, 1.0], [1.6, 2.0, 5.0]), &sphere, false), f64::INFINITY);
        assert!(close(cross_line(&line([1.0, 2.0, 2.5], [1.0, 2.0, 4.5]), &sphere, true), 0.5));
    }

    #[test]
    fn a_straight_arc_crosses_where_its_line_does() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut hits = 0;
        for _ in 0..20_000 {
            let mut point = || DVec3::new(random(), random(), random());
            let (p0, p2, center) = (point(), point(), point());
            let sphere = Sphere { center, radius: 0.3 };
            let line = Line { p0, p2 };
            let arc = Arc { p0, p1: 0.5 * (p0 + p2), p2, w: 1.0 };
            match (cross_line(&line, &sphere, false), cross_arc(&arc, &sphere, false)) {
                (a, b) if a.is_finite() && b.is_finite() => {
                    hits += 1;
                    let off = line.p0.lerp(p2, a).distance(arc.point(b));
                    assert!(off < 1e-9, "{a} is not {b}: {off}");
                }
                (a, b) => assert_eq!(a, b, "{p0} {p2} {center}"),
            }
        }
        assert!(hits > 3000);
    }

    #[test]
    fn a_chord_back_to_its_own_sphere_hits_and_its_start_does_not() {
        let sphere = Sphere { center: DVec3::ZERO, radius: 2.0 };
        let start = DVec3::new(0.0, -2.0, 0.0);
        // A parabola that rises from the bottom and falls back on it, inside the sphere's side.
        let arc = Arc { p0: start, p1: DVec3::new(0.5, 0.0, 0.0), p2: DVec3::new(1.0, -3.0, 0.0), w: 1.0 };
        let s = cross_arc(&arc, &sphere, true);
        assert!(s.is_finite() && s > 0.5 && (arc.point(s).length() - 2.0).abs() < 1e-12);
        let away = Arc { p0: start, p1: DVec3::new(0.1, -3.0, 0.0), p2: DVec3::new(0.3, -4.0, 0.0), w: 1.0 };
        assert_eq!(cross_arc(&away, &sphere, true), f64::INFINITY);
    }

    #[test]
    fn walls_of_radius_1e5_are_hit_to_eleven_digits() {
        let wall = Sphere { center: DVec3::new(0.0, -1e5 - 52.0, 56.6), radius: 1e5 };
        let line = Line { p0: DVec3::new(3.0, 10.0, 50.0), p2: DVec3::new(9.0, -80.0, 40.0) };
        let hit = line.p0.lerp(line.p2, cross_line(&line, &wall, false));
        assert!(((hit - wall.center).length() - 1e5).abs() < 2e-10);
        let arc = Arc { p0: line.p0, p1: DVec3::new(6.0, -30.0, 46.0), p2: line.p2, w: 1.0 };
        let hit = arc.point(cross_arc(&arc, &wall, false));
        assert!(((hit - wall.center).length() - 1e5).abs() < 2e-10);
    }
}
