//! A ray in a field of refraction, followed to its end where nothing is in its way.

use glam::DVec3;

use super::control::{FieldControl, FieldVerdict};
use super::step::{FieldRays, FieldStep, lane};
use crate::geodesic::Stepper;
use crate::spacetime::IndexField;

/// End of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldEnd {
    /// It crosses the sphere outwards at this place, in this unit direction.
    Crosses(DVec3, DVec3),
    /// It is captured by the sink of this number.
    Falls(usize),
    /// It leaves to infinity without ever crossing the sphere outwards.
    Misses,
    /// It took more steps than allowed.
    StepLimit,
    /// Its state is no longer finite.
    NonFinite,
}

/// A ray, followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldJourney {
    /// End of the ray.
    pub end: FieldEnd,
    /// Steps tried.
    pub steps: u32,
}

/// Most steps tried.
const MAX_STEPS: u32 = 100_000;

/// Follows a ray from its start until it crosses the sphere of this centre and radius outwards, is captured, or is lost;
/// `each` sees every step that is taken, with its start and length.
pub fn follow_field<F: IndexField, S: Stepper>(
    field: &F,
    stepper: &S,
    control: &FieldControl,
    start: FieldRays<1>,
    (center, radius): (DVec3, f64),
    mut each: impl FnMut(&FieldRays<1>, &FieldStep<1>, f64),
) -> FieldJourney {
    let (mut ray, mut previous) = (start, 1.0);
    let mut h = control.first_step(S::ESTIMATE.order, &ray, 0);
    let mut journey = FieldJourney { end: FieldEnd::StepLimit, steps: 0 };
    let outwards = |ray: &FieldRays<1>, from: DVec3| (lane(&ray.x, 0) - from).dot(lane(&ray.p, 0));
    while journey.steps < MAX_STEPS {
        let x = lane(&ray.x, 0);
        let captures = field.sinks().iter().position(|sink| {
            x.distance_squared(sink.center) <= sink.captures * sink.captures
                && outwards(&ray, sink.center) < 0.0
        });
        if let Some(sink) = captures {
            return FieldJourney { end: FieldEnd::Falls(sink), ..journey };
        }
        if control.leaves(x, lane(&ray.p, 0))
            && x.distance(control.middle) > radius + center.distance(control.middle)
        {
            return FieldJourney { end: FieldEnd::Misses, ..journey };
        }
        journey.steps += 1;
        let step = FieldStep::new::<3>(field, stepper, &ray, &[h]);
        let FieldVerdict { accepted, next_h, error } = control.judge::<1, S>((&step, h), 0.0, previous, 0);
        if !accepted {
            // A step that has vanished, or a state that is no longer finite.
            let moves = next_h > f64::from(f32::MIN_POSITIVE);
            if !moves || !x.is_finite() {
                return FieldJourney { end: FieldEnd::NonFinite, ..journey };
            }
            h = next_h;
            continue;
        }
        // Between a point before the crossing and one behind it.
        let inside = |ray: &FieldRays<1>| lane(&ray.x, 0).distance(center) < radius;
        let is_behind = |ray: &FieldRays<1>| !inside(ray) && outwards(ray, center) > 0.0;
        if is_behind(&step.end) && !is_behind(&ray) {
            let (mut before, mut behind, mut part) = (0.0, h, ray);
            while behind - before > f64::EPSILON * h {
                let middle = 0.5 * (before + behind);
                let end = FieldStep::new::<3>(field, stepper, &ray, &[middle]).end;
                if is_behind(&end) {
                    behind = middle;
                } else {
                    (before, part) = (middle, end);
                }
            }
            // A ray that only passes by comes no nearer.
            if inside(&part) {
                let part = FieldStep::new::<3>(field, stepper, &ray, &[behind]);
                each(&ray, &part, behind);
                let end = FieldEnd::Crosses(lane(&part.end.x, 0), lane(&part.end.p, 0).normalize());
                return FieldJourney { end, ..journey };
            }
        }
        each(&ray, &step, h);
        (ray, previous) = (step.end, error);
        h = control.within(next_h, &ray, 0);
    }
    journey
}

/// 1 − β·Y where a ray counts as at infinity.
const INFINITY: f64 = 1e-13;
/// Most corrections of a step to infinity.
const MOST_CORRECTIONS: u32 = 8;

/// Rays that leave and meet nothing more, where 1 − β·Y is about `infinity` in their last step, with which the first of
/// them keeps pace; `None` if they are lost.
#[inline(always)]
pub(crate) fn to_infinity<F: IndexField, S: Stepper, const L: usize, const N: usize>(
    field: &F,
    stepper: &S,
    control: &FieldControl,
    mut rays: FieldRays<L>,
    infinity: f64,
) -> Option<FieldRays<L>> {
    let mut h = control.first_step(S::ESTIMATE.order, &rays, 0);
    let mut previous = 1.0;
    for _ in 0..MAX_STEPS {
        let (lean, momentum) = (lane(&rays.lean, 0), lane(&rays.p, 0));
        if lean == DVec3::ZERO {
            return Some(rays);
        }
        // Where a straight ray is at infinity.
        let whole = 1.0 / lean.dot(momentum);
        let reaches = whole > 0.0 && h >= whole;
        h = if reaches { whole } else { h };
        let mut step = FieldStep::new::<N>(field, stepper, &rays, &[h; L]);
        for _ in 0..if reaches { MOST_CORRECTIONS } else { 0 } {
            let excess = step.ahead[0] - infinity;
            if excess.abs() < 0.5 * infinity {
                break;
            }
            h += h * excess / lean.dot(lane(&step.rate, 0));
            step = FieldStep::new::<N>(field, stepper, &rays, &[h; L]);
        }
        let verdict = control.judge::<L, S>((&step, h), 0.0, previous, 0);
        if verdict.accepted && step.ahead[0] < 2.0 * infinity {
            return Some(step.end);
        }
        if !verdict.accepted && verdict.next_h < f64::from(f32::MIN_POSITIVE) {
            return None;
        }
        (rays, previous) = if verdict.accepted { (step.end, verdict.error) } else { (rays, previous) };
        h = verdict.next_h;
    }
    None
}

/// The unit direction at infinity of a ray that leaves and meets nothing more; `None` if it is lost.
pub(crate) fn at_infinity<F: IndexField, S: Stepper>(
    field: &F,
    stepper: &S,
    control: &FieldControl,
    ray: FieldRays<1>,
) -> Option<DVec3> {
    let there = to_infinity::<F, S, 1, 3>(field, stepper, control, ray, INFINITY)?;
    lane(&there.p, 0).try_normalize()
}
