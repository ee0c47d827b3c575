//! Rays that join two places of a field: shooting, corrected by Newton's method.
//!
//! A ray that sets out in a direction passes its target at some distance; how that changes with the direction tells how to
//! turn it. Four rays beside it, all by the same steps, are a ray and its derivatives in one, to the square of the angle
//! between them: what a step is off is a smooth function of where it starts.

use glam::{DMat2, DVec2, DVec3};

use super::control::{FieldControl, FieldVerdict};
use super::follow::to_infinity;
use super::step::{FieldRays, FieldStep, lane, set_lane};
use crate::geodesic::{Rkn6, Stepper};
use crate::math::frame::tangents;
use crate::math::kernel::widest;
use crate::spacetime::{IndexField, Sink};

/// Target of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldTarget {
    /// A world position.
    Place(DVec3),
    /// A unit direction of travel at infinity.
    Infinity(DVec3),
}

/// A ray from a place to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldConnection {
    /// Unit direction at its start.
    pub direction: DVec3,
    /// Unit direction of travel at its end.
    pub arrival: DVec3,
    /// Two unit vectors across the ray at its end.
    pub across: [DVec3; 2],
    /// How the direction at the start changes as the target moves along each of them: by unit length, or by radians if it is
    /// at infinity.
    pub turns: [DVec3; 2],
    /// Distance from the target at which it passes; radians if that is at infinity.
    pub miss: f64,
}

/// What is asked of a connection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JoinLimits {
    /// Distance from the target by which the ray may miss; radians if that is at infinity.
    pub enough: f64,
    /// Correction of the direction, radians, that is taken without another look at where it leads.
    pub linear: f64,
    /// Corrections of the direction at most.
    pub corrections: u32,
}

/// Angle between a ray and those beside it, radians, at least and at most.
const BESIDE: [f64; 2] = [1e-11, 1e-5];
/// That angle of the first ray, at least: larger where the target is so near, relative to its distance from the origin, that
/// rounding would show.
const FIRST_BESIDE: f64 = 1e-7;
/// That angle over the distance from the origin, relative to that of the target from the start.
const ROUNDING: f64 = 1e-9;
/// Distance of rays beside each other at the target at most, relative to that of the target, or radians: so small that their
/// derivatives hardly change, so large that rounding hardly shows.
const APART: f64 = 1e-5;
/// Rays that stand for one and its derivatives.
const RAYS: usize = 4;
/// 1 − β·Y where rays beside each other count as at infinity: their directions are off by its square.
const AFAR: f64 = 1e-5;
/// Halvings of a correction that makes it worse.
const MOST_HALVINGS: u32 = 3;
/// Largest correction, radians.
const LARGEST: f64 = 0.5;
/// Steps of a shot at most.
const MOST_STEPS: u32 = 4000;
/// Improvements of the point at which a ray is nearest to its target, and how near that is enough, relative to the distance
/// from the start.
const MOST_IMPROVEMENTS: u32 = 6;
const NEAREST: f64 = 1e-7;

impl FieldConnection {
    /// Solid angle at the start over the area at the end, perpendicular to the ray, in the chart; over the solid angle there
    /// if the target is at infinity.
    pub fn geometry_factor(&self) -> f64 {
        self.turns[0].cross(self.turns[1]).length()
    }

    /// How the direction at the start changes as the target moves along `offset`, to first order.
    pub fn turned(&self, offset: DVec3) -> DVec3 {
        let [first, second] = self.across.map(|across| across.dot(offset));
        first * self.turns[0] + second * self.turns[1]
    }
}

/// The ray from `x` to `target` that Newton's method finds from the unit direction `guess`, within `limits`; `None` if it
/// finds none.
pub fn join_in_field(
    field: &impl IndexField,
    control: &FieldControl,
    (x, guess): (DVec3, DVec3),
    target: FieldTarget,
    limits: JoinLimits,
) -> Option<FieldConnection> {
    // A ray that winds passes its target several times: of the guess, the nearest passage counts, then the same one.
    let first = match target {
        FieldTarget::Place(y) => ROUNDING * x.length().max(y.length()) / x.distance(y),
        FieldTarget::Infinity(_) => 0.0,
    };
    let mut here = shoot(field, control, (x, guess), target, (None, first.clamp(FIRST_BESIDE, BESIDE[1])))?;
    for left in (0..=limits.corrections).rev() {
        if here.connection.miss <= limits.enough {
            return Some(here.connection);
        }
        if here.correction.length() <= limits.linear {
            let direction = (here.connection.direction + here.correction).normalize();
            return Some(FieldConnection { direction, ..here.connection });
        }
        if left == 0 {
            return None;
        }
        let correction = here.correction.clamp_length_max(LARGEST);
        let mut part = 1.0;
        here = (0..=MOST_HALVINGS).find_map(|_| {
            let direction = (here.connection.direction + part * correction).normalize();
            part *= 0.5;
            let there = shoot(field, control, (x, direction), target, (Some(here.passage), here.beside))?;
            (there.connection.miss < here.connection.miss).then_some(there)
        })?;
    }
    None
}

/// A ray that is shot at a target.
struct FieldShot {
    connection: FieldConnection,
    /// Number of passages of the target before.
    passage: u32,
    /// Change of its direction that would let it hit, to first order.
    correction: DVec3,
    /// Angle to rays beside it, no larger than it was, at which they are no farther than [`APART`] at the target.
    beside: f64,
}

/// Shoots a ray in a unit direction, with others beside it at an `angle`; `None` if it ends before, or does not get near.
fn shoot(
    field: &impl IndexField,
    control: &FieldControl,
    (x, direction): (DVec3, DVec3),
    target: FieldTarget,
    (passage, angle): (Option<u32>, f64),
) -> Option<FieldShot> {
    let (u, v) = tangents(direction);
    let mut starts = [[0.0; RAYS]; 3];
    let mut directions = [[0.0; RAYS]; 3];
    for (l, beside) in [u, -u, v, -v].into_iter().enumerate() {
        set_lane(&mut starts, l, x);
        set_lane(&mut directions, l, direction + angle * beside);
    }
    let shot = ShotRays { field, control, starts: &starts, directions: &directions, target, passage };
    let (end, passage) = widest(shot)?;
    let momentum = |l: usize| lane(&end.p, l);
    let arrival = mean::<RAYS>(momentum).normalize();
    let off = |l: usize| match target {
        FieldTarget::Place(y) => lane(&end.x, l) - y,
        FieldTarget::Infinity(to) => momentum(l).normalize() - to,
    };
    let (a, b) = tangents(arrival);
    let along = |offset: DVec3| DVec2::new(a.dot(offset), b.dot(offset));
    let rate = |l: usize| along(off(l) - off(l + 1)) / (2.0 * angle);
    let rates = DMat2::from_cols(rate(0), rate(2));
    let inverse = rates.inverse();
    let turn = |shift: DVec2| {
        let turn = inverse * shift;
        turn.x * u + turn.y * v
    };
    // Along the ray, a place is not met to the last digit.
    let (miss, residual) = match target {
        FieldTarget::Place(_) => (along(mean::<RAYS>(off)).length(), along(mean::<RAYS>(off))),
        FieldTarget::Infinity(to) => (arrival.distance(to), along(arrival - to)),
    };
    let connection =
        FieldConnection { direction, arrival, across: [a, b], turns: [turn(DVec2::X), turn(DVec2::Y)], miss };
    let correction = turn(-residual);
    let whole = match target {
        FieldTarget::Place(y) => x.distance(y),
        FieldTarget::Infinity(_) => 1.0,
    };
    let rate = rates.x_axis.length().max(rates.y_axis.length());
    let beside = (APART * whole / rate).clamp(BESIDE[0], angle);
    (connection.miss.is_finite() && correction.is_finite()).then_some(FieldShot {
        connection,
        passage,
        correction,
        beside,
    })
}

/// Mean over rays beside each other.
#[inline(always)]
pub(super) fn mean<const L: usize>(of: impl Fn(usize) -> DVec3) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for l in 0..L / 2 {
        sum += of(2 * l) + of(2 * l + 1);
    }
    sum / L as f64
}

/// Rays beside each other, to be followed to where they are nearest to a target.
struct ShotRays<'a, F> {
    field: &'a F,
    control: &'a FieldControl,
    starts: &'a [[f64; RAYS]; 3],
    directions: &'a [[f64; RAYS]; 3],
    target: FieldTarget,
    /// Passage of the target that counts; `None`: the nearest.
    passage: Option<u32>,
}

impl<F: IndexField> pulp::NullaryFnOnce for ShotRays<'_, F> {
    type Output = Option<(FieldRays<RAYS>, u32)>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { field, control, starts, directions, target, passage } = self;
        let step =
            |rays: &FieldRays<RAYS>, h: f64| FieldStep::new::<{ 3 * RAYS }>(field, &Rkn6, rays, &[h; RAYS]);
        let middle =
            |rays: &FieldRays<RAYS>| (mean::<RAYS>(|l| lane(&rays.x, l)), mean::<RAYS>(|l| lane(&rays.p, l)));
        // How far the middle ray has to go, times n.
        let left = |rays: &FieldRays<RAYS>, y: DVec3| {
            let (x, p) = middle(rays);
            (y - x).dot(p)
        };
        let mut rays = FieldRays::new(field, starts, directions);
        let (mut h, mut previous) = (control.first_step(Rkn6::ESTIMATE.order, &rays, 0), 1.0);
        let whole = match target {
            FieldTarget::Place(y) => y.distance(middle(&rays).0),
            FieldTarget::Infinity(_) => f64::INFINITY,
        };
        let mut nearest: Option<(f64, (FieldRays<RAYS>, u32))> = None;
        let mut passages = 0;
        for _ in 0..MOST_STEPS {
            let (x, p) = middle(&rays);
            let falls = |sink: &Sink| {
                let away = x - sink.center;
                away.length_squared() <= sink.captures * sink.captures && away.dot(p) < 0.0
            };
            if field.sinks().iter().any(falls) {
                break;
            }
            if control.leaves(x, p) {
                match target {
                    FieldTarget::Place(y) if control.is_beyond(x, y) && (y - x).dot(p) <= 0.0 => break,
                    FieldTarget::Place(_) => {}
                    FieldTarget::Infinity(_) => {
                        let there =
                            to_infinity::<F, Rkn6, RAYS, { 3 * RAYS }>(field, &Rkn6, control, rays, AFAR);
                        return there.map(|there| (there, 0));
                    }
                }
            }
            let moved = step(&rays, h);
            let FieldVerdict { accepted, next_h, error } =
                control.judge::<RAYS, Rkn6>((&moved, h), 0.0, previous, 0);
            if !accepted {
                let moves = next_h > f64::from(f32::MIN_POSITIVE);
                if !moves {
                    break;
                }
                h = next_h;
                continue;
            }
            if let FieldTarget::Place(y) = target
                && left(&rays, y) > 0.0
                && left(&moved.end, y) <= 0.0
            {
                if passage.is_none_or(|passage| passage == passages) {
                    let passing = beside(&rays, (&moved, h), step, |rays| left(rays, y), NEAREST * whole);
                    let distance = middle(&passing).0.distance(y);
                    if nearest.is_none_or(|(least, _)| distance < least) {
                        nearest = Some((distance, (passing, passages)));
                    }
                    if passage.is_some() {
                        break;
                    }
                }
                passages += 1;
            }
            (rays, previous) = (moved.end, error);
            h = control.within(next_h, &rays, 0);
        }
        nearest.map(|(_, passing)| passing)
    }
}

/// Where the rays of a step are as far as their middle is beside the target, `left` times n away.
#[inline(always)]
pub(super) fn beside<const L: usize>(
    start: &FieldRays<L>,
    (whole, h): (&FieldStep<L>, f64),
    step: impl Fn(&FieldRays<L>, f64) -> FieldStep<L>,
    left: impl Fn(&FieldRays<L>) -> f64,
    near: f64,
) -> FieldRays<L> {
    let (before, behind) = (left(start), left(&whole.end));
    let (mut low, mut high) = (0.0, h);
    let mut part = h * before / (before - behind);
    let mut passing = step(start, part);
    for _ in 0..MOST_IMPROVEMENTS {
        let p2 = mean::<L>(|l| lane(&passing.end.p, l)).length_squared();
        let further = left(&passing.end) / p2;
        if further * further * p2 <= near * near {
            break;
        }
        (low, high) = if further > 0.0 { (part, high) } else { (low, part) };
        // |dx/dτ| = n/(1 − β·Y)².
        part += further * passing.ahead[0] * passing.ahead[0];
        part = if low < part && part < high { part } else { 0.5 * (low + high) };
        passing = step(start, part);
    }
    passing.end
}
