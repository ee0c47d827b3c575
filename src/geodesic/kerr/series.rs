//! Taylor series of a ray about a state, with the harmonic part split off.
//!
//! For each of u and N, δ is the series less that of harmonics of the frequency ω, computed directly so that nothing
//! cancels: where there is no hole δ = 0, and what is summed in closed form is the straight line.

use glam::DVec3;

use super::constants::Constants;
use super::hole::UnitHole;
use super::state::MinoState;
use crate::math::cauchy::{product, square};
use crate::math::sin_cos_turns;

/// Coefficients of powers 0 to `P` − 1 of λ.
#[derive(Clone, Copy, Debug)]
pub struct Series<const P: usize> {
    /// State at λ = 0.
    pub start: MinoState,
    /// Frequency of the harmonic part, √(J² + a²μ²).
    pub omega: f64,
    /// 1/ω; of no use where ω is 0.
    per_omega: f64,
    /// Of u, less its harmonic part.
    pub u: [f64; P],
    /// Of N, less its harmonic part.
    pub n: [[f64; P]; 3],
    /// Of G, up to the power P − 3.
    pub winding: [f64; P],
}

/// Sum from power 2 on at `h`, and its derivative.
#[inline(always)]
fn sums<const P: usize>(series: &[f64; P], h: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for i in (2..P).rev() {
        value = value * h + series[i];
        slope = slope * h + i as f64 * series[i];
    }
    (h * h * value, h * slope)
}

/// The whole series while it is made.
struct Coefficients<const P: usize> {
    u: [f64; P],
    n: [[f64; P]; 3],
    u_squared: [f64; P],
    mu_squared: [f64; P],
    numerator: [f64; P],
    denominator: [f64; P],
    /// Those that are kept.
    kept: Series<P>,
    /// 1 / denominator₀.
    per_denominator: f64,
    omega2: f64,
    hole: UnitHole,
    constants: Constants,
}

impl<const P: usize> Coefficients<P> {
    /// The powers n + 2 of u and N, and n of G.
    #[inline(always)]
    fn extend(&mut self, n: usize) {
        if n + 2 >= P {
            return;
        }
        let Constants { l, k, kappa, .. } = self.constants;
        let a2 = self.hole.a * self.hole.a;
        let per = 1.0 / ((n + 1) * (n + 2)) as f64;
        self.u_squared[n] = square(&self.u, n);
        self.mu_squared[n] = square(&self.n[2], n);
        let mu0_squared = self.mu_squared[0];
        let omega2 = self.omega2;
        // With ω² = J² + a²μ₀² and k² = J² − a².
        let pull = 3.0 * k * self.u_squared[n] - 2.0 * kappa * product(&self.u_squared, &self.u, n);
        let kept = &mut self.kept;
        let linear = a2 * (1.0 + mu0_squared) * self.u[n] - omega2 * kept.u[n];
        kept.u[n + 2] = (linear + pull) * per;
        self.u[n + 2] = kept.u[n + 2] - omega2 * (self.u[n] - kept.u[n]) * per;
        for axis in 0..3 {
            let kept = &mut self.kept.n[axis];
            let c = self.n[axis][n];
            let cubic = product(&self.mu_squared, &self.n[axis], n);
            let along = if axis == 2 { c } else { 0.0 };
            kept[n + 2] = (a2 * (mu0_squared * c - 2.0 * cubic + along) - omega2 * kept[n]) * per;
            self.n[axis][n + 2] = kept[n + 2] - omega2 * (c - kept[n]) * per;
        }
        // G is a quotient: of Ku² and p + v where the ray falls, else of p − v and D.
        let falls = self.kept.start.v > 0.0;
        let constant = if n == 0 { 1.0 } else { 0.0 };
        let p = constant + self.hole.a * (self.hole.a - l) * self.u_squared[n];
        let v = (n + 1) as f64 * self.u[n + 1];
        let d = constant - 2.0 * self.u[n] + (a2 + self.hole.e2) * self.u_squared[n];
        self.numerator[n] = if falls { k * self.u_squared[n] } else { p - v };
        self.denominator[n] = if falls { p + v } else { d };
        if n == 0 {
            self.per_denominator = 1.0 / self.denominator[0];
        }
        let mut rest = self.numerator[n];
        // The last ones, which the next ones wait for, come in last.
        for i in (1..n + 1).rev() {
            rest -= self.denominator[i] * self.kept.winding[n - i];
        }
        self.kept.winding[n] = rest * self.per_denominator;
    }
}

/// A state after λ, and how it came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesPoint {
    /// The state, without its constraints restored and without the winding.
    pub state: MinoState,
    /// Change of u, to its own rounding.
    pub rise: f64,
    /// Change of N, to its own rounding, without the winding.
    pub way: DVec3,
    /// Winding about the axis, radians.
    pub winding: f64,
}

impl<const P: usize> Series<P> {
    /// The series of a ray about `start`.
    #[inline(always)]
    pub fn new(hole: &UnitHole, constants: &Constants, start: &MinoState) -> Self {
        let &MinoState { u, v, n, m } = start;
        // From the constants: with |N′|² itself, errors of N would act on u.
        let omega2 = constants.j2 + hole.a * hole.a * n.z * n.z;
        let mut first = [0.0; P];
        let mut firsts = [[0.0; P]; 3];
        (first[0], first[1]) = (u, v);
        for (axis, (n, m)) in n.to_array().into_iter().zip(m.to_array()).enumerate() {
            (firsts[axis][0], firsts[axis][1]) = (n, m);
        }
        let omega = omega2.max(0.0).sqrt();
        let kept = Self {
            start: *start,
            omega,
            per_omega: 1.0 / omega,
            u: [0.0; P],
            n: [[0.0; P]; 3],
            winding: [0.0; P],
        };
        let mut whole = Coefficients {
            u: first,
            n: firsts,
            u_squared: [0.0; P],
            mu_squared: [0.0; P],
            numerator: [0.0; P],
            denominator: [0.0; P],
            kept,
            per_denominator: 0.0,
            omega2,
            hole: *hole,
            constants: *constants,
        };
        const { assert!(P <= 20, "write out more powers") };
        // Written out: only straight-line code runs lane beside lane.
        whole.extend(0);
        whole.extend(1);
        whole.extend(2);
        whole.extend(3);
        whole.extend(4);
        whole.extend(5);
        whole.extend(6);
        whole.extend(7);
        whole.extend(8);
        whole.extend(9);
        whole.extend(10);
        whole.extend(11);
        whole.extend(12);
        whole.extend(13);
        whole.extend(14);
        whole.extend(15);
        whole.extend(16);
        whole.extend(17);
        whole.kept
    }

    /// Length of λ over which u changes by `change`, in the sense in which it changes at the start: by its speed and
    /// acceleration there.
    #[inline(always)]
    pub fn fall_by(&self, change: f64) -> f64 {
        let MinoState { u, v, .. } = self.start;
        let acceleration = 2.0 * self.u[2] - self.omega * self.omega * u;
        let speed2 = v * v + 2.0 * acceleration * change;
        let speed = v.abs() + if speed2 > 0.0 { speed2 } else { 0.0 }.sqrt();
        2.0 * change.abs() / (speed + f64::MIN_POSITIVE)
    }

    /// The ray after `h`, for ω|h| up to 1.7.
    #[inline(always)]
    pub fn at(&self, hole: &UnitHole, h: f64) -> SeriesPoint {
        let MinoState { u, v, n, m } = self.start;
        let angle = self.omega * h;
        let (s, c) = sin_cos_turns::small(0.5 * angle);
        // 1 − cos, sin/ω.
        let versine = 2.0 * s * s;
        let sine = 2.0 * s * c;
        let ratio = sine * self.per_omega;
        let reach = if angle.abs() > 1e-9 { ratio } else { h };
        let (du, dv) = sums(&self.u, h);
        let rise = v * reach - u * versine + du;
        let v_end = (v - v * versine) - u * (self.omega * sine) + dv;
        let [x, y, z] = &self.n;
        let ((dx, dmx), (dy, dmy), (dz, dmz)) = (sums(x, h), sums(y, h), sums(z, h));
        let way = reach * m - versine * n + DVec3::new(dx, dy, dz);
        let m_end = (m - versine * m) - (self.omega * sine) * n + DVec3::new(dmx, dmy, dmz);
        let mut turns = 0.0;
        for i in (0..P - 2).rev() {
            turns = turns * h + self.winding[i] * (1.0 / (i + 1) as f64);
        }
        let winding = hole.a * (turns * h - h);
        SeriesPoint { state: MinoState { u: u + rise, v: v_end, n: n + way, m: m_end }, rise, way, winding }
    }
}
