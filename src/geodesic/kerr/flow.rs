//! Flow: where a ray is after a given λ, and the derivatives of that by its start.
//!
//! Plain Taylor series of the equations of motion in numbers that may carry a derivative. Nothing ends a ray: u may pass
//! 0 and become negative, beyond infinity, and a falling ray may cross the horizon, so that a search for a ray has no
//! edges.

use glam::DVec3;

use super::aim::KerrPlace;
use super::constants::Constants;
use super::hole::{UnitHole, about_axis, turned_by};
use super::launch::KerrLaunch;
use super::state::MinoState;
use crate::math::cauchy::product;
use crate::math::dual::Dual;
use crate::math::fast_log2;
use crate::math::real::Real;
use crate::spacetime::Fate;

/// Start of a ray in the direction of an observer at rest, and its derivatives by two changes of that direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowStart {
    launch: KerrLaunch,
    /// Constants of motion, without what keeps them off the barrier, and state: derivatives.
    slopes: [KerrLaunch; 2],
}

/// Where a ray is, with derivatives by two changes of its direction at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowEnd {
    /// State, turned by the winding.
    pub state: MinoState,
    /// Derivatives of u by the direction at the start.
    pub u_slopes: [f64; 2],
    /// Derivatives of N.
    pub n_slopes: [DVec3; 2],
    /// True if the ray came neither through infinity nor through the horizon.
    pub is_real: bool,
}

/// A ray's state in numbers of some kind; N without the winding, which is an angle beside it.
#[derive(Clone, Copy, Debug)]
struct Flow<T> {
    u: T,
    v: T,
    n: [T; 3],
    m: [T; 3],
    winding: T,
    is_real: bool,
}

/// Constants of motion that the equations need.
#[derive(Clone, Copy, Debug)]
struct FlowConstants<T> {
    l: T,
    k: T,
    j2: T,
    k2: T,
    kappa: T,
}

/// Coefficients of series, and error of their steps in radians, that are good to rounding.
const EXACT_POWERS: usize = 20;
const EXACT_TOLERANCE: f64 = 1e-17;
/// Coefficients of others.
const POWERS: usize = 10;
/// Tolerance from which on fewer coefficients are faster, radians.
const LOOSE: f64 = 1e-8;
/// Most steps: more than rays need that a Newton step has not led astray.
const MAX_STEPS: usize = 100;
/// Inverse radius, relative to the horizon's, within which a ray is astray.
const ASTRAY: f64 = 1.5;

impl FlowStart {
    /// The ray from a place in the unit `direction` at rest, and derivatives by changes of that along `changes`.
    pub fn new(hole: &UnitHole, from: &KerrPlace, direction: DVec3, changes: [DVec3; 2]) -> Self {
        let x = hole.position(1.0 / from.r, from.n);
        let launch = KerrLaunch::at_rest(hole, x, direction);
        // The state, and L, are affine in the direction: differences are derivatives.
        let slopes = changes.map(|change| {
            let beside = KerrLaunch::at_rest(hole, x, direction + change);
            let (here, a) = (&launch.state, hole.a);
            let (m, v) = (beside.state.m - here.m, beside.state.v - here.v);
            let l = beside.constants.l - launch.constants.l;
            let j2 = 2.0 * here.m.dot(m);
            let k = 2.0 * (here.m - a * about_axis(here.n)).dot(m);
            let q = j2 - 2.0 * launch.constants.l * l;
            let kappa = a * a * q + hole.e2 * k;
            KerrLaunch {
                constants: Constants { l, k, j2, k2: j2, kappa, barrier: 0.0 },
                state: MinoState { u: 0.0, v, n: DVec3::ZERO, m },
            }
        });
        Self { launch, slopes }
    }

    /// Constants of motion.
    pub fn constants(&self) -> &Constants {
        &self.launch.constants
    }

    /// State at the start.
    pub fn state(&self) -> &MinoState {
        &self.launch.state
    }

    /// The ray after `lambda`, to a `tolerance` in radians; `None` if it goes astray.
    pub fn after(&self, hole: &UnitHole, lambda: f64, tolerance: f64) -> Option<FlowEnd> {
        if tolerance < LOOSE {
            self.by_series::<EXACT_POWERS>(hole, lambda, EXACT_TOLERANCE)
        } else {
            self.by_series::<POWERS>(hole, lambda, tolerance)
        }
    }

    fn by_series<const P: usize>(&self, hole: &UnitHole, lambda: f64, tolerance: f64) -> Option<FlowEnd> {
        let dual = |slope: &KerrLaunch| {
            let with = |value, slope| Dual { value, slope };
            let vector = |value: DVec3, slope: DVec3| {
                [with(value.x, slope.x), with(value.y, slope.y), with(value.z, slope.z)]
            };
            let (Constants { l, k, j2, k2, kappa, .. }, MinoState { u, v, n, m }) =
                (self.launch.constants, self.launch.state);
            let (by, state) = (&slope.constants, &slope.state);
            let constants = FlowConstants {
                l: with(l, by.l),
                k: with(k, by.k),
                j2: with(j2, by.j2),
                k2: with(k2, by.k2),
                kappa: with(kappa, by.kappa),
            };
            let flow = Flow {
                u: with(u, state.u),
                v: with(v, state.v),
                n: vector(n, state.n),
                m: vector(m, state.m),
                winding: with(0.0, 0.0),
                is_real: true,
            };
            flow.after::<P>(hole, &constants, lambda, tolerance)
        };
        let [first, second] = [dual(&self.slopes[0])?, dual(&self.slopes[1])?];
        let value = |v: [Dual<f64>; 3]| DVec3::from_array(v.map(|x| x.value));
        let slope = |v: [Dual<f64>; 3]| DVec3::from_array(v.map(|x| x.slope));
        let angle = libm::sincos(first.winding.value);
        let turned = |n: DVec3| turned_by(angle, n);
        let n = turned(value(first.n).normalize());
        let n_slopes = [first, second].map(|end| turned(slope(end.n)) + end.winding.slope * about_axis(n));
        let state = MinoState { u: first.u.value, v: first.v.value, n, m: turned(value(first.m)) };
        // A ray that falls does not turn: not outside the horizon.
        let turns_well = self.launch.fate() == Fate::Escapes || self.launch.state.v <= 0.0 || state.v > 0.0;
        let is_real = first.is_real && turns_well;
        Some(FlowEnd { state, u_slopes: [first.u.slope, second.u.slope], n_slopes, is_real })
    }

    /// Follows the ray through `lambda`; `each` sees every step: its length, and the states along it.
    pub fn follow(&self, hole: &UnitHole, lambda: f64, mut each: impl FnMut(f64, &dyn Fn(f64) -> MinoState)) {
        let KerrLaunch { constants, state: MinoState { u, v, n, m } } = self.launch;
        let Constants { l, k, j2, k2, kappa, .. } = constants;
        let constants = FlowConstants { l, k, j2, k2, kappa };
        let mut flow = Flow { u, v, n: n.to_array(), m: m.to_array(), winding: 0.0, is_real: true };
        let mut left = lambda;
        for _ in 0..MAX_STEPS {
            let series = FlowSeries::<f64, EXACT_POWERS>::new(hole, &constants, &flow);
            let h = series.length(hole, EXACT_TOLERANCE).min(left);
            each(h, &|part| {
                let Flow { u, v, n, m, winding, .. } = series.at(hole, part);
                let turned = |n: [f64; 3]| turned_by(libm::sincos(winding), n.into());
                MinoState { u, v, n: turned(n), m: turned(m) }
            });
            flow = series.at(hole, h);
            left -= h;
            if left <= 0.0 {
                return;
            }
        }
    }
}

impl<T: Real> Flow<T> {
    fn after<const P: usize>(
        mut self,
        hole: &UnitHole,
        constants: &FlowConstants<T>,
        lambda: f64,
        tolerance: f64,
    ) -> Option<Self> {
        let mut left = lambda;
        for _ in 0..MAX_STEPS {
            let series = FlowSeries::<T, P>::new(hole, constants, &self);
            let h = series.length(hole, tolerance).min(left);
            let is_real = self.is_real && (0.0..hole.horizon).contains(&self.u.value());
            self = Self { is_real, ..series.at(hole, h) };
            left -= h;
            let u = self.u.value();
            if u > ASTRAY * hole.horizon || !u.is_finite() {
                return None;
            }
            if left <= 0.0 {
                return Some(self);
            }
        }
        None
    }
}

/// Coefficients of powers 0 to `P` − 1 of λ.
struct FlowSeries<T, const P: usize> {
    u: [T; P],
    n: [[T; P]; 3],
    /// Of G, up to the power P − 3.
    g: [T; P],
    winding: T,
}

impl<T: Real, const P: usize> FlowSeries<T, P> {
    fn new(hole: &UnitHole, constants: &FlowConstants<T>, flow: &Flow<T>) -> Self {
        let &FlowConstants { l, k, j2, k2, kappa } = constants;
        let (zero, one, two) = (T::of(0.0), T::of(1.0), T::of(2.0));
        let (a, a2) = (T::of(hole.a), T::of(hole.a * hole.a));
        let charged = T::of(hole.a * hole.a + hole.e2);
        let mut s = Self { u: [zero; P], n: [[zero; P]; 3], g: [zero; P], winding: flow.winding };
        (s.u[0], s.u[1]) = (flow.u, flow.v);
        for axis in 0..3 {
            (s.n[axis][0], s.n[axis][1]) = (flow.n[axis], flow.m[axis]);
        }
        let (mut u_squared, mut mu_squared, mut denominator) = ([zero; P], [zero; P], [zero; P]);
        let falls = flow.v.value() > 0.0;
        let (three_k, two_kappa, two_a2, swing) = (T::of(3.0) * k, two * kappa, two * a2, a * (a - l));
        for i in 0..P - 2 {
            let per = T::of(1.0 / ((i + 1) * (i + 2)) as f64);
            u_squared[i] = product(&s.u, &s.u, i);
            mu_squared[i] = product(&s.n[2], &s.n[2], i);
            let cubic = product(&u_squared, &s.u, i);
            s.u[i + 2] = (three_k * u_squared[i] - k2 * s.u[i] - two_kappa * cubic) * per;
            for axis in 0..3 {
                let cubic = product(&mu_squared, &s.n[axis], i);
                let along = if axis == 2 { a2 * s.n[axis][i] } else { zero };
                s.n[axis][i + 2] = (along - j2 * s.n[axis][i] - two_a2 * cubic) * per;
            }
            let constant = if i == 0 { one } else { zero };
            let p = constant + swing * u_squared[i];
            let v = T::of((i + 1) as f64) * s.u[i + 1];
            let (numerator, under) = if falls {
                (k * u_squared[i], p + v)
            } else {
                (p - v, constant - two * s.u[i] + charged * u_squared[i])
            };
            denominator[i] = under;
            let mut rest = numerator;
            for (&under, &g) in denominator[1..i + 1].iter().zip(s.g[..i].iter().rev()) {
                rest = rest - under * g;
            }
            s.g[i] = rest / denominator[0];
        }
        s
    }

    /// Length of a step of error `tolerance`, radians, by the last two coefficients.
    fn length(&self, hole: &UnitHole, tolerance: f64) -> f64 {
        let [x, y, z] = &self.n;
        let rate = |n: &[T; P]| n[1].value().abs();
        let scale = 1.0 + rate(x) + rate(y) + rate(z);
        let size = |i: usize| {
            let n = x[i].value().abs() + y[i].value().abs() + z[i].value().abs();
            n + scale * self.u[i].value().abs()
        };
        let wound = hole.a.abs() * self.g[P - 3].value().abs() / (P - 2) as f64;
        let log2 = fast_log2::wide_log2;
        let root =
            |size: f64, power: usize| ((log2(tolerance) - log2(size)) as f32 * (1.0 / power as f32)) as i32;
        let last = root(size(P - 1), P - 1).min(root(size(P - 2).max(wound), P - 2));
        fast_log2::wide_exp2(last)
    }

    /// The ray after `h`.
    fn at(&self, hole: &UnitHole, h: f64) -> Flow<T> {
        let step = T::of(h);
        let sums = |c: &[T; P]| {
            let (mut value, mut slope) = (c[P - 1], T::of((P - 1) as f64) * c[P - 1]);
            for i in (1..P - 1).rev() {
                value = value * step + c[i];
                slope = slope * step + T::of(i as f64) * c[i];
            }
            (value * step + c[0], slope)
        };
        let mut turns = T::of(0.0);
        for i in (0..P - 2).rev() {
            turns = turns * step + self.g[i] * T::of(1.0 / (i + 1) as f64);
        }
        let (u, v) = sums(&self.u);
        let [x, y, z] = [0, 1, 2].map(|axis| sums(&self.n[axis]));
        let winding = self.winding + T::of(hole.a) * (turns * step - step);
        Flow { u, v, n: [x.0, y.0, z.0], m: [x.1, y.1, z.1], winding, is_real: true }
    }
}
