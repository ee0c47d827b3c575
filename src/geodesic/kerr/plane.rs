//! Orbits to first order in the spin: each in a plane.
//!
//! To first order in a, the unit vector N of a ray runs on a great circle, at the angle wλ with w = |N′| at the start, u
//! obeys the exact equation, and the radial winding turns what the great circle meets about the axis.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::constants::Constants;
use super::hole::UnitHole;
use super::state::MinoState;
use crate::math::{fast_log2, sin_cos_turns};

/// Rays from a place that start into the half of a plane through the centre.
#[derive(Clone, Copy, Debug)]
pub struct OrbitPlane {
    hole: UnitHole,
    /// Inverse radius, N and the tangent there.
    u: f64,
    n: DVec3,
    tangent: DVec3,
    /// (N × tangent)_z.
    tilt: f64,
    /// Largest w, of the ray that starts at its periastron or apastron.
    widest: f64,
    /// The other root of U(w), and the coefficient of w² in it, with the sign changed.
    root: f64,
    bow: f64,
}

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneOrbit {
    /// Constants of motion.
    pub constants: Constants,
    /// Start.
    pub start: MinoState,
    /// |N′|.
    w: f64,
}

/// End of an orbit that was followed through an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneOrbitEnd {
    /// Inverse radius: no larger than the horizon's much, nor below 0.
    pub u: f64,
    /// Winding about the axis on the way there, radians.
    pub winding: f64,
    /// Angle that is left where it left to infinity or fell, radians.
    pub left: f64,
}

/// Coefficients of the series of u.
const POWERS: usize = 8;
/// Error of a step that its last coefficient may tell, radians.
const TOLERANCE: f64 = 1e-4;
/// Largest relative size of the last coefficient, as for other series.
const STRAIN: f64 = 0.02;
/// Angle that a step sweeps at most, radians.
const WIDEST: f64 = 1.6;
/// Most steps.
const MAX_STEPS: usize = 64;

impl OrbitPlane {
    /// The half-plane from inverse radius `u` and unit vector `n`, towards the unit `tangent` across it; `None` in the
    /// ergosphere.
    pub fn new(hole: &UnitHole, (u, n): (f64, DVec3), tangent: DVec3) -> Option<Self> {
        let (a, e2, mu2) = (hole.a, hole.e2, n.z * n.z);
        let tilt = n.cross(tangent).z;
        let (a2, u2) = (a * a, u * u);
        let (u3, u4) = (u2 * u, u2 * u2);
        // U(u) = −bow w² + slope w + rest.
        let bow = u2 - 2.0 * u3 + (a2 * (1.0 - tilt * tilt) + e2) * u4;
        let slope = -4.0 * a * tilt * u3 + 2.0 * e2 * a * tilt * u4;
        let rest = 1.0
            + a2 * (1.0 + mu2) * u2
            + 2.0 * a2 * (1.0 - mu2) * u3
            + (a2 * a2 * mu2 - e2 * a2 * (1.0 - mu2)) * u4;
        let discriminant = slope * slope + 4.0 * bow * rest;
        if !(bow > 0.0 && discriminant > 0.0) {
            return None;
        }
        let half = discriminant.sqrt();
        let (widest, root) = ((slope + half) / (2.0 * bow), (slope - half) / (2.0 * bow));
        (widest > 0.0).then_some(Self { hole: *hole, u, n, tangent, tilt, widest, root, bow })
    }

    /// The ray at an angle `alpha` in (0, π), which grows from falling radially to leaving radially.
    pub fn orbit(&self, alpha: f64) -> PlaneOrbit {
        let Self { hole, u, n, tangent, tilt, widest, root, bow } = *self;
        let a = hole.a;
        let (a2, mu2) = (a * a, n.z * n.z);
        // w = widest · sin α; what is left to the widest has no cancellation.
        let half = libm::sin(0.5 * (FRAC_PI_2 - alpha));
        let short = 2.0 * widest * half * half;
        let w = (widest - short).max(0.0);
        let rate = (bow * short * (w - root)).max(0.0).sqrt();
        let v = if alpha < FRAC_PI_2 { rate } else { -rate };
        let l = w * tilt;
        let j2 = w * w - a2 * mu2;
        let k = w * w - 2.0 * a * l + a2 * (1.0 - mu2);
        let kappa = a2 * (j2 - l * l) + hole.e2 * k;
        let constants = Constants { l, k, j2, k2: j2 - a2, kappa, barrier: f64::INFINITY };
        PlaneOrbit { constants, start: MinoState { u, v, n, m: w * tangent }, w }
    }
}

impl PlaneOrbit {
    /// Follows it through `angle`, radians, to first order in the spin.
    pub fn follow(&self, hole: &UnitHole, angle: f64) -> PlaneOrbitEnd {
        let Self { constants, start: MinoState { mut u, mut v, .. }, w } = *self;
        let (mut left, mut winding) = (angle, 0.0);
        let rate = |u: f64, v: f64| {
            let state = MinoState { u, v, ..MinoState::default() };
            hole.a * (state.winding(hole, &constants) - 1.0)
        };
        let mut start_rate = rate(u, v);
        for _ in 0..MAX_STEPS {
            let series = PlaneSeries::new(&constants, w, (u, v));
            let h = series.length(hole).min(left / w);
            let (middle, end) = (series.at(0.5 * h), series.at(h));
            let is_lost = !(end.0 > 0.0 && end.0 < hole.horizon);
            if is_lost {
                // The part of the step that is outside, by its chord.
                let bound = if end.0 > u { hole.horizon } else { 0.0 };
                let part = ((bound - u) / (end.0 - u)).clamp(0.0, 1.0);
                return PlaneOrbitEnd { u: bound, winding, left: left - part * h * w };
            }
            // Simpson's rule.
            let end_rate = rate(end.0, end.1);
            winding += h / 6.0 * (start_rate + 4.0 * rate(middle.0, middle.1) + end_rate);
            (u, v, start_rate) = (end.0, end.1, end_rate);
            left -= h * w;
            if left <= 1e-12 * angle {
                break;
            }
        }
        PlaneOrbitEnd { u, winding, left: 0.0 }
    }
}

/// Series of u alone: the part that is not harmonic of the frequency w.
struct PlaneSeries {
    w: f64,
    u: f64,
    v: f64,
    rest: [f64; POWERS],
}

impl PlaneSeries {
    fn new(constants: &Constants, w: f64, (u, v): (f64, f64)) -> Self {
        let &Constants { k, k2, kappa, .. } = constants;
        let w2 = w * w;
        let (mut whole, mut rest, mut square) = ([0.0; POWERS], [0.0; POWERS], [0.0; POWERS]);
        (whole[0], whole[1]) = (u, v);
        for n in 0..POWERS - 2 {
            let product =
                |a: &[f64; POWERS], b: &[f64; POWERS]| -> f64 { (0..=n).map(|i| a[i] * b[n - i]).sum() };
            square[n] = product(&whole, &whole);
            let pull = (w2 - k2) * whole[n] + 3.0 * k * square[n] - 2.0 * kappa * product(&square, &whole);
            let per = 1.0 / ((n + 1) * (n + 2)) as f64;
            rest[n + 2] = (pull - w2 * rest[n]) * per;
            whole[n + 2] = rest[n + 2] - w2 * (whole[n] - rest[n]) * per;
        }
        Self { w, u, v, rest }
    }

    /// Length of a step.
    fn length(&self, hole: &UnitHole) -> f64 {
        let log2 = fast_log2::wide_log2;
        let root = |log2: i32, power: usize| (log2 as f32 * (1.0 / power as f32)) as i32;
        let last = self.rest[POWERS - 1].abs();
        let accurate = root(log2(TOLERANCE) - log2(self.w * last), POWERS - 1);
        let strain = root(log2(STRAIN) - log2((POWERS - 1) as f64 * last), POWERS - 2);
        let h = fast_log2::wide_exp2(accurate.min(strain));
        h.min(WIDEST / self.w).min(hole.horizon / (self.v.abs() + f64::MIN_POSITIVE))
    }

    /// u and du/dλ after `h`.
    fn at(&self, h: f64) -> (f64, f64) {
        let Self { w, u, v, ref rest } = *self;
        let angle = w * h;
        let (s, c) = sin_cos_turns::small(0.5 * angle);
        let (versine, sine) = (2.0 * s * s, 2.0 * s * c);
        let reach = if angle > 1e-9 { sine / w } else { h };
        let (mut value, mut slope) = (0.0, 0.0);
        for i in (2..POWERS).rev() {
            value = value * h + rest[i];
            slope = slope * h + i as f64 * rest[i];
        }
        (u + v * reach - u * versine + h * h * value, v - v * versine - u * w * sine + h * slope)
    }
}
