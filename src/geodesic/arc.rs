//! Arcs: the piece of a conic that stands in for a step when the scene is searched for hits.
//!
//! A ray in a spherically symmetric spacetime stays in a plane, and a conic in that plane has five degrees of freedom:
//! both ends and both tangents take four pairs of equations, and the last is the weight of the middle control point,
//! which is fitted to the curvature at the ends. Circles (the photon sphere) and Kepler's orbits (the weak field) are
//! conics, so arcs are exact there, and of order 5 elsewhere; a parabola through the same ends is of order 3. As a
//! rational Bézier curve a conic costs the intersector no more than a parabola.
//!
//! Reference: \[F\] Farin, "Curves and Surfaces for CAGD", ch. 12 (rational quadratics in standard form).

use glam::DVec3;

use super::{Phase, Step};
use crate::math::columns::columns;
use crate::math::quadrature::mean;
use crate::math::real::Real;

columns! {
    /// A rational quadratic Bézier curve in standard form, weights (1, w, 1):
    /// B(s) = ((1−s)² p0 + 2 s(1−s) w p1 + s² p2) / ((1−s)² + 2 s(1−s) w + s²).
    #[derive(PartialEq)]
    pub struct Arc => ArcBlock {
        /// Start.
        p0: DVec3,
        /// Intersection of the tangents at both ends.
        p1: DVec3,
        /// End.
        p2: DVec3,
        /// Weight of `p1`, positive.
        w: f64,
    }
}

impl Arc {
    /// Point at `s` in [0, 1].
    #[inline]
    pub fn point(&self, s: f64) -> DVec3 {
        let t = 1.0 - s;
        let (a, b, c) = (t * t, 2.0 * s * t * self.w, s * s);
        (a * self.p0 + b * self.p1 + c * self.p2) / (a + b + c)
    }

    /// dB/ds at `s`.
    #[inline(always)]
    pub fn velocity(&self, s: f64) -> DVec3 {
        let t = 1.0 - s;
        let sum = t * t + 2.0 * s * t * self.w + s * s;
        // Derivative of the quotient of two quadratics, in which the powers of order 3 cancel [F, 12.6].
        let (d01, d02, d12) = (self.p1 - self.p0, self.p2 - self.p0, self.p2 - self.p1);
        2.0 * (self.w * t * t * d01 + t * s * d02 + self.w * s * s * d12) / (sum * sum)
    }

    /// Parameter of the point that lies as far along the chord as `point`.
    #[inline(always)]
    pub fn parameter_beside(&self, point: DVec3) -> f64 {
        // Positions along the chord give a quadratic in s, with one root in [0, 1] for an arc that turns less than a
        // right angle.
        let chord = self.p2 - self.p0;
        let target = (point - self.p0).dot(chord);
        let (middle, end) = (self.w * ((self.p1 - self.p0).dot(chord) - target), chord.dot(chord) - target);
        // −target (1−s)² + 2 middle s(1−s) + end s² = 0.
        let root = (middle * middle + target * end).max(0.0).sqrt();
        let s = if middle >= 0.0 {
            target / (target + middle + root)
        } else {
            (root - middle) / (root - middle + end)
        };
        if s.is_finite() { s.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Length from the start to `s`, by quadrature of order 16.
    pub fn length(&self, s: f64) -> f64 {
        s * mean(|share| self.velocity(share * s).length())
    }

    /// Distance of the point farthest from the chord p0 p2.
    #[inline(always)]
    pub fn sagitta(&self) -> f64 {
        self.bow().length()
    }

    /// The way to the point farthest from the chord p0 p2, square to it.
    #[inline(always)]
    pub fn bow(&self) -> DVec3 {
        let chord = self.p2 - self.p0;
        let off = self.p1 - self.p0;
        let length2 = chord.length_squared();
        let along = if length2 > 0.0 { off.dot(chord) / length2 } else { 0.0 };
        self.w / (1.0 + self.w) * (off - along * chord)
    }

    /// The two halves, each in standard form: the left one first \[F, 12.4\].
    pub fn halves(&self) -> (Arc, Arc) {
        let w = self.w;
        let left = (self.p0 + w * self.p1) / (1.0 + w);
        let right = (w * self.p1 + self.p2) / (1.0 + w);
        let middle = 0.5 * (left + right);
        let w = (0.5 * (1.0 + w)).sqrt();
        (Arc { p0: self.p0, p1: left, p2: middle, w }, Arc { p0: middle, p1: right, p2: self.p2, w })
    }
}

/// A step and its arc in the plane of the orbit: coordinates from the start, along the radius there and across it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneArc<R> {
    /// Middle control point.
    pub middle: [R; 2],
    /// End.
    pub end: [R; 2],
    /// Weight of the middle control point.
    pub weight: R,
    /// Estimated distance between the arc and the curve; infinite if the step turns too far to be one arc.
    pub error: R,
}

impl<R: Real> PlaneArc<R> {
    /// The arc in space, for a step that starts at `start`, with unit vectors along the radius there and across it.
    #[inline(always)]
    pub fn placed(&self, start: DVec3, radial: DVec3, along: DVec3) -> Arc {
        let place = |[x, y]: [R; 2]| start + x.value() * radial + y.value() * along;
        Arc { p0: start, p1: place(self.middle), p2: place(self.end), w: self.weight.value() }
    }
}

impl<R: Real> Step<R> {
    /// Displacement from the step's start to its end, along the radius at the start and across it: good to the rounding
    /// of the step's own length, however far the centre.
    #[inline(always)]
    pub fn displacement(&self) -> [R; 2] {
        let (w0, w1) = (self.start.w, self.end.w);
        // cos/w1 − 1/w0, and sin/w1, by one division.
        let inverse = R::of(1.0) / (w0 * w1);
        [-self.rise * inverse, self.sin * w0 * inverse]
    }

    /// Momentum at the end, along the radius at the start and across it.
    #[inline(always)]
    pub fn end_momentum(&self) -> [R; 2] {
        let [outwards, across] = self.end.momentum(self.b);
        [outwards * self.cos - across * self.sin, outwards * self.sin + across * self.cos]
    }
}

/// Turn below which a step is fitted with a parabola, in roundings: the tangents meet too ill-conditioned there.
const SMALL_TURN: f64 = 1e4;

/// The arc that stands in for `step`.
#[inline(always)]
pub fn fit_arc<R: Real>(step: &Step<R>) -> PlaneArc<R> {
    let (zero, half, one) = (R::of(0.0), R::of(0.5), R::of(1.0));
    let (start, end, b) = (&step.start, &step.end, step.b);
    // The chord, in a unit that drops out of the skew: what takes long to divide by is not waited for.
    let (chord_x, chord_y) = (-step.rise, step.sin * start.w);
    let unit = one / (start.w * end.w);
    let (x, y) = (chord_x * unit, chord_y * unit);
    // Tangents as long as the index, which drops out of the conic.
    let [t0x, t0y] = start.momentum(b);
    let [t1x, t1y] = step.end_momentum();
    // Sines of the turn and of the angles of the tangents to the chord, times the lengths of both.
    let turn = t0x * t1y - t0y * t1x;
    let (at_start, at_end) = (t0x * chord_y - t0y * chord_x, chord_x * t1y - chord_y * t1x);
    let (skew, reverse) = (at_start / at_end, at_end / at_start);
    let (at_start, at_end) = (at_start * unit, at_end * unit);
    let bending = |phase: &Phase<R>| phase.pull * b * (phase.w * phase.w * phase.w);
    let (bending0, bending1) = (bending(start), bending(end));
    // Curvature of the conic at either end is turn × far leg / (2 w² near leg²) [F, 12.6], where the legs are
    // at_end / turn and at_start / turn: the weight is fitted to the product of both curvatures.
    let fitted = (bending0 * bending1 * skew).sqrt();
    let root = (R::of(2.0) * fitted * at_end.abs()).sqrt();
    let inverse = one / (turn * root);
    let (leg, weight) = (at_end * root * inverse, turn * turn.abs() * inverse);
    let n0 = start.index(b);
    // The index changes little over a step that turns so little.
    let bent = turn.abs() > R::of(SMALL_TURN * R::EPSILON) * n0 * n0;
    let ahead = t0x * t1x + t0y * t1y > zero;
    let conic = bent & ahead & (at_start * turn > zero) & (at_end * turn > zero) & (fitted > zero);
    // Curvatures off by ±Δ at the ends part the curves by 0.009 Δ L² (quintic beam).
    let (per_n0, per_n1) = (one / n0, step.per_index);
    let (per_n0_cubed, per_n1_cubed) = (per_n0 * per_n0 * per_n0, per_n1 * per_n1 * per_n1);
    let off0 = (fitted * skew - bending0.abs()).abs() * per_n0_cubed;
    let off1 = (fitted * reverse * reverse - bending1.abs()).abs() * per_n1_cubed;
    // Where both ends agree, what is left is of how the pull varies between them: with the field's strength, and with
    // how far the radius turns from its straight course. The factor is measured around a hole.
    let curvatures = bending0 * per_n0_cubed + bending1 * per_n1_cubed;
    let turned = (start.pull + end.pull) * (start.v - end.v) * step.h * step.sin * (per_n0 * per_n1);
    let off = R::of(0.009) * off0.at_least(off1) + R::of(7e-5) * (curvatures * turned).abs();
    let conic_error = off * (x * x + y * y);
    // The cubic part s(1−s)(1−2s)/2 of the Hermite interpolant is at most 0.0481.
    let (at_start, at_end) = (at_start * per_n0, at_end * per_n1);
    let parabola_error =
        R::of(0.0481) * (at_start - at_end).abs() + if bent { R::of(f64::INFINITY) } else { zero };
    // Both are computed and one is chosen, so that lanes can run side by side.
    let pick = |a: R, b: R| if conic { a } else { b };
    // Half the chord, and to its right as far as the mean slope carries.
    let slope = R::of(0.25) * (at_start + at_end) * per_n0;
    PlaneArc {
        middle: [pick(leg * t0x, half * x + slope * t0y), pick(leg * t0y, half * y - slope * t0x)],
        end: [x, y],
        weight: pick(weight, one),
        error: pick(conic_error, parabola_error),
    }
}
