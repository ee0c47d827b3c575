//! Nyström's method of order 4 for x'' = f(x): three evaluations a step, the first of
//! them inherited from the step before; one more, at the end, starts the next step.
//!
//! Reference: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.14.

use glam::DVec3;

use super::stepper::{Step, Stepper};
use crate::spacetime::ConformallyFlat;

/// Nyström, order 4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rkn4;

impl Stepper for Rkn4 {
    #[inline(always)]
    fn step<M: ConformallyFlat>(&self, medium: &M, start: [DVec3; 3], h: f64) -> Step {
        let [x, p, f1] = start;
        let h2 = h * h;
        let f2 = medium.force(x + 0.5 * h * p + h2 / 8.0 * f1);
        let f3 = medium.force(x + h * p + 0.5 * h2 * f2);
        let end = x + h * p + h2 / 6.0 * (f1 + 2.0 * f2);
        let free = p + h / 6.0 * (f1 + 4.0 * f2 + f3);
        Step::finish(medium, start, h, (end, free), (f3, 1.0 / 6.0))
    }

    fn reach(&self, tolerance: f64) -> f64 {
        (18.0 * tolerance).sqrt().sqrt()
    }

    /// Measured past a point mass: the kick of a step is off by 0.04 stride⁵ r_s/ρ, taken at ρ = 10 r_s.
    fn stride(&self, tolerance: f64) -> f64 {
        (250.0 * tolerance).powf(1.0 / 5.0)
    }
}
