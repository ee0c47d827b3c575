//! Connections: the null geodesics from one place around a spinning hole to another, or to infinity.
//!
//! No formula joins two places. From an aim that is exact to first order in the spin, Newton's method finds the direction
//! at the start and the length in λ for which u and N at the end are those of the target; its derivatives are exact. As
//! it may stop off target, the residual decides, not that it stopped.
//!
//! Rays that go the near way and those that go around once are looked for, one of each from its aim. Behind the hole, in
//! the primary caustic, four rays leave in nearly all azimuths about the hole instead of two (Rauch, Blandford 1994,
//! ApJ 421, 46; Sereno, De Luca 2008, Phys. Rev. D 78, 023008): there, and where rays of both windings are as long as a
//! turn, Newton's method starts from all around.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};

use super::aim::{Aimed, KerrPlace, PlaneShot, turned};
use super::flow::{FlowEnd, FlowStart};
use super::hole::{UnitHole, about_axis};
use super::launch::KerrLaunch;
use super::time::elapsed;
use crate::math::frame::tangents;
use crate::math::quadrature;

/// A ray from a place to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerrConnection {
    /// Unit direction at its start, in the frame at rest.
    pub direction: DVec3,
    /// Unit direction of travel at its end, in the frame at rest there.
    pub arrival: DVec3,
    /// Covariant momenta at both ends.
    pub momenta: [DVec3; 2],
    /// Its length in λ.
    pub lambda: f64,
    /// Solid angle at the start over the proper area at the end across the ray, in units of the mass; over the solid angle
    /// there if it is at infinity.
    pub geometry_factor: f64,
    /// Largest change of the place at the end across the ray, relative to its distance from the hole, per radian at the
    /// start; of the direction at infinity.
    pub swing: f64,
}

/// Search for the rays from a place to another, which may be infinitely far.
#[derive(Clone, Copy, Debug)]
pub struct KerrConnector<'a> {
    /// The hole.
    pub hole: &'a UnitHole,
    /// Start.
    pub from: &'a KerrPlace,
    /// End.
    pub to: &'a KerrPlace,
    /// Largest error of the direction, radians: exact to rounding if less than 1e-8.
    pub tolerance: f64,
}

/// Most steps of Newton's method, and halvings of one.
const MAX_STEPS: usize = 40;
const MAX_HALVINGS: usize = 8;
/// Change of the direction, radians, after which Newton's method is as good as it gets.
const LAST_TURN: f64 = 1e-9;
/// Largest residual of what has been found that well: sensitive rays end off by rounding.
const ROUNDING: f64 = 1e-9;
/// Largest change of the direction in one step, radians, and of λ, relative.
const LARGEST_TURN: f64 = 0.3;
const LARGEST_CUT: f64 = 0.5;
/// Largest error of directions that are made exact afterwards, radians.
const COARSE: f64 = 1e-6;
/// Angle between directions that are one, radians.
const SAME: f64 = 1e-6;
/// Sine of the angle between the target and the line through the hole, behind it, within which there may be more rays:
/// more than a caustic's width and the error of the aim.
const BEHIND: f64 = 0.05;
/// Planes in which an angle is looked for at most.
const MAX_PLANES: usize = 4;

/// A ray that is tried.
struct KerrTrial {
    direction: DVec3,
    changes: [DVec3; 2],
    lambda: f64,
    start: FlowStart,
    end: FlowEnd,
    /// Residual: of u, relative; of N.
    rise: f64,
    miss: DVec3,
    /// Length of the residual.
    residual: f64,
}

impl KerrConnector<'_> {
    /// The ray from its aim; `None` if it is not found, or another one is.
    pub fn by_aim(&self, aim: &Aimed) -> Option<KerrConnection> {
        let trial = self.find(&aim.shot)?;
        let angle = trial.lambda * trial.start.state().m.length();
        ((angle > PI) == aim.goes_around()).then(|| self.connection(&trial))
    }

    /// True if there may be more rays than the one of an aim that goes the near way and that of one that goes around.
    pub fn has_more(aim: &Aimed) -> bool {
        aim.shot.angle > FRAC_PI_2 && aim.steadiness() < BEHIND
    }

    /// All rays that are found from the aims of both windings and from this number of azimuths around the hole, those that
    /// go around more than once among them.
    pub fn all(&self, azimuths: u32) -> Vec<KerrConnection> {
        let mut found: Vec<KerrTrial> = Vec::new();
        let (first, second) = tangents(self.from.n);
        let aims = (0..2).filter_map(|winding| Some(self.from.aim(self.hole, self.to, winding)?.shot));
        let around = (0..azimuths).filter_map(|i| {
            let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(azimuths));
            self.shoot(cos * first + sin * second)
        });
        // Most searches from around fail: only what they find need be exact.
        let coarse = Self { tolerance: self.tolerance.max(COARSE), ..*self };
        for shot in aims.chain(around) {
            if let Some(near) = coarse.find(&shot)
                && let Some(trial) = self.newton(near.direction, near.lambda)
                && !found.iter().any(|other| other.direction.distance(trial.direction) < SAME)
            {
                found.push(trial);
            }
        }
        found.iter().map(|trial| self.connection(trial)).collect()
    }

    /// The ray in the half-plane towards `tangent` that passes the target as closely as any there, on its far side.
    fn shoot(&self, tangent: DVec3) -> Option<PlaneShot> {
        let (mut turn, mut shot): (f64, Option<PlaneShot>) = (0.0, None);
        for _ in 0..MAX_PLANES {
            let target = turned(self.to.n, -turn);
            let angle = libm::atan2(target.dot(tangent), target.dot(self.from.n));
            let angle = if angle < FRAC_PI_2 { angle + TAU } else { angle };
            let next = self.from.shoot_along(self.hole, self.to.r, (tangent, angle), shot.as_ref())?;
            turn = next.turn;
            shot = Some(next);
        }
        shot
    }

    /// Inverse radius that u is measured by.
    fn scale(&self) -> f64 {
        libm::hypot(1.0 / self.from.r, 1.0 / self.to.r)
    }

    fn attempt(&self, direction: DVec3, lambda: f64) -> Option<KerrTrial> {
        let changes = <[DVec3; 2]>::from(tangents(direction));
        let start = FlowStart::new(self.hole, self.from, direction, changes);
        let end = start.after(self.hole, lambda, self.tolerance)?;
        let rise = (end.state.u - 1.0 / self.to.r) / self.scale();
        let miss = end.state.n - self.to.n;
        let residual = (rise * rise + miss.length_squared()).sqrt();
        residual.is_finite().then_some(KerrTrial {
            direction,
            changes,
            lambda,
            start,
            end,
            rise,
            miss,
            residual,
        })
    }

    /// Newton's step from a trial: changes of the direction and of λ.
    fn step(&self, trial: &KerrTrial) -> Option<(DVec3, f64)> {
        let KerrTrial { changes, start, end, rise, miss, .. } = trial;
        let (first, second) = tangents(self.to.n);
        let row = |u: f64, n: DVec3| DVec3::new(u / self.scale(), n.dot(first), n.dot(second));
        let [by_first, by_second] = [0, 1].map(|i| row(end.u_slopes[i], end.n_slopes[i]));
        let by_lambda = row(end.state.v, self.motion(start, end));
        let matrix = DMat3::from_cols(by_first, by_second, by_lambda);
        let step = -(matrix.inverse() * DVec3::new(*rise, miss.dot(first), miss.dot(second)));
        step.is_finite().then(|| (step.x * changes[0] + step.y * changes[1], step.z))
    }

    /// dN/dλ at the end of a ray, with the winding.
    fn motion(&self, start: &FlowStart, end: &FlowEnd) -> DVec3 {
        let winding = self.hole.a * (end.state.winding(self.hole, start.constants()) - 1.0);
        end.state.m + winding * about_axis(end.state.n)
    }

    /// Newton's method from an aim.
    fn find(&self, shot: &PlaneShot) -> Option<KerrTrial> {
        let start = KerrLaunch::at_rest(
            self.hole,
            self.hole.position(1.0 / self.from.r, self.from.n),
            shot.direction,
        );
        self.newton(shot.direction, shot.angle / start.state.m.length())
    }

    /// Newton's method, damped, from a direction and a length in λ.
    fn newton(&self, direction: DVec3, lambda: f64) -> Option<KerrTrial> {
        let mut trial = self.attempt(direction, lambda)?;
        for _ in 0..MAX_STEPS {
            if trial.residual < self.tolerance {
                break;
            }
            let (turn, longer) = self.step(&trial)?;
            let size = turn.length();
            let mut part = (LARGEST_TURN / size).min(1.0);
            if longer * part < -LARGEST_CUT * trial.lambda {
                part = -LARGEST_CUT * trial.lambda / longer;
            }
            let is_last = size < LAST_TURN;
            let better = (0..if is_last { 1 } else { MAX_HALVINGS }).find_map(|_| {
                let direction = (trial.direction + part * turn).normalize();
                let next = self.attempt(direction, trial.lambda + part * longer);
                part *= 0.5;
                next.filter(|next| next.residual < trial.residual)
            });
            let is_better = better.is_some();
            trial = better.unwrap_or(trial);
            if is_last || !is_better {
                break;
            }
        }
        (trial.end.is_real && trial.residual < self.tolerance.max(ROUNDING)).then_some(trial)
    }

    fn connection(&self, trial: &KerrTrial) -> KerrConnection {
        let Self { hole, to, .. } = self;
        let KerrTrial { direction, lambda, start, end, .. } = trial;
        let (constants, state) = (start.constants(), &end.state);
        let momenta = [start.state().momentum(hole, constants), state.momentum(hole, constants)];
        let is_infinite = to.r == f64::INFINITY;
        let (arrival, beside) = if is_infinite {
            let motion = self.motion(start, end);
            (to.n, [0, 1].map(|i| end.n_slopes[i] - end.u_slopes[i] / state.v * motion))
        } else {
            let arrival = KerrLaunch::direction_at_rest(hole, (to.r, to.n), momenta[1]);
            // The frame at rest stretches what is along N.
            let stretch = 1.0 / (1.0 - hole.potential(to.r, to.n.z)).sqrt() - 1.0;
            let beside = [0, 1].map(|i| {
                let (u, n) = (end.u_slopes[i], end.n_slopes[i]);
                let x = to.r * (n - (to.r * u) * to.n) + hole.a * about_axis(n);
                let x = x + stretch * to.n.dot(x) * to.n;
                x - x.dot(arrival) * arrival
            });
            (arrival, beside)
        };
        let [first, second] = beside;
        let (p, q, r) = (first.length_squared(), first.dot(second), second.length_squared());
        let largest = (0.5 * (p + r + libm::hypot(p - r, 2.0 * q))).sqrt();
        let distance = if is_infinite { 1.0 } else { hole.position(1.0 / to.r, to.n).length() };
        KerrConnection {
            direction: *direction,
            arrival,
            momenta,
            lambda: *lambda,
            geometry_factor: 1.0 / arrival.dot(first.cross(second)).abs(),
            swing: largest / distance,
        }
    }
}

impl KerrConnection {
    /// Kerr–Schild time that the ray takes from its start, in units of the mass, and the angle through which the direction
    /// from the centre to it turns on the way, radians.
    pub fn time_and_swept(&self, hole: &UnitHole, from: &KerrPlace) -> (f64, f64) {
        let start = FlowStart::new(hole, from, self.direction, tangents(self.direction).into());
        let constants = start.constants();
        let (mut time, mut swept) = (0.0, 0.0);
        start.follow(hole, self.lambda, |h, at| {
            time += elapsed(hole, constants, h, at);
            let rate = |part: f64| {
                let state = at(part);
                let x = hole.position(state.u, state.n);
                let [velocity, _] = state.motion(hole, constants);
                x.cross(velocity).length() / (x.length_squared() * state.u * state.u)
            };
            let half = |from: f64| quadrature::mean(|x| rate(h * (from + 0.5 * x)));
            swept += 0.5 * h * (half(0.0) + half(0.5));
        });
        (time, swept)
    }
}
