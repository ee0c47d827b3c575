//! Arcs of curves that do not stay in a plane: one conic a step, with its torsion in the estimate of its error.
//!
//! As in the plane ([`Arc`]), a conic takes both ends, both tangents and, by the weight of its middle control point, the
//! product of both curvatures. The two tangents of a twisted curve do not meet: the middle control point lies halfway
//! between them, and what it is off by is of order 3.
//!
//! Reference: \[F\] Farin, "Curves and Surfaces for CAGD", ch. 12 (rational quadratics in standard form).

use glam::DVec3;

use super::Arc;

/// A conic from the origin to the end of a chord.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SpaceArc {
    /// Middle control point, from the start.
    pub middle: DVec3,
    /// Weight of the middle control point.
    pub weight: f64,
    /// Estimated distance between the arc and the curve; infinite if the step turns too far to be one arc.
    pub error: f64,
}

/// Turn below which a step is fitted with a parabola: the tangents meet too ill-conditioned there.
pub(super) const SMALL_TURN: f64 = 1e4 * f64::EPSILON;

/// One of two vectors: both are computed and one is chosen, so that lanes can run side by side.
#[inline(always)]
pub(super) fn select(first: bool, a: DVec3, b: DVec3) -> DVec3 {
    let pick = |a: f64, b: f64| if first { a } else { b };
    DVec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z))
}

/// The arc that stands in for the step along `chord` of a curve that goes `through` a point about halfway, given its
/// first and second derivatives at the start and at the end.
///
/// A curve that `starts_on` a surface keeps the tangent there: an arc that leaves on the other side than the curve may
/// miss what the curve meets.
#[inline(always)]
pub(crate) fn fit_space_arc(
    chord: DVec3,
    through: DVec3,
    [d0, dd0]: [DVec3; 2],
    [d1, dd1]: [DVec3; 2],
    starts_on: bool,
) -> SpaceArc {
    let length2 = chord.length_squared();
    let (per_d0, per_d1) = (1.0 / d0.length(), 1.0 / d1.length());
    // Across both tangents, as long as the sine of the turn times their lengths.
    let across = d0.cross(d1);
    let across2 = across.length_squared();
    let per_across2 = 1.0 / across2;
    // Where each tangent comes nearest to the other, in units of itself.
    let ahead = chord.cross(d1).dot(across) * per_across2;
    let behind = chord.cross(d0).dot(across) * -per_across2;
    let (bending0, bending1) = (d0.cross(dd0).length(), d1.cross(dd1).length());
    // Curvature of the conic at either end is that of the parabola over the squared weight [F, 12.6].
    let weight2 = (across2 / (4.0 * ahead * behind * bending0 * bending1)).sqrt();
    let weight = weight2.sqrt();
    let turn2 = across2 * (per_d0 * per_d0) * (per_d1 * per_d1);
    let forwards = d0.dot(d1) > 0.0;
    let conic = (turn2 > SMALL_TURN * SMALL_TURN)
        & forwards
        & (ahead > 0.0)
        & (behind > 0.0)
        & (weight > 0.0)
        & (weight < f64::INFINITY);
    let first = ahead * d0;
    let met = select(starts_on, first, 0.5 * (first + chord - behind * d1));
    let twisted = if starts_on { 0.2963 } else { 0.0962 };
    // Curvatures off by ±Δ at the ends part the curves by 0.009 Δ L² (quintic beam).
    let parabola0 = 0.5 * across2.sqrt() * behind / (ahead * ahead);
    let parabola1 = 0.5 * across2.sqrt() * ahead / (behind * behind);
    let off0 = (parabola0 / weight2 - bending0).abs() * (per_d0 * per_d0 * per_d0);
    let off1 = (parabola1 / weight2 - bending1).abs() * (per_d1 * per_d1 * per_d1);
    let off = if off0 > off1 { off0 } else { off1 };
    // The tangents pass each other at this distance; the cubic part s(1−s)(1−2s) of the Hermite interpolant is at most
    // 0.0962, that from the plane of the first tangent, 2s²(1−s), 0.2963.
    let twist = chord.dot(across).abs() * per_across2.sqrt();
    let conic_error = 0.009 * off * length2 + twisted * twist;
    // Directions at both ends, across the chord and as long as it.
    let length = length2.sqrt();
    let unit = chord * (1.0 / length);
    let beside = |direction: DVec3| length * (direction - direction.dot(unit) * unit);
    let (start, end) = (beside(d0 * per_d0), beside(d1 * per_d1));
    let parabola_error = 0.5 * twisted * (start + end).length();
    let level = 0.5 * chord + 0.25 * (start - end);
    let tangential = (0.5 * length2 / d0.dot(chord)) * d0;
    let pick = |a: f64, b: f64| if conic { a } else { b };
    let middle = select(conic, met, select(starts_on, tangential, level));
    let weight = pick(weight, 1.0);
    // Neither sees what is off alike on both sides: the point halfway does.
    let arc = Arc { p0: DVec3::ZERO, p1: middle, p2: chord, w: weight };
    let apart = through - arc.point(arc.parameter_beside(through));
    let apart = apart - apart.dot(unit) * unit;
    let error = pick(conic_error, parabola_error) + apart.length();
    SpaceArc { middle, weight, error: if forwards { error } else { f64::INFINITY } }
}

/// The point halfway, from the start, of the quintic that has the derivatives of a curve at both ends of a step by `h` of
/// its parameter along `chord`.
#[inline(always)]
pub(crate) fn halfway(h: f64, chord: DVec3, [d0, dd0]: [DVec3; 2], [d1, dd1]: [DVec3; 2]) -> DVec3 {
    0.5 * chord + (5.0 / 32.0 * h) * (d0 - d1) + (h * h / 64.0) * (dd0 + dd1)
}

#[cfg(test)]
impl SpaceArc {
    /// Largest distance from a curve between two points, of which `at` gives the point after a part of the step.
    pub(super) fn farthest(&self, start: DVec3, end: DVec3, at: impl Fn(f64) -> DVec3) -> f64 {
        let placed = Arc { p0: start, p1: start + self.middle, p2: end, w: self.weight };
        let distance = |i: u32| {
            let point = at(f64::from(i) / 64.0);
            let s = placed.parameter_beside(point);
            let velocity = placed.velocity(s).normalize();
            let way = point - placed.point(s);
            (way - way.dot(velocity) * velocity).length()
        };
        (1..64).map(distance).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve with its first two derivatives.
    type Curve = fn(f64) -> [DVec3; 3];

    /// The arc from `from` by `h`, its error, and its largest distance from the curve.
    fn fitted(curve: Curve, from: f64, h: f64) -> (SpaceArc, f64) {
        let ([x0, d0, dd0], [x1, d1, dd1]) = (curve(from), curve(from + h));
        let (start, end) = ([d0, dd0], [d1, dd1]);
        let arc = fit_space_arc(x1 - x0, halfway(h, x1 - x0, start, end), start, end, false);
        (arc, arc.farthest(x0, x1, |part| curve(from + part * h)[0]))
    }

    fn circle(s: f64) -> [DVec3; 3] {
        let (x, y) = (DVec3::new(2.0, 1.0, -1.0), DVec3::new(-1.0, 2.0, 0.0));
        let (x, y) = (x.normalize(), y.normalize());
        [x * s.cos() + y * s.sin(), y * s.cos() - x * s.sin(), -x * s.cos() - y * s.sin()]
    }

    fn hyperbola(s: f64) -> [DVec3; 3] {
        let of = |x: f64, y: f64| DVec3::new(x, 0.5 * y, 2.0 * x);
        [of(s.cosh(), s.sinh()), of(s.sinh(), s.cosh()), of(s.cosh(), s.sinh())]
    }

    fn helix(s: f64) -> [DVec3; 3] {
        [
            DVec3::new(s.cos(), s.sin(), 0.4 * s),
            DVec3::new(-s.sin(), s.cos(), 0.4),
            DVec3::new(-s.cos(), -s.sin(), 0.0),
        ]
    }

    fn inflected(s: f64) -> [DVec3; 3] {
        [
            DVec3::new(s, s.powi(3), s * s),
            DVec3::new(1.0, 3.0 * s * s, 2.0 * s),
            DVec3::new(0.0, 6.0 * s, 2.0),
        ]
    }

    fn wave(s: f64) -> [DVec3; 3] {
        [DVec3::new(s, s.sin(), 0.0), DVec3::new(1.0, s.cos(), 0.0), DVec3::new(0.0, -s.sin(), 0.0)]
    }

    #[test]
    fn conics_are_their_own_arcs() {
        for h in [0.01, 0.3, 1.2] {
            for curve in [circle, hyperbola] {
                let (_, distance) = fitted(curve, 0.1, h);
                assert!(distance < 1e-13, "{h}: {distance:e}");
            }
        }
    }

    #[test]
    fn the_estimate_bounds_the_distance_and_is_not_far_above() {
        for curve in [helix as Curve, inflected, wave] {
            for from in [-0.4, -0.1, 0.0, 0.3, 1.1] {
                for h in [0.02, 0.1, 0.4, 0.9] {
                    let (arc, distance) = fitted(curve, from, h);
                    println!("{from} {h}: {distance:e} {arc:?}");
                    assert!(distance < 1.5 * arc.error + 1e-15, "{from} {h}: {distance:e} {arc:?}");
                    assert!(arc.error < 40.0 * distance + 1e-7 * h, "{from} {h}: {distance:e} {arc:?}");
                }
            }
        }
    }

    #[test]
    fn a_straight_step_is_a_straight_arc() {
        let (chord, d) = (DVec3::new(1e9, 2e9, -3e9), DVec3::new(1.0, 2.0, -3.0));
        let arc = fit_space_arc(chord, 0.5 * chord, [d, DVec3::ZERO], [d, DVec3::ZERO], false);
        assert!(
            (arc.middle - 0.5 * chord).length() < 1e-6 && arc.weight == 1.0 && arc.error < 1e-6,
            "{arc:?}"
        );
        let back = fit_space_arc(chord, 0.5 * chord, [d, DVec3::ZERO], [-d, DVec3::ZERO], false);
        assert!(back.error == f64::INFINITY);
    }
}
