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
    let parts = stepper.parts(medium, step.b, step.start);
    for _ in 0..60 {
        let (miss, slope) = at(&piece);
        if (miss > R::of(0.0)) == end_sign {
            high = piece.h;
        } else {
            low = piece.h;
        }
        let newton = piece.h - miss / slope;
        let inside = newton > low && newton < high;
        let is_near = (newton - piece.h).abs() <= R::of(R::EPSILON.sqrt()) * newton;
        piece = parts(if inside || is_near { newton } else { R::of(0.5) * (low + high) });
        // From so near, Newton's method leaves rounding.
        if is_near {
            break;
        }
    }
    piece
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geodesic::{Dop853, Launch, OrbitStepper, Rkn6};
    use crate::spacetime::{Chart, Interstellar, Schwarzschild};

    /// Least distance of a mouth from both ends of a step that passes it, in units of its inverse radius, over all steps of a
    /// ray; and how many steps pass.
    fn farthest(stepper: impl OrbitStepper, tolerance: f64, b: f64) -> (f64, u32) {
        let medium = Interstellar::new(1.0, 3.0, 0.4);
        let mouth = 1.0 / medium.mouth();
        let x = 6.0 * DVec3::X;
        let sine = b / (6.0 * medium.index(1.0 / 6.0));
        let direction = DVec3::new(-(1.0 - sine * sine).sqrt(), sine, 0.0);
        let launch = Launch::new(&medium, x, direction, f64::EPSILON);
        let control = Control::new(&medium, tolerance, f64::INFINITY);
        let start = Phase::new(&medium, launch.w, launch.v);
        let (mut worst, mut passing) = (0.0f64, 0);
        follow(&medium, &stepper, &control, (launch.b, start, launch.fate), 0.1, |step| {
            let [from, to] = [step.start.w, step.end.w].map(|w| w / mouth - 1.0);
            if (from < 0.0) != (to < 0.0) {
                worst = worst.max(from.abs().min(to.abs()));
                passing += 1;
            }
        });
        (worst, passing)
    }

    #[test]
    fn steps_end_at_the_mouths_of_a_cylindrical_throat() {
        for b in [0.0, 0.3, 0.9] {
            for tolerance in [1e-3, 1e-10] {
                for (worst, passing) in [farthest(Rkn6, tolerance, b), farthest(Dop853, tolerance, b)] {
                    let allowed = 0.01 * tolerance.sqrt();
                    assert!(passing == 2 && worst < allowed, "{b} at {tolerance:e}: {worst:e}, {passing}");
                }
            }
        }
    }

    #[test]
    fn rays_that_pass_all_geometry_by_turn_outside_it_and_others_within() {
        let medium = Schwarzschild::new(1.0);
        for farthest in [0.0, 5.0, 20.0] {
            let chart = Chart::new(&medium, 0.0, farthest);
            for b in (1..200).map(|i| 0.15 * f64::from(i)) {
                let x = 50.0 * DVec3::X;
                let sine = b / (50.0 * medium.index(1.0 / 50.0));
                let launch =
                    Launch::new(&medium, x, DVec3::new(-(1.0 - sine * sine).sqrt(), sine, 0.0), f64::EPSILON);
                let control = Control::<f64>::new(&medium, 1e-10, f64::INFINITY);
                let start = Phase::new(&medium, launch.w, launch.v);
                let journey = follow(&medium, &Dop853, &control, (launch.b, start, launch.fate), 0.0, |_| {});
                let passes = journey.periastron.is_some_and(|w| w < chart.outer);
                assert_eq!(chart.is_passed_by(launch.b, launch.w), passes, "{farthest} {b}: {journey:?}");
            }
        }
    }
}
