//! Nyström's method of order 4: three evaluations, of which the first is inherited, and one at the end of the step.
//!
//! Reference: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.14.

use super::stepper::{Estimate, Nystrom, Stepper, Trial};
use crate::math::real::Real;

/// Nyström, order 4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rkn4;

/// The estimate compares the last stage of the method with the force at the end of the step, O(h⁴) apart.
const TABLEAU: Nystrom<4> = Nystrom {
    c: [0.0, 0.5, 1.0, 1.0],
    a: [[0.0; 4], [1.0 / 8.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [1.0 / 6.0, 2.0 / 6.0, 0.0, 0.0]],
    b: [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    e: [0.0; 4],
    d: [0.0, 0.0, -1.0 / 6.0, 1.0 / 6.0],
};

impl Stepper for Rkn4 {
    const ORDER: u32 = 4;
    const ESTIMATE: Estimate = Estimate { order: 5, embedded: 1.0, slow: true, undone: 10.0 };

    #[inline(always)]
    fn step<R: Real>(&self, force: impl Fn(R, R) -> R, start: [R; 3], h: R) -> Trial<R> {
        TABLEAU.step(force, start, h)
    }
}
