//! Steppers: one explicit step of W″ = G(ξ, W) with an error estimate, in as many dimensions as W has.
//!
//! Tableaux know nothing of the problem: [`Nystrom`] takes any W″ = G(ξ, W), [`RungeKutta`] any system of order `D`,
//! given as its first derivatives.
//!
//! References: \[H\] Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.1–II.5, II.14.

use crate::math::real::Real;

/// The end of a step, by component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial<R, const N: usize = 1> {
    /// Change of W: exact to its own rounding, not to that of W.
    pub gain: [R; N],
    /// dW/dξ.
    pub velocity: [R; N],
    /// Estimated error of W.
    pub position_error: [R; N],
    /// Estimated error of dW/dξ.
    pub velocity_error: [R; N],
}

/// From what is known of a step to its error along the orbit, which is what remains: factors calibrated on random rays
/// around a hole, such that the error of a whole ray keeps within its tolerance (`tests/it/geodesics/tolerance.rs`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepErrorModel {
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

    /// Estimate of its error.
    const ESTIMATE: StepErrorModel;

    /// One step of length `h` from ξ = 0, given W, dW/dξ and G there.
    fn step<R: Real, const N: usize>(
        &self,
        force: impl Fn(R, [R; N]) -> [R; N],
        start: [[R; N]; 3],
        h: R,
    ) -> Trial<R, N>;
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
pub(super) fn sum<R: Real, const N: usize, const S: usize>(
    weights: &[f64; S],
    values: &[[R; N]; S],
    count: usize,
) -> [R; N] {
    // Adding to −0 changes nothing: no operation.
    let mut sum = [R::of(-0.0); N];
    for j in 0..count {
        if weights[j] != 0.0 {
            for k in 0..N {
                sum[k] = sum[k] + R::of(weights[j]) * values[j][k];
            }
        }
    }
    sum
}

/// `scale` times a vector.
#[inline(always)]
pub(super) fn scaled<R: Real, const N: usize>(scale: R, mut vector: [R; N]) -> [R; N] {
    for component in &mut vector {
        *component = scale * *component;
    }
    vector
}

/// Sum of two vectors.
#[inline(always)]
pub(super) fn added<R: Real, const N: usize>(mut a: [R; N], b: [R; N]) -> [R; N] {
    for k in 0..N {
        a[k] = a[k] + b[k];
    }
    a
}

impl<const S: usize> RungeKutta<S> {
    /// One step of y′ = `slope`(ξ, y), given y and y′ at its start: change of y, and its estimated error. The `D`
    /// vectors of y are a position and its derivatives, or whatever else a system of first order is made of.
    #[inline(always)]
    pub(super) fn advance<R: Real, const N: usize, const D: usize>(
        &self,
        slope: impl Fn(R, [[R; N]; D]) -> [[R; N]; D],
        [start, first]: [[[R; N]; D]; 2],
        h: R,
    ) -> [[[R; N]; D]; 2] {
        let (mut gain, mut slopes) = ([[R::of(0.0); N]; D], [[[R::of(0.0); N]; S]; D]);
        for d in 0..D {
            slopes[d][0] = first[d];
        }
        let mut stage = |i: usize| {
            if i < S {
                let mut state = start;
                for d in 0..D {
                    gain[d] = scaled(h, sum(&self.a[i], &slopes[d], i));
                    state[d] = added(start[d], gain[d]);
                }
                let next = slope(R::of(self.c[i]) * h, state);
                for d in 0..D {
                    slopes[d][i] = next[d];
                }
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
        let mut error = gain;
        for d in 0..D {
            error[d] = scaled(h, sum(&self.e, &slopes[d], S));
        }
        [gain, error]
    }

    /// One step of W″ = G with the estimate of weights `e`.
    #[inline(always)]
    pub(super) fn step<R: Real, const N: usize>(
        &self,
        force: impl Fn(R, [R; N]) -> [R; N],
        [w, v, f]: [[R; N]; 3],
        h: R,
    ) -> Trial<R, N> {
        let slope = |xi: R, [w, v]: [[R; N]; 2]| [v, force(xi, w)];
        let [[gain, kick], [position_error, velocity_error]] = self.advance(slope, [[w, v], [v, f]], h);
        Trial { gain, velocity: added(v, kick), position_error, velocity_error }
    }
}

impl<const S: usize> Nystrom<S> {
    /// One step of W″ = G.
    #[inline(always)]
    pub(super) fn step<R: Real, const N: usize>(
        &self,
        force: impl Fn(R, [R; N]) -> [R; N],
        [w, v, f]: [[R; N]; 3],
        h: R,
    ) -> Trial<R, N> {
        let h2 = h * h;
        let (mut gain, mut forces) = ([R::of(0.0); N], [f; S]);
        for i in 1..S {
            let ch = R::of(self.c[i]) * h;
            // The last force comes last: what is known before is not waited for.
            let weights = &self.a[i];
            gain = scaled(ch, v);
            for j in 0..i {
                if weights[j] != 0.0 {
                    gain = added(gain, scaled(h2 * R::of(weights[j]), forces[j]));
                }
            }
            forces[i] = force(ch, added(w, gain));
        }
        Trial {
            gain,
            velocity: added(v, scaled(h, sum(&self.b, &forces, S))),
            position_error: scaled(h2, sum(&self.e, &forces, S)),
            velocity_error: scaled(h, sum(&self.d, &forces, S)),
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

    /// Nodes and quadrature conditions of a Nyström method, and those of its estimate: row sums are c²/2, and weights
    /// integrate 1 − s and 1 \[H, II.14\].
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

    #[test]
    fn a_tableau_steps_a_system_of_first_order_too() {
        // y′ = (−y₂, y₁): once around a circle.
        let slope = |_: f64, [[x, y]]: [[f64; 2]; 1]| [[-y, x]];
        let (steps, mut state) = (64, [[1.0, 0.0]]);
        let h = std::f64::consts::TAU / f64::from(steps);
        for _ in 0..steps {
            let [gain, error] = super::super::dop853::TABLEAU.advance(slope, [state, slope(0.0, state)], h);
            state = [added(state[0], gain[0])];
            assert!(error[0].iter().all(|error| error.abs() < 1e-6), "{error:?}");
        }
        let [[x, y]] = state;
        assert!((x - 1.0).hypot(y) < 1e-12, "{x} {y}");
    }
}
