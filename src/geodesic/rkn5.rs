//! Nyström's method of order 5 for x'' = f(x): four evaluations a step, the first of
//! them inherited from the step before; one more, at the end, starts the next step.
//!
//! Reference: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.14, table 14.2
//! (E. J. Nyström 1925).

use glam::DVec3;

use super::stepper::{Step, Stepper};
use crate::spacetime::ConformallyFlat;

/// Nyström, order 5.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rkn5;

impl Stepper for Rkn5 {
    #[inline(always)]
    fn step<M: ConformallyFlat>(&self, medium: &M, start: [DVec3; 3], h: f64) -> Step {
        let [x, p, f1] = start;
        let h2 = h * h;
        let f2 = medium.force(x + h / 5.0 * p + h2 / 50.0 * f1);
        let f3 = medium.force(x + 2.0 / 3.0 * h * p + h2 / 27.0 * (7.0 * f2 - f1));
        let f4 = medium.force(x + h * p + h2 / 70.0 * (21.0 * f1 - 4.0 * f2 + 18.0 * f3));
        let end = x + h * p + h2 / 336.0 * (14.0 * f1 + 100.0 * f2 + 54.0 * f3);
        let free = p + h / 336.0 * (14.0 * f1 + 125.0 * f2 + 162.0 * f3 + 35.0 * f4);
        Step::finish(medium, start, h, (end, free), (f4, 35.0 / 336.0))
    }

    fn reach(&self, tolerance: f64) -> f64 {
        (44.0 * tolerance).sqrt().sqrt()
    }

    /// Measured past a point mass: the kick of a step is off by 0.016 stride⁷ r_s/ρ, taken at ρ = 10 r_s.
    fn stride(&self, tolerance: f64) -> f64 {
        (640.0 * tolerance).powf(1.0 / 7.0)
    }
}
