//! A ray followed to its end where nothing is in its way.

use super::hole::{UnitHole, turned_by};
use super::launch::KerrLaunch;
use super::series::Series;
use super::state::MinoState;
use super::step::{SeriesControl, SeriesStep};
use crate::geodesic::{UsePowers, with_powers};
use crate::spacetime::Fate;

/// End of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KerrEnd {
    /// It crosses the spheroid outwards in this state.
    Crosses(MinoState),
    /// It falls through the horizon before.
    Falls,
    /// It leaves to infinity without ever crossing the spheroid outwards.
    Misses,
    /// It took more steps than allowed.
    StepLimit,
    /// Its state is no longer finite.
    NonFinite,
}

/// A ray, followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerrJourney {
    /// End of the ray.
    pub end: KerrEnd,
    /// Inverse radius of the point nearest to the hole, if the ray passes one.
    pub periastron: Option<f64>,
    /// Steps tried.
    pub steps: u32,
}

/// Most steps tried.
const MAX_STEPS: u32 = 100_000;

/// Follows a ray to a `tolerance` in radians until it crosses the spheroid of inverse radius `u_out` outwards (0 is
/// infinity), falls, or is lost; `each` sees every step that is taken: its length in λ, and the states along it.
pub fn follow(
    hole: &UnitHole,
    launch: &KerrLaunch,
    tolerance: f64,
    u_out: f64,
    each: impl FnMut(f64, &dyn Fn(f64) -> MinoState),
) -> KerrJourney {
    with_powers(tolerance, Following { hole, launch, tolerance, u_out, each })
}

struct Following<'a, F> {
    hole: &'a UnitHole,
    launch: &'a KerrLaunch,
    tolerance: f64,
    u_out: f64,
    each: F,
}

impl<F: FnMut(f64, &dyn Fn(f64) -> MinoState)> UsePowers for Following<'_, F> {
    type Output = KerrJourney;

    fn with<const P: usize>(self) -> KerrJourney {
        let Self { hole, launch, tolerance, u_out, mut each } = self;
        let control = SeriesControl::new(P, tolerance);
        follow_by::<P>(hole, launch, &control, u_out, |series, h| {
            each(h, &|part| series.at(hole, part).state);
        })
    }
}

/// [`follow`] by series of `P` coefficients.
pub fn follow_by<const P: usize>(
    hole: &UnitHole,
    launch: &KerrLaunch,
    control: &SeriesControl,
    u_out: f64,
    mut each: impl FnMut(&Series<P>, f64),
) -> KerrJourney {
    let KerrLaunch { constants, mut state } = *launch;
    let fate = constants.fate(state.u, state.v);
    let mut journey = KerrJourney { end: KerrEnd::StepLimit, periastron: None, steps: 0 };
    let end = |end: KerrEnd, journey: KerrJourney| KerrJourney { end, ..journey };
    let mut longest = f64::INFINITY;
    while journey.steps < MAX_STEPS {
        let falls = state.v > 0.0;
        if falls && fate == Fate::Falls {
            return end(KerrEnd::Falls, journey);
        }
        if !falls && state.u < u_out {
            return end(if fate == Fate::Falls { KerrEnd::Falls } else { KerrEnd::Misses }, journey);
        }
        journey.steps += 1;
        let series = Series::<P>::new(hole, &constants, &state);
        let h = control.length(hole, &series).min(longest);
        let step = SeriesStep::new(hole, &constants, &series, h);
        // Beyond infinity u is negative: a root of u lies on the way.
        let leaves = !falls && step.end.u <= u_out && step.strain.is_finite();
        if !leaves && !step.is_accepted(hole, &constants, &state) {
            longest = 0.5 * h;
            if longest <= f64::MIN_POSITIVE || longest.is_nan() || !state.u.is_finite() {
                return end(KerrEnd::NonFinite, journey);
            }
            continue;
        }
        longest = f64::INFINITY;
        if falls != (step.end.v > 0.0) {
            // The turning point first: the spheroid may be crossed on either side of it.
            let turn = root(&series, h, |s| (s.v, 0.5 * constants.rate_slope(s.u)), hole);
            if !falls {
                return end(KerrEnd::Falls, journey);
            }
            each(&series, turn);
            state = SeriesStep::new(hole, &constants, &series, turn).end;
            state.v = -f64::MIN_POSITIVE;
            journey.periastron = Some(state.u);
            continue;
        }
        if leaves {
            let exit = root(&series, h, |s| (s.u - u_out, s.v), hole);
            each(&series, exit);
            let mut crossing = crossing(hole, &series, exit);
            crossing.u = u_out;
            return end(KerrEnd::Crosses(crossing), journey);
        }
        each(&series, h);
        state = step.end;
    }
    journey
}

/// State at the end of a part of `series`, with N's constraints restored and turned by the winding: at infinity, too.
fn crossing<const P: usize>(hole: &UnitHole, series: &Series<P>, h: f64) -> MinoState {
    let moved = series.at(hole, h);
    let angle = libm::sincos(moved.winding);
    let n = turned_by(angle, moved.state.n.normalize());
    let m = turned_by(angle, moved.state.m);
    MinoState { n, m: m - m.dot(n) * n, ..moved.state }
}

/// The part of λ up to `h` at which a function of the state, given with its derivative, is 0: Newton's method within a
/// bracket.
fn root<const P: usize>(
    series: &Series<P>,
    h: f64,
    at: impl Fn(&MinoState) -> (f64, f64),
    hole: &UnitHole,
) -> f64 {
    let value = |h: f64| at(&series.at(hole, h).state);
    let end_sign = value(h).0 > 0.0;
    let (mut low, mut high, mut part) = (0.0, h, h);
    for _ in 0..60 {
        let (miss, slope) = value(part);
        if (miss > 0.0) == end_sign {
            high = part;
        } else {
            low = part;
        }
        let newton = part - miss / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let moved = (next - part).abs();
        part = next;
        if moved <= 2.0 * f64::EPSILON * h {
            break;
        }
    }
    part
}
