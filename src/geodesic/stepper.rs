//! What a stepper is: one explicit step of a scalar equation W″ = G(ξ, W), with an error estimate.
//!
//! References: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.1–II.5, II.14.

use crate::math::real::Real;

/// The end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial<R> {
    /// Change of W: exact to its own rounding, not to that of W.
    pub gain: R,
    /// dW/dξ.
    pub velocity: R,
    /// Estimated error of W.
    pub position_error: R,
    /// Estimated error of dW/dξ.
    pub velocity_error: R,
}

/// From what is known of a step to its error along the orbit, which is what remains: factors calibrated on random rays
/// around a hole, such that the error of a whole ray keeps within its tolerance (`tests/it/geodesics/tolerance.rs`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Power of the step length with which the estimate falls.
    pub order: u32,
    /// Factor on the stepper's own estimate times the step's relative length: it falls one order slower than the error.
    pub embedded: f64,
    /// Factor on the error across the orbit.
    pub undone: f64,
}

/// A one-step method.
pub trait Stepper: Copy + Send + Sync {
    /// Order of the method.
    const ORDER: u32;

    /// How its error is estimated.
    const ESTIMATE: Estimate;

    /// One step of length `h` from ξ = 0, given W, dW/dξ and G there.
    fn step<R: Real>(&self, force: impl Fn(R, R) -> R, start: [R; 3], h: R) -> Trial<R>;
}

/// Coefficients of a Runge–Kutta method of `S` stages, the last of them at the end of the step \[H, II.1\].
#[derive(Clone, Copy, Debug)]
pub struct RungeKutta<const S: usize> {
    /// Nodes.
    pub c: [f64; S],
    /// Weights of earlier stages in each stage; the last row is the method itself.
    pub a: [[f64; S]; S],
    /// Weights of the error estimate.
    pub e: [f64; S],
}

/// Coefficients of a Nyström method of `S` stages, the last of them at the end of the step \[H, II.14\].
#[derive(Clone, Copy, Debug)]
pub struct Nystrom<const S: usize> {
    /// Nodes.
    pub c: [f64; S],
    /// Weights of earlier stages in each stage's position; the last row is the method's.
    pub a: [[f64; S]; S],
    /// Weights in the velocity.
    pub b: [f64; S],
    /// Weights of the error estimate of the position.
    pub e: [f64; S],
    /// Weights of the error estimate of the velocity.
    pub d: [f64; S],
}

/// Σ weights × values, over the first `count`.
#[inline(always)]
pub(super) fn sum<R: Real, const S: usize>(weights: &[f64; S], values: &[R; S], count: usize) -> R {
    // What is added to −0 stays what it is: no operation.
    let mut sum = R::of(-0.0);
    for j in 0..count {
        if weights[j] != 0.0 {
            sum = sum + R::of(weights[j]) * values[j];
        }
    }
    sum
}

impl<const S: usize> RungeKutta<S> {
    /// Change of W up to the last stage, and velocity and force of all stages.
    #[inline(always)]
    pub(super) fn stages<R: Real>(
        &self,
        force: impl Fn(R, R) -> R,
        [w, v, f]: [R; 3],
        h: R,
    ) -> (R, [R; S], [R; S]) {
        let (mut gain, mut velocities, mut forces) = (R::of(0.0), [v; S], [f; S]);
        let mut stage = |i: usize| {
            if i < S {
                gain = h * sum(&self.a[i], &velocities, i);
                velocities[i] = v + h * sum(&self.a[i], &forces, i);
                forces[i] = force(R::of(self.c[i]) * h, w + gain);
            }
        };
        const { assert!(S <= 13, "write out more stages") };
        // In parts: one loop over all is too large to be unrolled, and then lanes cannot run side by side.
        for i in 1..5 {
            stage(i);
        }
        for i in 5..9 {
            stage(i);
        }
        for i in 9..13 {
            stage(i);
        }
        (gain, velocities, forces)
    }

    /// One step with the estimate of weights `e`.
    #[inline(always)]
    pub(super) fn step<R: Real>(&self, force: impl Fn(R, R) -> R, start: [R; 3], h: R) -> Trial<R> {
        let (gain, velocities, forces) = self.stages(force, start, h);
        Trial {
            gain,
            velocity: velocities[S - 1],
            position_error: h * sum(&self.e, &velocities, S),
            velocity_error: h * sum(&self.e, &forces, S),
        }
    }
}

impl<const S: usize> Nystrom<S> {
    /// One step.
    #[inline(always)]
    pub(super) fn step<R: Real>(&self, force: impl Fn(R, R) -> R, [w, v, f]: [R; 3], h: R) -> Trial<R> {
        let h2 = h * h;
        let (mut gain, mut forces) = (R::of(0.0), [f; S]);
        for i in 1..S {
            let ch = R::of(self.c[i]) * h;
            // The last force comes last: what is known before is not waited for.
            let weights = &self.a[i];
            gain = ch * v;
            for j in 0..i {
                if weights[j] != 0.0 {
                    gain = gain + h2 * R::of(weights[j]) * forces[j];
                }
            }
            forces[i] = force(ch, w + gain);
        }
        Trial {
            gain,
            velocity: v + h * sum(&self.b, &forces, S),
            position_error: h2 * sum(&self.e, &forces, S),
            velocity_error: h * sum(&self.d, &forces, S),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    fn close(sum: f64, exact: f64, what: &str) {
        assert!((sum - exact).abs() < 2e-14, "{what}: {sum} for {exact}");
    }

    /// Σ weights c^power = `exact`, up to cancellation.
    fn moment<const S: usize>(weights: &[f64; S], c: &[f64; S], power: u32, exact: f64) {
        let terms = || weights.iter().zip(c).map(|(w, c)| w * c.powi(power as i32));
        let scale = 1.0 + terms().map(f64::abs).sum::<f64>();
        close(terms().sum::<f64>() / scale, exact / scale, &format!("power {power}"));
    }

    /// Nodes, the quadrature conditions of a method of this order, and those of the one that its estimate compares with
    /// \[H, II.2\].
    pub fn check_runge_kutta<const S: usize>(tableau: &RungeKutta<S>, order: u32, lower: u32) {
        for i in 0..S {
            moment(&tableau.a[i], &tableau.c, 0, tableau.c[i]);
            assert!(tableau.a[i][i..].iter().all(|&a| a == 0.0), "row {i} is not explicit");
        }
        for power in 0..order {
            moment(&tableau.a[S - 1], &tableau.c, power, 1.0 / f64::from(power + 1));
        }
        for power in 0..lower {
            moment(&tableau.e, &tableau.c, power, 0.0);
        }
    }

    /// The same of a Nyström method: row sums are c²/2, and weights integrate 1 − s and 1 \[H, II.14\].
    pub fn check_nystrom<const S: usize>(tableau: &Nystrom<S>, order: u32, lower: [u32; 2]) {
        for i in 0..S {
            moment(&tableau.a[i], &tableau.c, 0, 0.5 * tableau.c[i] * tableau.c[i]);
            assert!(tableau.a[i][i..].iter().all(|&a| a == 0.0), "row {i} is not explicit");
        }
        for power in 0..order {
            let k = f64::from(power);
            moment(&tableau.b, &tableau.c, power, 1.0 / (k + 1.0));
            if power + 1 < order {
                moment(&tableau.a[S - 1], &tableau.c, power, 1.0 / ((k + 1.0) * (k + 2.0)));
            }
        }
        for power in 0..lower[0] {
            moment(&tableau.e, &tableau.c, power, 0.0);
        }
        for power in 0..lower[1] {
            moment(&tableau.d, &tableau.c, power, 0.0);
        }
    }
}
