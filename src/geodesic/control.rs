//! Step size from error estimates.

use glam::DVec3;

use super::{Arc, Step, fit_arc};
use crate::spacetime::ConformallyFlat;

/// What a step is held to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Largest error of a step's direction, radians.
    pub tolerance: f64,
    /// Largest distance between an arc and the curve, scene units.
    pub arc_tolerance: f64,
}

/// Bounds on how a step may grow or shrink from one to the next.
const GROWTH: (f64, f64) = (0.2, 5.0);
/// Aims a little below the tolerance, so that most steps are accepted.
const SAFETY: f64 = 0.85;

impl Control {
    /// Fits the arc to `step` and judges both: the arc, the error relative to what is allowed (accept up to 1), and the
    /// length in σ to try next.
    #[inline(always)]
    pub fn judge(&self, step: &Step) -> (Arc, f64, f64) {
        let (arc, arc_error) = fit_arc(step);
        let direction = (step.momentum_error.length_squared() / step.end[1].length_squared()).sqrt();
        // The sum, unlike the larger, keeps the NaN of a step that left the chart, and NaN is never accepted.
        let error = direction / self.tolerance + arc_error / self.arc_tolerance;
        // Both estimates fall with the fourth power of the step.
        let factor = SAFETY / error.sqrt().sqrt();
        let factor = if error.is_nan() { GROWTH.0 } else { factor.clamp(GROWTH.0, GROWTH.1) };
        (arc, error, step.h * factor)
    }

    /// A first step for a ray at `x` with momentum `p`: the estimate's leading term in a field that changes slowly,
    /// taken where the straight continuation passes nearest to the centre.
    #[inline(always)]
    pub fn first_step<M: ConformallyFlat>(&self, medium: &M, x: DVec3, p: DVec3) -> f64 {
        let s = x.length_squared();
        let n2 = p.length_squared();
        let ahead = (-x.dot(p)).max(0.0) / n2;
        let length = |g: f64| (18.0 * self.tolerance).sqrt().sqrt() / g.sqrt();
        let reach = length(medium.pull(s)).min(ahead);
        let nearest = (x + reach * p).length_squared();
        length(medium.pull(nearest.max(0.25 * s)))
    }
}
