//! Nyström's method of order 4 for x'' = f(x), three evaluations a step and a fourth that the next step reuses.
//!
//! Reference: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", II.14, eq. (14.11) for
//! right-hand sides that do not depend on x'.

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
    /// Estimated error of the momentum at the end (one order lower than its true error).
    pub momentum_error: DVec3,
}

/// One step of length `h` from position `x`, momentum `p`, force `f` = ½∇n²(x).
///
/// The momentum at the end is scaled to |p| = n: the null constraint is unstable where the index falls steeply.
#[inline(always)]
pub fn rkn4<M: ConformallyFlat>(medium: &M, [x, p, f]: [DVec3; 3], h: f64) -> Step {
    let f2 = medium.force(x + 0.5 * h * p + 0.125 * h * h * f);
    let f3 = medium.force(x + h * p + 0.5 * h * h * f2);
    let end = x + h * p + h * h / 6.0 * (f + 2.0 * f2);
    let free = p + h / 6.0 * (f + 4.0 * f2 + f3);
    let s = end.length_squared();
    let end_force = end * -medium.pull(s);
    let momentum = free * (medium.index_squared(s) / free.length_squared()).sqrt();
    Step {
        start: [x, p, f],
        end: [end, momentum, end_force],
        h,
        // The third stage sits off the end by h³/12 x‴; Simpson's rule with the force at the end itself is of order 3.
        momentum_error: h / 6.0 * (end_force - f3),
    }
}
