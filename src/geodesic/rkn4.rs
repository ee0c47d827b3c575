//! Nyström's method of order 4: three evaluations, of which the first is inherited, and one at the end of the step.
//!
//! Reference: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.14.

use super::stepper::{Nystrom, StepErrorModel, Stepper, Trial};
use crate::math::real::Real;

/// Nyström, order 4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rkn4;

/// Weight of the second difference of the force, O(h⁴) in the position.
const CURVED: f64 = 0.02;

/// The estimate compares the last stage of the method with the force at the end of the step, O(h³) apart. In a weak
/// field they agree, and what the step violates of the constraint may vanish by chance: there the curvature of the
/// force is what is known of the error.
const TABLEAU: Nystrom<4> = Nystrom {
    c: [0.0, 0.5, 1.0, 1.0],
    a: [[0.0; 4], [1.0 / 8.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [1.0 / 6.0, 2.0 / 6.0, 0.0, 0.0]],
    b: [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    e: [CURVED, -2.0 * CURVED, 0.0, CURVED],
    d: [0.0, 0.0, -1.0 / 6.0, 1.0 / 6.0],
};

impl Stepper for Rkn4 {
    const ORDER: u32 = 4;
    const ESTIMATE: StepErrorModel = StepErrorModel { order: 5, embedded: 1.0, undone: 10.0 };

    #[inline(always)]
    fn step<R: Real, const N: usize>(
        &self,
        force: impl Fn(R, [R; N]) -> [R; N],
        start: [[R; N]; 3],
        h: R,
    ) -> Trial<R, N> {
        TABLEAU.step(force, start, h)
    }
}

#[cfg(test)]
mod tests {
    use super::super::stepper::tests::check_nystrom;
    use super::*;

    #[test]
    fn the_coefficients_meet_their_conditions() {
        check_nystrom(&TABLEAU, 4, [2, 1]);
    }
}
