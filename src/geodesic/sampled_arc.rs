//! Arcs through a point of a curve, with an error that is measured at others: where points of the curve are cheap.
//!
//! As in [`fit_space_arc`](super::fit_space_arc) a conic takes both ends and both tangents, and its middle control
//! point lies halfway between where these pass each other; but the weight takes it through the point about halfway.
//! What is left of the error has two lobes, and a point of the curve under each tells it.

use glam::DVec3;

use super::SpaceArc;
use super::space_arc::{SMALL_TURN, select};

/// Least weight of a conic, and inverse of the largest: others are of tangents that meet by rounding.
const LEAST_WEIGHT: f64 = 1e-2;

/// The arc that stands in for the step along `chord` of a curve that goes through points at about a fifth, a half and
/// four fifths of the way, given its tangents at the start and at the end, of any length.
///
/// A curve that `starts_on` a surface keeps the tangent there: an arc that leaves on the other side than the curve may
/// miss what the curve meets.
#[inline(always)]
pub(crate) fn fit_sampled_arc(
    chord: DVec3,
    [early, halfway, late]: [DVec3; 3],
    [d0, d1]: [DVec3; 2],
    starts_on: bool,
) -> SpaceArc {
    // Across both tangents, as long as the sine of the turn times their lengths.
    let across = d0.cross(d1);
    let across2 = across.length_squared();
    let per_across2 = 1.0 / across2;
    // Where each tangent comes nearest to the other, in units of itself.
    let ahead = chord.cross(d1).dot(across) * per_across2;
    let behind = chord.cross(d0).dot(across) * -per_across2;
    let forwards = d0.dot(d1) > 0.0;
    let is_bent = across2 > SMALL_TURN * SMALL_TURN * (d0.length_squared() * d1.length_squared());
    let meets = is_bent & (ahead > 0.0) & (behind > 0.0);
    let first = ahead * d0;
    let met = select(starts_on, first, 0.5 * (first + chord - behind * d1));
    // Points of the conic have y² = 4 w² z x.
    let meeting = Axes::new(chord, met);
    let [z, y, x] = meeting.shares(halfway);
    let fitted = 0.5 * y / (z * x).sqrt();
    let is_beside = (meeting.middle > 0.0) & (meeting.middle < 1.0);
    let is_fitted = meets & is_beside & (fitted > LEAST_WEIGHT) & (fitted < 1.0 / LEAST_WEIGHT);
    // Else the parabola through the point halfway: both are computed and one is chosen, so that lanes can run side by
    // side.
    let level = 2.0 * halfway - 0.5 * chord;
    let tangential = (0.5 * chord.length_squared() / d0.dot(chord)) * d0;
    let middle = select(is_fitted, met, select(starts_on, tangential, level));
    let weight = if is_fitted { fitted } else { 1.0 };
    let axes = Axes::new(chord, middle);
    let four_weight2 = 4.0 * weight * weight;
    let (at_early, at_late) = (axes.distance2(four_weight2, early), axes.distance2(four_weight2, late));
    let beside = if at_early > at_late { at_early } else { at_late };
    let error = (beside + axes.distance2(four_weight2, halfway)).sqrt();
    SpaceArc { middle, weight, error: if forwards { error } else { f64::INFINITY } }
}

/// Axes of an arc: its chord, and what its middle control point is off that.
///
/// Methods, not closures: only what is inlined everywhere runs lane beside lane.
struct Axes {
    chord: DVec3,
    per_chord2: f64,
    bow: DVec3,
    per_bow2: f64,
    /// Part of the chord beside which the middle control point lies.
    middle: f64,
}

impl Axes {
    #[inline(always)]
    fn new(chord: DVec3, middle: DVec3) -> Self {
        let per_chord2 = 1.0 / chord.length_squared();
        let along = middle.dot(chord) * per_chord2;
        let bow = middle - along * chord;
        let per_bow2 = 1.0 / (bow.length_squared() + f64::MIN_POSITIVE);
        Self { chord, per_chord2, bow, per_bow2, middle: along }
    }

    /// Part of the chord beside which a point lies.
    #[inline(always)]
    fn along(&self, point: DVec3) -> f64 {
        point.dot(self.chord) * self.per_chord2
    }

    /// What a point is off the chord.
    #[inline(always)]
    fn aside(&self, point: DVec3) -> DVec3 {
        point - self.along(point) * self.chord
    }

    /// Shares of start, middle and end in a point.
    #[inline(always)]
    fn shares(&self, point: DVec3) -> [f64; 3] {
        // Without what is along the chord: beside that of a nearly straight arc, the bow is rounding.
        let y = self.aside(point).dot(self.bow) * self.per_bow2;
        let x = self.along(point) - y * self.middle;
        [1.0 - x - y, y, x]
    }

    /// Squared distance of a point from the conic, square to the chord: by a step of Newton's method.
    #[inline(always)]
    fn distance2(&self, four_weight2: f64, point: DVec3) -> f64 {
        let [z, y, x] = self.shares(point);
        let excess = y * y - four_weight2 * (z * x);
        let slope = 2.0 * y + four_weight2 * ((1.0 - self.middle) * x + self.middle * z);
        let on_conic = y - excess / slope;
        (self.aside(point) - on_conic * self.bow).length_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve with its derivative.
    type Curve = fn(f64) -> [DVec3; 2];

    /// The arc from `from` by `h`, and its largest distance from the curve.
    fn fitted(curve: Curve, from: f64, h: f64, starts_on: bool) -> (SpaceArc, f64) {
        let ([x0, d0], [x1, d1]) = (curve(from), curve(from + h));
        let points = [0.2, 0.5, 0.8].map(|part| curve(from + part * h)[0] - x0);
        let arc = fit_sampled_arc(x1 - x0, points, [d0, d1], starts_on);
        (arc, arc.farthest(x0, x1, |part| curve(from + part * h)[0]))
    }

    fn circle(s: f64) -> [DVec3; 2] {
        let (x, y) = (DVec3::new(2.0, 1.0, -1.0).normalize(), DVec3::new(-1.0, 2.0, 0.0).normalize());
        [x * s.cos() + y * s.sin(), y * s.cos() - x * s.sin()]
    }

    fn hyperbola(s: f64) -> [DVec3; 2] {
        let of = |x: f64, y: f64| DVec3::new(x, 0.5 * y, 2.0 * x);
        [of(s.cosh(), s.sinh()), of(s.sinh(), s.cosh())]
    }

    fn helix(s: f64) -> [DVec3; 2] {
        [DVec3::new(s.cos(), s.sin(), 0.4 * s), DVec3::new(-s.sin(), s.cos(), 0.4)]
    }

    fn inflected(s: f64) -> [DVec3; 2] {
        [DVec3::new(s, s.powi(3), s * s), DVec3::new(1.0, 3.0 * s * s, 2.0 * s)]
    }

    fn wave(s: f64) -> [DVec3; 2] {
        [DVec3::new(s, s.sin(), 0.0), DVec3::new(1.0, s.cos(), 0.0)]
    }

    #[test]
    fn conics_are_their_own_sampled_arcs() {
        for h in [0.01, 0.3, 1.2] {
            for curve in [circle, hyperbola] {
                for starts_on in [false, true] {
                    let (arc, distance) = fitted(curve, 0.1, h, starts_on);
                    assert!(distance < 1e-13 && arc.error < 1e-13, "{h}: {distance:e} {arc:?}");
                }
            }
        }
    }

    #[test]
    fn the_measured_error_is_about_the_largest_distance() {
        for curve in [helix as Curve, inflected, wave] {
            for from in [-0.4, -0.1, 0.0, 0.3, 1.1] {
                for h in [0.02, 0.1, 0.4, 0.9] {
                    let (arc, distance) = fitted(curve, from, h, false);
                    println!("{from} {h}: {distance:e} {arc:?}");
                    assert!(distance < 1.5 * arc.error + 1e-15, "{from} {h}: {distance:e} {arc:?}");
                    assert!(arc.error < 3.0 * distance + 1e-7 * h, "{from} {h}: {distance:e} {arc:?}");
                }
            }
        }
    }

    #[test]
    fn an_arc_that_starts_on_a_surface_leaves_it_as_its_curve_does() {
        for curve in [helix as Curve, inflected, wave, circle] {
            for from in [-0.4, 0.0, 0.3, 1.1] {
                for h in [0.02, 0.1, 0.4, 0.9] {
                    let tangent = curve(from)[1].normalize();
                    let (arc, distance) = fitted(curve, from, h, true);
                    assert!(arc.middle.normalize().distance(tangent) < 1e-13, "{from} {h}: {arc:?}");
                    assert!(distance < 2.0 * arc.error + 1e-15, "{from} {h}: {distance:e} {arc:?}");
                }
            }
        }
    }

    #[test]
    fn a_straight_step_has_a_straight_sampled_arc() {
        let (chord, d) = (DVec3::new(1e9, 2e9, -3e9), DVec3::new(1.0, 2.0, -3.0));
        let points = [0.2 * chord, 0.5 * chord, 0.8 * chord];
        let arc = fit_sampled_arc(chord, points, [d, d], false);
        assert!((arc.middle - 0.5 * chord).length() < 1e-6, "{arc:?}");
        assert!(arc.weight == 1.0 && arc.error < 1e-6, "{arc:?}");
        assert!(fit_sampled_arc(chord, points, [d, -d], false).error == f64::INFINITY);
    }
}
