//! Fehlberg's pair of order 5(4): six evaluations, and one at the end of the step. The solution of order 5 is carried
//! on.
//!
//! Reference: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.4, table 5.1
//! (E. Fehlberg 1969).

use super::stepper::{RungeKutta, StepErrorModel, Stepper, Trial};
use crate::math::real::Real;

/// Runge–Kutta–Fehlberg 4(5).
#[derive(Clone, Copy, Debug, Default)]
pub struct Rkf45;

const TABLEAU: RungeKutta<7> = RungeKutta {
    c: [0.0, 1.0 / 4.0, 3.0 / 8.0, 12.0 / 13.0, 1.0, 1.0 / 2.0, 1.0],
    a: [
        [0.0; 7],
        [1.0 / 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3.0 / 32.0, 9.0 / 32.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1932.0 / 2197.0, -7200.0 / 2197.0, 7296.0 / 2197.0, 0.0, 0.0, 0.0, 0.0],
        [439.0 / 216.0, -8.0, 3680.0 / 513.0, -845.0 / 4104.0, 0.0, 0.0, 0.0],
        [-8.0 / 27.0, 2.0, -3544.0 / 2565.0, 1859.0 / 4104.0, -11.0 / 40.0, 0.0, 0.0],
        [16.0 / 135.0, 0.0, 6656.0 / 12825.0, 28561.0 / 56430.0, -9.0 / 50.0, 2.0 / 55.0, 0.0],
    ],
    e: [
        16.0 / 135.0 - 25.0 / 216.0,
        0.0,
        6656.0 / 12825.0 - 1408.0 / 2565.0,
        28561.0 / 56430.0 - 2197.0 / 4104.0,
        -9.0 / 50.0 + 1.0 / 5.0,
        2.0 / 55.0,
        0.0,
    ],
};

impl Stepper for Rkf45 {
    const ORDER: u32 = 5;
    const ESTIMATE: StepErrorModel = StepErrorModel { order: 6, embedded: 5.0, undone: 0.0 };

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
