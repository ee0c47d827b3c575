//! Dormand and Prince's pair of order 5(4): six evaluations a step, the seventh is the next step's first.
//!
//! Reference: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.5, table 5.2
//! (J. R. Dormand, P. J. Prince 1980).

use super::stepper::{RungeKutta, StepErrorModel, Stepper, Trial};
use crate::math::real::Real;

/// Dormand–Prince 5(4).
#[derive(Clone, Copy, Debug, Default)]
pub struct Dopri5;

const TABLEAU: RungeKutta<7> = RungeKutta {
    c: [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0],
    a: [
        [0.0; 7],
        [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0, 0.0],
        [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0, 0.0],
        [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0, 0.0],
        [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0, 0.0],
    ],
    e: [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0],
};

impl Stepper for Dopri5 {
    const ORDER: u32 = 5;
    const ESTIMATE: StepErrorModel = StepErrorModel { order: 6, embedded: 1.0, undone: 0.0 };

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
        check_runge_kutta(&TABLEAU, 5, 4);
    }
}
