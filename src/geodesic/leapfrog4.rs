//! Suzuki's symplectic method of order 4: five leapfrogs, five evaluations.
//!
//! Reference: \[S\] Suzuki 1990, "Fractal decomposition of exponential operators", Phys. Lett. A 146, 319. Hairer,
//! Lubich, Wanner, "Geometric Numerical Integration", 2nd ed., II.4, (4.5).

use super::stepper::{StepErrorModel, Stepper, Trial, added, scaled, sum};
use crate::math::real::Real;

/// Suzuki's composition of leapfrogs, order 4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leapfrog4;

/// 1/(4 − 4^⅓) \[S\].
const OUTER: f64 = 0.414_490_771_794_375_7;
/// Lengths of the leapfrogs, relative to the step's.
const LENGTHS: [f64; 5] = [OUTER, OUTER, 1.0 - 4.0 * OUTER, OUTER, OUTER];

/// Signs of the forces at 0 and where each leapfrog ends, for a second difference.
const CURVED: [f64; 6] = [1.0, -1.0, 0.0, 0.0, -1.0, 1.0];

impl Stepper for Leapfrog4 {
    const ORDER: u32 = 4;
    const ESTIMATE: StepErrorModel = StepErrorModel { order: 5, embedded: 0.02, undone: 12.0 };

    /// There is no second solution to compare with: the error is estimated by what the step violates of the constraint,
    /// which in a weak field may vanish by chance, and by how much the force curves, O(h⁴) in the position.
    #[inline(always)]
    fn step<R: Real, const N: usize>(
        &self,
        force: impl Fn(R, [R; N]) -> [R; N],
        [w, v, f]: [[R; N]; 3],
        h: R,
    ) -> Trial<R, N> {
        let (mut gain, mut velocity, mut kick, mut done) = ([R::of(0.0); N], v, f, 0.0);
        let mut forces = [f; 6];
        for (i, length) in LENGTHS.into_iter().enumerate() {
            let half = R::of(0.5 * length) * h;
            velocity = added(velocity, scaled(half, kick));
            gain = added(gain, scaled(R::of(length) * h, velocity));
            done += length;
            kick = force(R::of(done) * h, added(w, gain));
            forces[i + 1] = kick;
            velocity = added(velocity, scaled(half, kick));
        }
        let position_error = scaled(h * h, sum(&CURVED, &forces, 6));
        Trial { gain, velocity, position_error, velocity_error: [R::of(0.0); N] }
    }
}
