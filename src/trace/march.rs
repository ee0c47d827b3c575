//! The part of curved rays that depends on the method of integration: compiled once for each, behind one interface, so
//! that everything else is compiled once.

use super::columns::Row;
use super::curved::{CurvedFlight, CurvedMove, Lane};
use super::stages::advance::{Advance, advance_blocks};
use super::steppers::{UseStepper, with_stepper};
use crate::geodesic::{Control, End, Phase, Step, Stepper, Verdict, fit_arc, follow};
use crate::math::real::Real;
use crate::scene::StepperKind;
use crate::spacetime::{ConformallyFlat, Fate};

/// A stepper at work in a spacetime.
pub trait March<R: Lane>: Send + Sync {
    /// A first step length for a ray of impact parameter `b`.
    fn first_step(&self, b: R, phase: &Phase<R>) -> R;

    /// The next move of a ray.
    fn advance(&self, flight: &CurvedFlight<R>) -> CurvedMove<R>;

    /// The next moves of blocks of rays.
    fn advance_blocks(
        &self,
        flights: &[<CurvedFlight<R> as Row>::Block],
        moves: &mut [<CurvedMove<R> as Row>::Block],
    );

    /// One step of length `h`.
    fn step(&self, b: R, start: Phase<R>, h: R) -> Step<R>;

    /// Follows a ray to infinity.
    fn to_infinity(&self, b: R, start: Phase<R>, fate: Fate) -> End<R>;
}

/// The march by `stepper`; `None` for the paper's scheme, which is a transport of its own.
pub fn march<M: ConformallyFlat + 'static, R: Lane>(
    medium: M,
    stepper: StepperKind,
    control: Control<R>,
    outer: R,
) -> Option<Box<dyn March<R>>> {
    with_stepper(stepper, Held { medium, control, outer })
}

/// What a march is made of, but for the stepper.
struct Held<M, R> {
    /// The spacetime.
    medium: M,
    /// What steps are held to.
    control: Control<R>,
    /// Inverse radius beyond which there is nothing to meet.
    outer: R,
}

impl<M: ConformallyFlat + 'static, R: Lane> UseStepper for Held<M, R> {
    type Output = Box<dyn March<R>>;

    fn with(self, stepper: impl Stepper + 'static) -> Box<dyn March<R>> {
        Box::new(Stepping { held: self, stepper })
    }
}

/// Whether a step between two phases stays where the inverse radius is below `outer`: it does not turn in between.
#[inline(always)]
pub fn keeps_outside<R: Real>(outer: R, start: &Phase<R>, end: &Phase<R>) -> bool {
    let zero = R::of(0.0);
    (start.w < outer) & (end.w < outer) & ((start.v > zero) == (end.v > zero))
}

/// A march.
struct Stepping<M, S, R> {
    held: Held<M, R>,
    stepper: S,
}

impl<M: ConformallyFlat, S: Stepper, R: Lane> Advance for Stepping<M, S, R> {
    type Flight = CurvedFlight<R>;
    type Move = CurvedMove<R>;

    #[inline(always)]
    fn advance(&self, flight: &CurvedFlight<R>) -> CurvedMove<R> {
        let step = Step::new(&self.held.medium, &self.stepper, flight.b, flight.phase(), flight.h);
        let arc = fit_arc(&step);
        // What no search follows need not be followed closely.
        let arc_error =
            if keeps_outside(self.held.outer, &step.start, &step.end) { R::of(0.0) } else { arc.error };
        let Verdict { accepted, next_h, error } =
            self.held.control.judge::<S>(&step, arc_error, flight.error);
        let ([middle_x, middle_y], [end_x, end_y]) = (arc.middle, arc.end);
        CurvedMove {
            w: step.end.w,
            v: step.end.v,
            pull: step.end.pull,
            end_x,
            end_y,
            middle_x,
            middle_y,
            weight: arc.weight,
            next_h,
            error,
            accepted: accepted & (step.end.w > R::of(0.0)),
        }
    }
}

impl<M: ConformallyFlat, S: Stepper, R: Lane> March<R> for Stepping<M, S, R> {
    fn first_step(&self, b: R, phase: &Phase<R>) -> R {
        self.held.control.first_step::<M, S>(&self.held.medium, b, phase)
    }

    fn advance(&self, flight: &CurvedFlight<R>) -> CurvedMove<R> {
        Advance::advance(self, flight)
    }

    fn advance_blocks(
        &self,
        flights: &[<CurvedFlight<R> as Row>::Block],
        moves: &mut [<CurvedMove<R> as Row>::Block],
    ) {
        advance_blocks(self, flights, moves);
    }

    fn step(&self, b: R, start: Phase<R>, h: R) -> Step<R> {
        Step::new(&self.held.medium, &self.stepper, b, start, h)
    }

    fn to_infinity(&self, b: R, start: Phase<R>, fate: Fate) -> End<R> {
        follow(&self.held.medium, &self.stepper, &self.held.control, (b, start, fate), 0.0, |_| {}).end
    }
}
