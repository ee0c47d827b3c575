//! Steps along a ray: their length, and the state at their end.

use glam::DVec3;

use super::constants::Constants;
use super::hole::{UnitHole, about_axis};
use super::series::{Series, SeriesPoint};
use super::state::MinoState;
use crate::math::{fast_log2, sin_cos_turns};

/// Tolerances of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesControl {
    /// Largest error that a step's last coefficients may tell, radians.
    tolerance: f64,
}

/// A step along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesStep {
    /// State at its end.
    pub end: MinoState,
    /// Displacement in the chart, to its own rounding.
    pub displacement: DVec3,
    /// Relative violation of v² = U before it was undone, relative.
    pub strain: f64,
    /// Change of v by which it was undone, relative to the speed of u: near the spherical ray, where u hardly moves, an
    /// error could hold it there.
    pub slip: f64,
}

/// Largest strain of a step.
const LARGEST_STRAIN: f64 = 0.02;
/// Length of λ over which twice the acceleration of u counts as its speed: that of a short step.
const SHORT: f64 = 0.1;
/// Largest slip of a step.
const LARGEST_SLIP: f64 = 0.05;
/// Least of the way to the horizon that steps are measured by, as a part of its inverse radius.
const SHORTEST_FALL: f64 = 0.1;
/// Angle that a step sweeps at most, radians.
const WIDEST: f64 = 1.6;
/// Largest error that a step's fourth last coefficient may tell, relative to what the last two may: those are sometimes
/// both small by chance, and from a turning point on every other one vanishes.
const COINCIDENCE: f64 = 60.0;
/// Inverse radius that is beyond the horizon, relative to it.
const BEYOND: f64 = 1.02;

/// Calibration: tolerances of rays over those of steps' last coefficients, such that the error of a whole ray keeps
/// within its tolerance, for series of `powers` coefficients.
const fn calibration(powers: usize) -> f64 {
    match powers {
        ..=8 => 0.8,
        9..=12 => 0.6,
        _ => 0.25,
    }
}

impl SeriesControl {
    /// Control of rays by series of `powers` coefficients: `tolerance` in radians.
    pub fn new(powers: usize, tolerance: f64) -> Self {
        Self { tolerance: calibration(powers) * tolerance.max(100.0 * f64::EPSILON) }
    }

    /// Length of a step from the start of `series`: by its last coefficients, and short beside the hole.
    #[inline(always)]
    pub fn length<const P: usize>(&self, hole: &UnitHole, series: &Series<P>) -> f64 {
        self.length_to(hole, series, f64::NAN)
    }

    /// [`Self::length`] of a step that goes outwards no farther than about to the inverse radius `farthest`; NaN for any.
    #[inline(always)]
    pub fn length_to<const P: usize>(&self, hole: &UnitHole, series: &Series<P>, farthest: f64) -> f64 {
        let Series { start, omega, u, n: [x, y, z], winding, .. } = series;
        let size = |i: usize| omega * u[i].abs() + x[i].abs() + y[i].abs() + z[i].abs();
        let wound = hole.a.abs() * winding[P - 3].abs() * (1.0 / (P - 2) as f64);
        let before = size(P - 2);
        let before = if before > wound { before } else { wound };
        // (tolerance/size)^(1/power), in logarithms: coefficients of far rays go as large powers of ω.
        let log2 = fast_log2::wide_log2;
        let root = |log2: i32, power: usize| log2 / power as i32;
        let last = root(log2(self.tolerance) - log2(size(P - 1)), P - 1);
        let last_but_one = root(log2(self.tolerance) - log2(before), P - 2);
        let guard = root(log2(COINCIDENCE * self.tolerance) - log2(size(P - 4)), P - 4);
        // Radial rays have ω = 0, but must not leave the chart.
        let strain = log2(LARGEST_STRAIN) - log2((P - 1) as f64 * u[P - 1].abs());
        let shortest = last.min(last_but_one).min(guard).min(root(strain, P - 2));
        let accurate = fast_log2::wide_exp2(shortest);
        let wide = WIDEST / (omega + hole.a.abs() * (winding[0] - 1.0).abs() + f64::MIN_POSITIVE);
        let (left, least) = (hole.horizon - start.u, SHORTEST_FALL * hole.horizon);
        let inwards = if left > least { left } else { least };
        let reach = series.fall_by(if start.v > 0.0 { inwards } else { farthest - start.u });
        let h = accurate.min(wide);
        if reach < h { reach } else { h }
    }
}

/// Rotation about the axis.
struct Wound {
    sine: f64,
    /// 1 − cos.
    versine: f64,
}

impl Wound {
    #[inline(always)]
    fn by(angle: f64) -> Self {
        let (s, c) = sin_cos_turns::small(0.5 * angle);
        Self { sine: 2.0 * s * c, versine: 2.0 * s * s }
    }

    /// What it adds to a vector.
    #[inline(always)]
    fn change(&self, n: DVec3) -> DVec3 {
        self.sine * about_axis(n) - self.versine * DVec3::new(n.x, n.y, 0.0)
    }
}

/// Displacement in the chart to the inverse radius `u`, reached by `rise`, while N changes by `way`.
#[inline(always)]
fn displacement(hole: &UnitHole, start: &MinoState, (u, rise): (f64, f64), way: DVec3) -> DVec3 {
    let per = 1.0 / (start.u * u);
    (start.u * per) * way - (rise * per) * start.n + hole.a * about_axis(way)
}

/// Displacement in the chart after `h` along `series`, without its constraints restored.
#[inline(always)]
pub fn dense_displacement<const P: usize>(hole: &UnitHole, series: &Series<P>, h: f64) -> DVec3 {
    let SeriesPoint { state, rise, way, winding } = series.at(hole, h);
    let way = way + Wound::by(winding).change(state.n);
    displacement(hole, &series.start, (state.u, rise), way)
}

impl SeriesStep {
    /// The step of length `h` along `series`; shorter steps are its dense output.
    #[inline(always)]
    pub fn new<const P: usize>(hole: &UnitHole, constants: &Constants, series: &Series<P>, h: f64) -> Self {
        let SeriesPoint { state: MinoState { u, v, n, m }, rise, way, winding } = series.at(hole, h);
        // One step of Newton's method towards v² = U, along its gradient in units of u and 1.
        let excess = v * v - constants.rate_squared(u);
        let (slope_u, slope_v) = (-constants.rate_slope(u) * u, 2.0 * v);
        let shift = excess / (slope_u * slope_u + slope_v * slope_v + f64::MIN_POSITIVE);
        let (across_u, across_v) = (shift * slope_u * u, shift * slope_v);
        let (u, v, rise) = (u - across_u, v - across_v, rise - across_u);
        // The first of Newton's steps towards |N| = 1 is this one.
        let lengthen = 0.5 * (1.0 - n.length_squared());
        let (unit, way) = (n + lengthen * n, way + lengthen * n);
        let m = m - m.dot(unit) * unit;
        let wound = Wound::by(winding);
        let way = way + wound.change(unit);
        let displacement = displacement(hole, &series.start, (u, rise), way);
        let scale = 1.0 + constants.k2.abs() * u * u;
        let start = &series.start;
        let speed = start.v.abs() + SHORT * constants.rate_slope(start.u).abs();
        Self {
            end: MinoState { u, v, n: unit + wound.change(unit), m: m + wound.change(m) },
            displacement,
            strain: excess.abs() / scale,
            slip: across_v.abs() / speed,
        }
    }

    /// True if the step can be taken: it kept its constraint and its branch of the orbit, and ends outside the horizon or
    /// little within.
    ///
    /// Near the spherical ray, where a ray's branches come close, a loose tolerance would let it change over.
    #[inline(always)]
    pub fn is_accepted(&self, hole: &UnitHole, constants: &Constants, start: &MinoState) -> bool {
        let (barrier, end) = (constants.barrier, &self.end);
        let outside = start.u < barrier;
        let (falls, falls_then) = (start.v > 0.0, end.v > 0.0);
        // Without a barrier no ray turns; outside one it turns outwards only, inside inwards.
        let turns_well = (barrier < f64::INFINITY) & (falls == outside);
        let keeps_branch = (outside == (end.u < barrier)) & ((falls == falls_then) | turns_well);
        (self.strain < LARGEST_STRAIN)
            & (self.slip < LARGEST_SLIP)
            & (end.u < BEYOND * hole.horizon)
            & (end.u > 0.0)
            & keeps_branch
    }
}
