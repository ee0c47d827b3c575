//! The classical Runge–Kutta method of order 4: four evaluations, and one at the end of the step.
//!
//! Reference: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.1, table 1.2
//! (W. Kutta 1901).

use super::stepper::{RungeKutta, StepErrorModel, Stepper, Trial};
use crate::math::real::Real;

/// Kutta's classical method, order 4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rk4;

/// The estimate compares the last stage of the method with the slope at the end of the step, O(h³) apart.
const TABLEAU: RungeKutta<5> = RungeKutta {
    c: [0.0, 0.5, 0.5, 1.0, 1.0],
    a: [
        [0.0; 5],
        [0.5, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.5, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0],
        [1.0 / 6.0, 2.0 / 6.0, 2.0 / 6.0, 1.0 / 6.0, 0.0],
    ],
    e: [0.0, 0.0, 0.0, -1.0 / 6.0, 1.0 / 6.0],
};

impl Stepper for Rk4 {
    const ORDER: u32 = 4;
    const ESTIMATE: StepErrorModel = StepErrorModel { order: 5, embedded: 1.0, undone: 4.0 };

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
    use super::super::stepper::tests::check_runge_kutta;
    use super::*;

    #[test]
    fn the_coefficients_meet_their_conditions() {
        check_runge_kutta(&TABLEAU, 4, 3);
    }
}
