//! Sphere against line and arc.

use super::{Line, Sphere};
use crate::geodesic::Arc;
use crate::math::bernstein::{first_sign_change, positive};

/// First crossing of `sphere` by `line`.
///
/// In f64 throughout: walls that are spheres of radius 1e5 lose their shape in f32.
#[inline(always)]
pub fn cross_line(line: &Line, sphere: &Sphere, leaves: bool) -> Option<f64> {
    let along = line.p2 - line.p0;
    let from = line.p0 - sphere.center;
    let a = along.length_squared();
    let b = from.dot(along);
    if leaves {
        // |from| is the radius: a s² + 2 b s = 0 has the other root −2b/a. At the very end it counts: from there on,
        // the sphere is left for a segment that starts on it.
        let s = -2.0 * b / a;
        return (s > 0.0 && s <= 1.0).then_some(s);
    }
    let r2 = sphere.radius * sphere.radius;
    let c = from.length_squared() - r2;
    let end = (line.p2 - sphere.center).length_squared() - r2;
    let outside = positive(c);
    if outside == positive(end) && (!outside || b >= 0.0 || b <= -a) {
        return None;
    }
    // Distance of the line from the centre, without the cancellation of b² − a c (Hearn & Baker; RTG I, ch. 7).
    let nearest = from - (b / a) * along;
    let half2 = a * (r2 - nearest.length_squared());
    if outside == positive(end) && half2 <= 0.0 {
        return None;
    }
    let q = -(b + half2.max(0.0).sqrt().copysign(b));
    let towards = b.is_sign_negative();
    let s = if outside == towards { c / q } else { q / a };
    Some(s.clamp(0.0, 1.0))
}

/// First crossing of `sphere` by `arc`: the sign changes of a quartic.
#[inline(always)]
pub fn cross_arc(arc: &Arc, sphere: &Sphere, leaves: bool) -> Option<f64> {
    let w = arc.w;
    let (a, b, c) = (arc.p0 - sphere.center, arc.p1 - sphere.center, arc.p2 - sphere.center);
    // |homogeneous point|² − r² weight², in Bernstein form. A start on the sphere defines the radius, so that it is a
    // root exactly.
    let r2 = if leaves { a.length_squared() } else { sphere.radius * sphere.radius };
    if stays_clear(a.length_squared() - r2, r2, (b - a).length_squared().max((c - a).length_squared())) {
        return None;
    }
    let end = c.length_squared() - r2;
    let middle = (a.dot(c) - r2 + 2.0 * w * w * (b.length_squared() - r2)) * (1.0 / 3.0);
    let second = w * (b.dot(c) - r2);
    if leaves {
        // Divided by s: degree 3.
        let first = w * a.dot(b - a);
        return first_sign_change([4.0 * first, 2.0 * middle, 4.0 / 3.0 * second, end]);
    }
    first_sign_change([a.length_squared() - r2, w * (a.dot(b) - r2), middle, second, end])
}

/// Whether nothing within the distance √`reach2` of a point meets a sphere of squared radius `r2`, given |from centre|²
/// − r² of the point: the distance d of the point from the centre satisfies |d − r| > reach, without square roots.
#[inline(always)]
fn stays_clear(excess: f64, r2: f64, reach2: f64) -> bool {
    let beside = excess - reach2;
    let beyond = excess > reach2 || (excess < 0.0 && r2 > reach2);
    beyond && beside * beside > 4.0 * r2 * reach2
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_line_enters_leaves_and_misses() {
        let sphere = Sphere { center: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 };
        let line = |from: [f64; 3], to: [f64; 3]| Line { p0: from.into(), p2: to.into() };
        let close = |s: Option<f64>, e: f64| s.is_some_and(|s| (s - e).abs() < 1e-15);
        assert!(close(cross_line(&line([1.0, 2.0, 1.0], [1.0, 2.0, 5.0]), &sphere, false), 0.375));
        assert!(close(cross_line(&line([1.0, 2.0, 3.0], [1.0, 2.0, 5.0]), &sphere, false), 0.25));
        assert!(close(cross_line(&line([1.0, 2.0, 2.75], [1.0, 2.0, 3.75]), &sphere, false), 0.75));
        assert!(close(cross_line(&line([1.0, 2.0, 3.25], [1.0, 2.0, 4.25]), &sphere, false), 0.25));
        assert_eq!(cross_line(&line([1.0, 2.0, 4.0], [1.0, 2.0, 5.0]), &sphere, false), None);
        assert_eq!(cross_line(&line([1.6, 2.0, 1.0], [1.6, 2.0, 5.0]), &sphere, false), None);
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
                (Some(a), Some(b)) => {
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
    fn a_point_stays_clear_of_a_sphere_when_its_reach_ends_before_it() {
        for (distance, reach, clear) in [
            (5.0f64, 2.9, true),
            (5.0, 3.1, false),
            (0.5, 1.4, true),
            (0.5, 1.6, false),
            (0.5, 9.0, false),
            (2.0, 1e-3, false),
        ] {
            assert_eq!(
                stays_clear(distance * distance - 4.0, 4.0, reach * reach),
                clear,
                "{distance} {reach}"
            );
        }
    }

    #[test]
    fn a_chord_back_to_its_own_sphere_hits_and_its_start_does_not() {
        let sphere = Sphere { center: DVec3::ZERO, radius: 2.0 };
        let start = DVec3::new(0.0, -2.0, 0.0);
        // A parabola that rises from the bottom and falls back on it, inside the sphere's side.
        let arc = Arc { p0: start, p1: DVec3::new(0.5, 0.0, 0.0), p2: DVec3::new(1.0, -3.0, 0.0), w: 1.0 };
        let s = cross_arc(&arc, &sphere, true).expect("falls back on the sphere");
        assert!(s > 0.5 && (arc.point(s).length() - 2.0).abs() < 1e-12);
        let away = Arc { p0: start, p1: DVec3::new(0.1, -3.0, 0.0), p2: DVec3::new(0.3, -4.0, 0.0), w: 1.0 };
        assert_eq!(cross_arc(&away, &sphere, true), None);
    }

    #[test]
    fn walls_of_radius_1e5_are_hit_to_eleven_digits() {
        let wall = Sphere { center: DVec3::new(0.0, -1e5 - 52.0, 56.6), radius: 1e5 };
        let line = Line { p0: DVec3::new(3.0, 10.0, 50.0), p2: DVec3::new(9.0, -80.0, 40.0) };
        let hit = line.p0.lerp(line.p2, cross_line(&line, &wall, false).expect("hits"));
        assert!(((hit - wall.center).length() - 1e5).abs() < 2e-10);
        let arc = Arc { p0: line.p0, p1: DVec3::new(6.0, -30.0, 46.0), p2: line.p2, w: 1.0 };
        let hit = arc.point(cross_arc(&arc, &wall, false).expect("hits"));
        assert!(((hit - wall.center).length() - 1e5).abs() < 2e-10);
    }
}
