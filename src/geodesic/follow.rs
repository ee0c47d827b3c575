//! A ray followed to its end where nothing is in its way.

use super::{Control, OrbitStepper, Phase, Step};
use crate::math::real::Real;
use crate::spacetime::{ConformallyFlat, Fate};

/// End of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OrbitEnd<R> {
    /// It crosses the sphere outwards in this phase, having swept this angle.
    Crosses(Phase<R>, R),
    /// It falls through the horizon before.
    Falls,
    /// It leaves to infinity without ever crossing the sphere outwards.
    Misses,
    /// It took more steps than allowed.
    StepLimit,
    /// Its state is no longer finite.
    NonFinite,
}

/// A ray, followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Journey<R> {
    /// End of the ray.
    pub end: OrbitEnd<R>,
    /// Inverse radius of the point nearest to the centre, if the ray passes one.
    pub periastron: Option<R>,
    /// True if the ray passes a throat: its end is on the other side, in the chart there.
    pub passes: bool,
    /// Steps tried.
    pub steps: u32,
}

/// Most steps tried.
const MAX_STEPS: u32 = 100_000;

/// Follows a ray of impact parameter `b` from `start` until it crosses the sphere of inverse radius `w_out` outwards
/// (0 is infinity), on either side of a throat, falls, or is lost; `each` sees every step that is taken.
pub fn follow<M: ConformallyFlat, S: OrbitStepper, R: Real>(
    medium: &M,
    stepper: &S,
    control: &Control<R>,
    (b, start, mut fate): (R, Phase<R>, Fate),
    w_out: f64,
    mut each: impl FnMut(&Step<R>),
) -> Journey<R> {
    let zero = R::of(0.0);
    let out = R::of(w_out);
    let control = stepper.control(control);
    let mut phase = start;
    let mut swept = zero;
    let mut h = control.first_step(medium, S::ORDER, b, &phase);
    let mut previous = R::of(1.0);
    let mut journey = Journey { end: OrbitEnd::StepLimit, periastron: None, passes: false, steps: 0 };
    let throat = R::of(1.0 / medium.throat());
    let mut take = |step: &Step<R>, swept: &mut R| {
        each(step);
        *swept = *swept + angle(step);
        step.end
    };
    while journey.steps < MAX_STEPS {
        let inwards = phase.v > zero;
        let falls = inwards && fate == Fate::Falls;
        if falls && medium.throat() == 0.0 {
            return Journey { end: OrbitEnd::Falls, ..journey };
        }
        if !inwards && phase.w < out {
            return Journey { end: OrbitEnd::Misses, ..journey };
        }
        journey.steps += 1;
        // Where a step ends is free: its length carries no derivative.
        let step = stepper.step(medium, b, phase, R::of(h.value()));
        let verdict = control.at_seam(medium, &step, stepper.judge(&control, &step, zero, previous));
        if !verdict.accepted {
            // A step that has vanished, or a state that is no longer finite.
            if verdict.next_h.value() < f64::from(f32::MIN_POSITIVE) || !phase.w.value().is_finite() {
                return Journey { end: OrbitEnd::NonFinite, ..journey };
            }
            h = verdict.next_h;
            continue;
        }
        let cut = |at: &dyn Fn(&Step<R>) -> (R, R)| land(medium, stepper, &step, at);
        if falls && step.end.w >= throat {
            phase = take(&until(medium, stepper, &step, throat), &mut swept).beyond_throat();
            (fate, journey.passes) = (Fate::Escapes, true);
        } else if inwards != (step.end.v > zero) {
            // The turning point first: the sphere may be crossed on either side of it.
            let b2 = b * b;
            let turn = cut(&|step| (step.end.v, (step.end.pull - b2 * step.end.w) * step.cos * step.cos));
            phase = take(&turn, &mut swept);
            phase.v = zero;
            if inwards {
                journey.periastron = Some(phase.w);
            } else {
                return Journey { end: OrbitEnd::Falls, ..journey };
            }
        } else if !inwards && step.end.w <= out {
            phase = take(&until(medium, stepper, &step, out), &mut swept);
            return Journey { end: OrbitEnd::Crosses(phase, swept), ..journey };
        } else {
            phase = take(&step, &mut swept);
        }
        h = control.within(verdict.next_h, b, &phase);
        previous = verdict.error;
    }
    journey
}

/// The angle that a step sweeps.
fn angle<R: Real>(step: &Step<R>) -> R {
    // atan of a number with a derivative: the derivative of the tangent, times the squared cosine.
    let tangent = step.b * step.h;
    R::of(libm::atan(tangent.value())) + (tangent - R::of(tangent.value())) * step.cos * step.cos
}

/// The part of `step` up to the inverse radius `w`.
pub fn until<M: ConformallyFlat, R: Real>(
    medium: &M,
    stepper: &impl OrbitStepper,
    step: &Step<R>,
    w: R,
) -> Step<R> {
    let mut part = land(medium, stepper, step, &|step| (step.end.w - w, step.end.v * step.cos * step.cos));
    // Beside a far sphere's inverse radius the rounding of the step is not small.
    part.end.w = w;
    part
}

/// The part of `step` up to the root of a function that `at` gives with its derivative in h, by Newton's method within
/// a bracket.
fn land<M: ConformallyFlat, R: Real>(
    medium: &M,
    stepper: &impl OrbitStepper,
    step: &Step<R>,
    at: &dyn Fn(&Step<R>) -> (R, R),
) -> Step<R> {
    let end_sign = at(step).0 > R::of(0.0);
    let (mut low, mut high) = (R::of(0.0), step.h);
    let mut piece = *step;
    for _ in 0..60 {
        let (miss, slope) = at(&piece);
        if (miss > R::of(0.0)) == end_sign {
            high = piece.h;
        } else {
            low = piece.h;
        }
        let newton = piece.h - miss / slope;
        let inside = newton > low && newton < high;
        let h = if inside { newton } else { R::of(0.5) * (low + high) };
        let moved = (h - piece.h).abs().value();
        piece = stepper.part(medium, step.b, step.start, h);
        if moved <= 2.0 * R::EPSILON * step.h.value() {
            break;
        }
    }
    piece
}
