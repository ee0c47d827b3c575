//! Suzuki's symplectic method of order 4: five leapfrogs, five evaluations.
//!
//! Reference: \[S\] Suzuki 1990, "Fractal decomposition of exponential operators", Phys. Lett. A 146, 319. Hairer,
//! Lubich, Wanner, "Geometric Numerical Integration", 2nd ed., II.4, (4.5).

use super::stepper::{Estimate, Stepper, Trial};
use crate::math::real::Real;

/// Suzuki's composition of leapfrogs, order 4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leapfrog4;

/// 1/(4 − 4^⅓) \[S\].
const OUTER: f64 = 0.414_490_771_794_375_7;
/// Lengths of the leapfrogs, relative to the step's.
const LENGTHS: [f64; 5] = [OUTER, OUTER, 1.0 - 4.0 * OUTER, OUTER, OUTER];

impl Stepper for Leapfrog4 {
    const ORDER: u32 = 4;
    const ESTIMATE: Estimate = Estimate { order: 5, embedded: 0.0, slow: false, undone: 12.0 };

    /// There is no second solution to compare with: what the step violates of the constraint is all that is known of
    /// its error.
    #[inline(always)]
    fn step<R: Real>(&self, force: impl Fn(R, R) -> R, [w, v, f]: [R; 3], h: R) -> Trial<R> {
        let (mut gain, mut velocity, mut kick, mut done) = (R::of(0.0), v, f, 0.0);
        for length in LENGTHS {
            let half = R::of(0.5 * length) * h;
            velocity = velocity + half * kick;
            gain = gain + R::of(length) * h * velocity;
            done += length;
            kick = force(R::of(done) * h, w + gain);
            velocity = velocity + half * kick;
        }
        let none = R::of(0.0);
        Trial { gain, velocity, position_error: none, velocity_error: none }
    }
}
