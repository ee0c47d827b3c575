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

use super::Step;

/// A rational quadratic Bézier curve in standard form, weights (1, w, 1):
/// B(s) = ((1−s)² p0 + 2 s(1−s) w p1 + s² p2) / ((1−s)² + 2 s(1−s) w + s²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Start.
    pub p0: DVec3,
    /// Where the tangents at both ends meet.
    pub p1: DVec3,
    /// End.
    pub p2: DVec3,
    /// Weight of `p1`, positive.
    pub w: f64,
}

impl Arc {
    /// Point at `s` in [0, 1].
    #[inline]
    pub fn point(&self, s: f64) -> DVec3 {
        let t = 1.0 - s;
        let (a, b, c) = (t * t, 2.0 * s * t * self.w, s * s);
        (a * self.p0 + b * self.p1 + c * self.p2) / (a + b + c)
    }

    /// Distance of the point farthest from the chord p0 p2.
    #[inline(always)]
    pub fn sagitta(&self) -> f64 {
        let chord = self.p2 - self.p0;
        let off = self.p1 - self.p0;
        let length2 = chord.length_squared();
        let height2 =
            if length2 > 0.0 { off.cross(chord).length_squared() / length2 } else { off.length_squared() };
        self.w / (1.0 + self.w) * height2.sqrt()
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

/// Turn below which a step is fitted with a parabola, radians: the tangents meet too ill-conditioned there.
const SMALL_TURN: f64 = 1e-5;

/// The arc that stands in for `step`, and the estimated distance between the two; infinite if the step turns too far
/// to be one arc.
#[inline(always)]
pub fn fit_arc(step: &Step) -> (Arc, f64) {
    let [x0, p0, f0] = step.start;
    let [x1, p1, f1] = step.end;
    let (n0, n1) = (p0.length(), p1.length());
    let (t0, t1) = (p0 / n0, p1 / n1);
    let turn = t0.cross(t1).length();
    let chord = x1 - x0;
    let (a0, a1) = (t0.dot(chord), t1.dot(chord));
    let c = t0.dot(t1);
    let to_start = (a0 - c * a1) / (turn * turn);
    let to_end = (a1 - c * a0) / (turn * turn);
    let (k0, k1) = (t0.cross(f0).length() / (n0 * n0), t1.cross(f1).length() / (n1 * n1));
    // Curvature of the conic at either end is turn × far leg / (2 w² near leg²) [F, 12.6].
    let (w0, w1) =
        (turn * to_end / (2.0 * k0 * to_start * to_start), turn * to_start / (2.0 * k1 * to_end * to_end));
    let w2 = (w0 * w1).sqrt();
    let bent = turn > SMALL_TURN;
    let meets = c > 0.0 && to_start > 0.0 && to_end > 0.0 && w2.is_finite() && w2 > 0.0;
    let conic = bent && meets;
    // Curvatures off by ±Δ at the ends part the curves by 0.009 Δ L² (quintic beam).
    let mismatch = (k0 * (w0 / w2 - 1.0)).abs().max((k1 * (w1 / w2 - 1.0)).abs());
    let conic_error = 0.009 * mismatch * chord.length_squared();
    let (v0, v1) = (step.h * p0, step.h * p1);
    let skew = v0 + v1 - 2.0 * chord;
    // The cubic part s(1−s)(1−2s)/2 of the Hermite interpolant is at most 0.0481.
    let parabola_error = if bent { f64::INFINITY } else { 0.0481 * (skew - skew.dot(t0) * t0).length() };
    // Both are computed and one is chosen, so that lanes can run side by side.
    let tangents_meet = 0.5 * (x0 + to_start * t0 + x1 - to_end * t1);
    let parabola = 0.5 * (x0 + x1) + 0.25 * (v0 - v1);
    let pick = |a: f64, b: f64| if conic { a } else { b };
    let middle = DVec3::new(
        pick(tangents_meet.x, parabola.x),
        pick(tangents_meet.y, parabola.y),
        pick(tangents_meet.z, parabola.z),
    );
    (Arc { p0: x0, p1: middle, p2: x1, w: pick(w2.sqrt(), 1.0) }, pick(conic_error, parabola_error))
}
