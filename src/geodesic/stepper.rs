//! What a stepper is: one explicit step of x'' = ½∇n²(x), with an error estimate.

use glam::DVec3;

use crate::spacetime::ConformallyFlat;

/// A step of a ray: both ends with momentum and force, and the step's length in σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Position, momentum and force at the start.
    pub start: [DVec3; 3],
    /// Position, momentum and force at the end.
    pub end: [DVec3; 3],
    /// Length in the ray parameter σ.
    pub h: f64,
    /// Estimated error of the momentum at the end.
    pub momentum_error: DVec3,
}

/// A one-step method.
pub trait Stepper: Copy + Send + Sync {
    /// One step of length `h` from position, momentum and force (½∇n² at the position).
    fn step<M: ConformallyFlat>(&self, medium: &M, start: [DVec3; 3], h: f64) -> Step;

    /// Step length at which the error estimate is about `tolerance`, times the root of the field's pull.
    fn reach(&self, tolerance: f64) -> f64;

    /// Step length relative to the distance from the centre at which the error that the estimate does not see is about
    /// `tolerance`: the estimate is of second order in the field, and where that is weak the error is that of the
    /// quadrature along a nearly straight ray, of first order.
    fn stride(&self, tolerance: f64) -> f64;
}

impl Step {
    /// The step to `end` with unconstrained momentum `free`, given the last stage `last_force`, evaluated near the end,
    /// and its weight in the momentum.
    ///
    /// The momentum is scaled to |p| = n: the null constraint is unstable where the index falls steeply. The force at
    /// the end itself, which the next step starts with, differs from the last stage by that stage's error: their
    /// weighted difference, O(h⁴), bounds the momentum's, which is of the method's own order.
    #[inline(always)]
    pub(super) fn finish<M: ConformallyFlat>(
        medium: &M,
        start: [DVec3; 3],
        h: f64,
        (end, free): (DVec3, DVec3),
        (last_force, weight): (DVec3, f64),
    ) -> Step {
        let s = end.length_squared();
        let force = end * -medium.pull(s);
        let momentum = free * (medium.index_squared(s) / free.length_squared()).sqrt();
        Step { start, end: [end, momentum, force], h, momentum_error: h * weight * (force - last_force) }
    }
}
