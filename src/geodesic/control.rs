//! Step size from error estimates.

use glam::DVec3;

use super::{Arc, Step, Stepper, fit_arc};
use crate::spacetime::ConformallyFlat;

/// What a step is held to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Largest error of a step's direction, radians.
    pub tolerance: f64,
    /// Largest distance between an arc and the curve, scene units.
    pub arc_tolerance: f64,
    /// Longest step relative to the distance from the centre.
    pub stride: f64,
}

/// A step, judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// The arc that stands in for the step.
    pub arc: Arc,
    /// Whether the step is good enough to be taken.
    pub accepted: bool,
    /// Length in σ to try next: from the step's end if it is taken, else from its start.
    pub next_h: f64,
}

/// Bounds on how a step may grow or shrink from one to the next, beside what the field's change asks for.
const GROWTH: (f64, f64) = (0.2, 1.7);
/// Aims a little below the tolerance, so that most steps are accepted.
const SAFETY: f64 = 0.85;
/// Longest step relative to the distance from the centre at any tolerance: an inward ray must not step past the centre
/// unnoticed.
const LONGEST_STRIDE: f64 = 0.5;

impl Control {
    /// Control of the steps that `stepper` takes.
    pub fn new(stepper: &impl Stepper, tolerance: f64, arc_tolerance: f64) -> Self {
        Self { tolerance, arc_tolerance, stride: stepper.stride(tolerance).min(LONGEST_STRIDE) }
    }

    /// Fits the arc to `step` and judges both.
    ///
    /// Good steps scale as the inverse root of the pull g of the field (the frequency of small oscillations), so the
    /// step's length is carried on in that unit: a ray that falls inwards shortens its steps ahead of the error.
    /// Measured on random rays around a hole, that leaves 0.2 rejected steps a ray instead of 2, and fewer accepted.
    #[inline(always)]
    pub fn judge(&self, step: &Step) -> Verdict {
        let (arc, arc_error) = fit_arc(step);
        let [x0, _, f0] = step.start;
        let [x1, p1, f1] = step.end;
        let direction = (step.momentum_error.length_squared() / p1.length_squared()).sqrt();
        // The sum, unlike the larger, keeps the NaN of a step that left the chart, and NaN is never accepted.
        let error = direction / self.tolerance + arc_error / self.arc_tolerance;
        let accepted = error <= 1.0;
        // Both estimates fall with the fourth power of the step.
        let factor = SAFETY / error.sqrt().sqrt();
        let factor = if error.is_nan() { GROWTH.0 } else { factor.clamp(GROWTH.0, GROWTH.1) };
        // (g at the start / g at the end)^½ with g = |f|/|x|.
        let pulls = f0.length_squared() * x1.length_squared() / (f1.length_squared() * x0.length_squared());
        let field = if accepted && pulls.is_finite() { pulls.sqrt().sqrt() } else { 1.0 };
        Verdict { arc, accepted, next_h: step.h * factor * field }
    }

    /// A step of at most `h` for a ray at `x` with momentum `p`, within the stride that the stepper can answer for.
    #[inline(always)]
    pub fn within_stride(&self, h: f64, x: DVec3, p: DVec3) -> f64 {
        h.min(self.stride * (x.length_squared() / p.length_squared()).sqrt())
    }

    /// A first step for a ray at `x` with momentum `p`: what the stepper reaches in a field that changes slowly, taken
    /// where the straight continuation passes nearest to the centre.
    #[inline(always)]
    pub fn first_step<M: ConformallyFlat>(
        &self,
        stepper: &impl Stepper,
        medium: &M,
        x: DVec3,
        p: DVec3,
    ) -> f64 {
        let s = x.length_squared();
        let reach = stepper.reach(self.tolerance);
        let ahead = (-x.dot(p)).max(0.0) / p.length_squared();
        let here = reach / medium.pull(s).sqrt();
        let nearest = (x + here.min(ahead) * p).length_squared();
        self.within_stride(reach / medium.pull(nearest.max(0.25 * s)).sqrt(), x, p)
    }
}
