//! Taylor series of a ray around a hole that does not spin, in the inverse areal radius.
//!
//! With û = M/r and the parameter ψ of [`orbit`](super::orbit), in which the swept angle is bψ, a null ray of
//! Schwarzschild's and of Reissner and Nordström's spacetimes obeys an equation with a polynomial on the right:
//!
//! ```text
//! û″ = b² (−û + 3û² − 2e²û³),  e = Q/M,  with  û′² = M² − b²û²D,  D = 1 − 2û + e²û².
//! ```
//!
//! A step is its Taylor series, in x = ψ (b + M), with the harmonic part split off and summed in closed form: straight
//! lines are exact, and the last coefficients tell the length of the step. States between steps are those of all
//! steppers, in isotropic coordinates: with N = √D and the areal over the isotropic radius a = 2/(1 − û + N),
//!
//! ```text
//! w = aû/M,  dw/dû = n/M,  n = a/N.
//! ```

use super::orbit_stepper::OrbitStepper;
use super::{Control, Phase, Step, StepVerdict};
use crate::math::cauchy::{product, square};
use crate::math::fast_log2;
use crate::math::real::Real;
use crate::spacetime::{ConformallyFlat, StaticHole};

/// Steps by series of `P` coefficients.
#[derive(Clone, Copy, Debug)]
pub struct ArealSeries<const P: usize> {
    mass: f64,
    /// Isotropic radius of the horizon.
    h: f64,
    /// (Q/M)².
    e2: f64,
    /// Inverses of û at the outer and at the inner horizon.
    outer: f64,
    inner: f64,
    /// Largest error that a step's last coefficients may tell, radians.
    tolerance: f64,
}

/// Largest strain of a step, as its last coefficients tell.
const LARGEST_STRAIN: f64 = 0.02;
/// Part of the way to the horizon that a falling ray takes in a step at most.
const LONGEST_FALL: f64 = 0.98;
/// Way outwards at the rate at its start that a step takes at most, in û.
const LONGEST_RISE: f64 = 0.5;
/// Rounding of û′² + b²û²D, in that of one operation.
const ROUNDING: f64 = 16.0;
/// Rounding of a root of û, in that of its start.
const ROOTED: f64 = 64.0;

/// Calibration: tolerances of steps over those of rays, such that the error of a whole ray keeps within its tolerance,
/// for series of `powers` coefficients.
const fn calibration(powers: usize) -> f64 {
    match powers {
        ..=8 => 0.5,
        _ => 0.25,
    }
}

/// The series about a phase.
struct Expansion<R, const P: usize> {
    b: R,
    start: Phase<R>,
    /// û, and its derivative by x.
    u: R,
    rate: R,
    /// b/M.
    b_per_mass: R,
    /// dx/dψ, its inverse, and 1/M times it.
    scale: R,
    per_scale: R,
    scale_per_mass: R,
    /// Swept angle per x.
    omega: R,
    /// a and N.
    a: R,
    lapse: R,
    /// Coefficients of û, less its harmonic part.
    rest: [R; P],
}

/// The angle that a step sweeps, and its length.
struct Sweep<R> {
    /// Length in x.
    x: R,
    sin: R,
    cos: R,
    /// 1 − cos.
    versine: R,
    /// sin over its derivative by x at 0.
    reach: R,
    /// Length in ξ.
    h: R,
}

/// Sine of an angle over it, and cosine, of at most 0.85 either way, radians.
#[inline(always)]
pub(super) fn small_sinc_cos<R: Real>(x: R) -> (R, R) {
    let x2 = x * x;
    let term = |sum: R, per: f64| R::of(1.0) - x2 * R::of(1.0 / per) * sum;
    let one = R::of(1.0);
    let sin = term(term(term(term(term(term(term(one, 210.0), 156.0), 110.0), 72.0), 42.0), 20.0), 6.0);
    let cos =
        term(term(term(term(term(term(term(term(one, 240.0), 182.0), 132.0), 90.0), 56.0), 30.0), 12.0), 2.0);
    (sin, cos)
}

/// The angle of tangent `t`, over that: to 0.4 % for t up to 3 (Shafer's approximation).
#[inline(always)]
fn rough_angle_per_tangent<R: Real>(t: R) -> R {
    let root = (R::of(25.0) + R::of(80.0 / 3.0) * t * t).sqrt();
    R::of(8.0) / (R::of(3.0) + root)
}

impl<const P: usize> ArealSeries<P> {
    /// Series around `hole`, for rays of a `tolerance` in radians.
    pub fn new(hole: &StaticHole, tolerance: f64) -> Self {
        let StaticHole { mass, charge } = *hole;
        let root = ((1.0 - charge) * (1.0 + charge)).sqrt();
        let h = 0.5 * mass * root;
        let tolerance = calibration(P) * tolerance.max(Control::<f64>::least_tolerance());
        let e2 = charge * charge;
        Self { mass, h, e2, outer: 1.0 + root, inner: e2 / (1.0 + root), tolerance }
    }

    /// A step outwards, and true if it ends at infinity.
    #[inline(always)]
    pub fn outwards<R: Real>(&self, b: R, start: Phase<R>) -> (Step<R>, bool) {
        let expansion = self.expand(b, start);
        let widest = (R::of(3.0) / b).at_most(R::of(1e30));
        let longest = R::of(expansion.length(self, widest));
        let root = expansion.infinity();
        let reaches = (root <= longest) & (root > R::of(0.0));
        let step = expansion.step(self, &expansion.along(if reaches { root } else { longest }));
        let is_there = (step.end.w * R::of(self.mass)).abs() <= R::of(ROOTED * R::EPSILON) * expansion.u;
        (step, reaches & is_there)
    }

    #[inline(always)]
    fn expand<R: Real>(&self, b: R, start: Phase<R>) -> Expansion<R, P> {
        let (one, mass) = (R::of(1.0), R::of(self.mass));
        let (mass_w, hw) = (mass * start.w, R::of(self.h) * start.w);
        let a = one + mass_w + hw * hw;
        let (per_a, per_scale) = (one / a, one / (b + mass));
        let lapse = (one - hw) * (one + hw) * per_a;
        let omega = b * per_scale;
        let mut series = ArealCoefficients {
            u: [R::of(0.0); P],
            square: [R::of(0.0); P],
            rest: [R::of(0.0); P],
            omega2: omega * omega,
            e2: self.e2,
        };
        // û′ = M v/n.
        (series.u[0], series.u[1]) = (mass_w * per_a, mass * per_scale * (start.v * (lapse * per_a)));
        const { assert!(P <= 14, "write out more powers") };
        // Written out: only straight-line code runs lane beside lane.
        series.extend(0);
        series.extend(1);
        series.extend(2);
        series.extend(3);
        series.extend(4);
        series.extend(5);
        series.extend(6);
        series.extend(7);
        series.extend(8);
        series.extend(9);
        series.extend(10);
        series.extend(11);
        let per_mass = R::of(1.0 / self.mass);
        let b_per_mass = b * per_mass;
        Expansion {
            b,
            start,
            u: series.u[0],
            rate: series.u[1],
            b_per_mass,
            scale: b + mass,
            per_scale,
            scale_per_mass: one + b_per_mass,
            omega,
            a,
            lapse,
            rest: series.rest,
        }
    }
}

/// The series while it is made.
struct ArealCoefficients<R, const P: usize> {
    u: [R; P],
    square: [R; P],
    rest: [R; P],
    omega2: R,
    e2: f64,
}

impl<R: Real, const P: usize> ArealCoefficients<R, P> {
    /// The power n + 2.
    #[inline(always)]
    fn extend(&mut self, n: usize) {
        if n + 2 >= P {
            return;
        }
        self.square[n] = square(&self.u, n);
        let per = R::of(1.0 / ((n + 1) * (n + 2)) as f64) * self.omega2;
        let pull = R::of(3.0) * self.square[n] - R::of(2.0 * self.e2) * product(&self.square, &self.u, n);
        self.rest[n + 2] = (pull - self.rest[n]) * per;
        self.u[n + 2] = self.rest[n + 2] - (self.u[n] - self.rest[n]) * per;
    }
}

impl<R: Real, const P: usize> Expansion<R, P> {
    /// Length in x by the last two coefficients and, in the part of the chart that the series sees, at most `h` in ξ.
    #[inline(always)]
    fn length(&self, series: &ArealSeries<P>, h: R) -> f64 {
        let log2 = fast_log2::wide_log2;
        let root = |log2: i32, power: usize| (log2 as f32 * (1.0 / power as f32)) as i32;
        let size = |i: usize| self.rest[i].value().abs();
        let (b_per_mass, scale) = (self.b_per_mass.value(), self.scale_per_mass.value());
        let weight = b_per_mass + series.tolerance * ((P - 1) as f64 / LARGEST_STRAIN);
        let tolerance = log2(series.tolerance);
        // Rays that are nearly radial must not leave the chart: theirs is an error of the rate.
        let accurate = root(tolerance - log2(weight * size(P - 1)), P - 1);
        let accurate = accurate.min(root(tolerance - log2(weight * size(P - 2)), P - 2));
        // From a turning point every other coefficient is 0, and the last that is not may happen to be small, too: of one
        // before, the part of the tolerance that it has where coefficients fall evenly.
        let part = (tolerance as f32 * ((P - 4) as f32 / (P - 2) as f32)) as i32;
        let accurate = accurate.min(root(part - log2(weight * size(P - 4)), P - 4));
        let accurate = fast_log2::wide_exp2(accurate);
        // dû/dψ is at most M, which it is at the horizon.
        let (lapse, rate) = (self.lapse.value(), self.rate.value() * scale);
        let falls = rate > 0.0;
        let way = if falls { 2.0 * LONGEST_FALL * lapse * lapse } else { LONGEST_RISE };
        let fall = series.outer * (1.0 - series.inner * self.u.value()) * (1.0 + rate);
        let way = scale * way / if falls { fall } else { f64::MIN_POSITIVE - rate };
        let widest = self.scale.value() * (h * rough_angle_per_tangent(self.b * h)).value();
        accurate.at_most(way).at_most(widest)
    }

    /// û and its derivative after `x`.
    #[inline(always)]
    fn at(&self, sweep: &Sweep<R>) -> (R, R) {
        let &Sweep { x, sin, cos, reach, .. } = sweep;
        let (mut value, mut slope) = (R::of(0.0), R::of(0.0));
        for i in (2..P).rev() {
            value = value * x + self.rest[i];
            slope = slope * x + R::of(i as f64) * self.rest[i];
        }
        let rate = self.rate * cos - self.u * (self.omega * sin) + x * slope;
        (self.u * cos + self.rate * reach + x * x * value, rate)
    }

    /// Length in x to infinity, of a ray that moves outwards; anything where that is beyond the step.
    #[inline(always)]
    fn infinity(&self) -> R {
        // Where a straight line would be there; then Newton's method.
        let straight = self.u / -self.rate;
        let mut x = straight * rough_angle_per_tangent(straight * self.omega);
        let mut correct = || {
            let (u, rate) = self.at(&self.along(x));
            x = x - u / rate;
        };
        // Written out: only straight-line code runs lane beside lane.
        correct();
        correct();
        correct();
        correct();
        x
    }

    /// The sweep of a step of length `x`.
    #[inline(always)]
    fn along(&self, x: R) -> Sweep<R> {
        let angle = self.omega * x;
        let half = R::of(0.5) * angle;
        let (sinc, c) = small_sinc_cos(half);
        let s = half * sinc;
        let versine = R::of(2.0) * s * s;
        let (reach, cos) = (x * sinc * c, R::of(1.0) - versine);
        Sweep { x, sin: self.omega * reach, cos, versine, reach, h: reach * self.per_scale / cos }
    }

    /// The sweep of a step of length `h` in ξ.
    #[inline(always)]
    fn across(&self, h: R) -> Sweep<R> {
        let one = R::of(1.0);
        let t = self.b * h;
        let rough = R::of(t.value()) * rough_angle_per_tangent(R::of(t.value()));
        let half = R::of(0.5) * rough;
        let (sinc, c) = small_sinc_cos(half);
        let s = half * sinc;
        let (s, c) = (R::of(2.0) * s * c, one - R::of(2.0) * s * s);
        // Tangent of what is missing: at most 0.005.
        let missing = (t * c - s) / (c + t * s);
        let m2 = missing * missing;
        let angle = rough + missing * (one - m2 * (R::of(1.0 / 3.0) - R::of(0.2) * m2));
        let squared = one + t * t;
        let cos = squared.sqrt() / squared;
        let sin = t * cos;
        let way = self.scale * h;
        let per_tangent = if t > R::of(1e-9) { angle / t } else { one };
        Sweep { x: way * per_tangent, sin, cos, versine: sin * sin / (one + cos), reach: way * cos, h }
    }

    /// The step through a sweep.
    #[inline(always)]
    fn step(&self, series: &ArealSeries<P>, sweep: &Sweep<R>) -> Step<R> {
        let (zero, half, one, two) = (R::of(0.0), R::of(0.5), R::of(1.0), R::of(2.0));
        let &Sweep { x, sin, cos, versine, reach, h } = sweep;
        let (mut value, mut slope) = (zero, zero);
        for i in (2..P).rev() {
            value = value * x + self.rest[i];
            slope = slope * x + R::of(i as f64) * self.rest[i];
        }
        // The last term, an estimate of the error; a part of the one before, as every other may be 0.
        let mut last = (self.rest[P - 1].abs() * x + R::of(0.25) * self.rest[P - 2].abs()) * self.b_per_mass;
        for _ in 2..P {
            last = last * x;
        }
        let e2 = R::of(series.e2);
        // û less û₀ cos, and dû/dψ over M.
        let lift = self.rate * reach + x * x * value;
        let rate = (self.rate * cos - self.u * (self.omega * sin) + x * slope) * self.scale_per_mass;
        let u = self.u * cos + lift;
        // One step of Newton's method towards the constraint, along its gradient in units of û and 1.
        let metric = |u: R| (one - R::of(series.outer) * u) * (one - R::of(series.inner) * u);
        let bu = self.b_per_mass * u;
        let excess = rate * rate + bu * bu * metric(u) - one;
        let slope_u = bu * bu * (one - u * (R::of(3.0) - two * e2 * u));
        let scale = half / (slope_u * slope_u + rate * rate);
        // What may be rounding counts neither as an error nor as a way.
        let known = (excess.abs() - R::of(ROUNDING * R::EPSILON)).at_least(zero);
        let known_shift = known * scale;
        let undone = if excess > zero { known_shift } else { -known_shift };
        let lift = lift - undone * slope_u * u;
        let shift = excess * scale;
        let (u, rate) = (u - shift * slope_u * u, rate - shift * rate);
        // To isotropic coordinates, which end at the horizon.
        let squared = metric(u);
        let strain = if squared > zero { known_shift + known } else { R::of(f64::INFINITY) };
        let lapse = squared.sqrt();
        let (sum, lapses) = (one - u + lapse, self.lapse + lapse);
        let common = one / (sum * lapse * lapses);
        let inverse = common * lapses;
        let (a, n, per_lapse) = (two * inverse * lapse, two * inverse, inverse * sum);
        let per_mass = R::of(1.0 / series.mass);
        let w = a * u * per_mass;
        let h2w = R::of(series.h * series.h) * w;
        let rising = R::of(series.mass) + h2w * (R::of(3.0) - h2w * w);
        let pull = two * rising * (per_lapse * per_lapse * per_lapse);
        // a − a₀, without cancellation.
        let gain = lift - self.u * versine;
        let steeper = one + (two - e2 * (self.u + u)) * (common * sum * lapse);
        let more = half * self.a * a * gain * steeper;
        let per_n = half * lapse * sum;
        Step {
            b: self.b,
            start: self.start,
            end: Phase { w, v: n * rate, pull },
            per_index: per_n,
            rise: (a * lift + more * self.u * cos) * per_mass,
            h,
            cos,
            sin,
            embedded: last,
            undone: known_shift * (slope_u.abs() + rate * rate) * bu.abs(),
            drift: excess.abs(),
            strain,
            leverage: scale + scale,
        }
    }
}

impl<const P: usize> OrbitStepper for ArealSeries<P> {
    // No step is estimated before it is taken.
    const ORDER: u32 = 0;

    fn control<R: Real>(&self, control: &Control<R>) -> Control<R> {
        control.without_limits()
    }

    #[inline(always)]
    fn step<M: ConformallyFlat, R: Real>(&self, _: &M, b: R, start: Phase<R>, h: R) -> Step<R> {
        let expansion = self.expand(b, start);
        let x = R::of(expansion.length(self, h));
        expansion.step(self, &expansion.along(x))
    }

    #[inline(always)]
    fn part<M: ConformallyFlat, R: Real>(&self, _: &M, b: R, start: Phase<R>, h: R) -> Step<R> {
        let expansion = self.expand(b, start);
        expansion.step(self, &expansion.across(h))
    }

    fn parts<M: ConformallyFlat, R: Real>(&self, _: &M, b: R, start: Phase<R>) -> impl Fn(R) -> Step<R> {
        let expansion = self.expand(b, start);
        move |h| expansion.step(self, &expansion.across(h))
    }

    #[inline(always)]
    fn judge<R: Real>(
        &self,
        control: &Control<R>,
        step: &Step<R>,
        arc_error: R,
        _previous: R,
    ) -> StepVerdict<R> {
        control.judge_series(step, arc_error)
    }
}
