//! The part of curved rays that depends on the method of integration: compiled once for each, behind one interface, so
//! that everything else is compiled once.

use super::columns::Row;
use super::curved::{CurvedFlight, CurvedMove, Lane};
use super::stages::advance::{Advance, advance_blocks};
use crate::geodesic::{
    Control, Dop853, Dopri5, End, Leapfrog4, Phase, Rk4, Rkf45, Rkn4, Rkn6, Step, Stepper, Verdict, fit_arc,
    follow,
};
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

/// The march by `stepper`; the paper's scheme, which is a transport of its own, counts as the default stepper here.
pub fn march<M: ConformallyFlat + 'static, R: Lane>(
    medium: M,
    stepper: StepperKind,
    control: Control<R>,
    outer: R,
) -> Box<dyn March<R>> {
    fn stepping<M: ConformallyFlat + 'static, R: Lane>(
        medium: M,
        stepper: impl Stepper + 'static,
        (control, outer): (Control<R>, R),
    ) -> Box<dyn March<R>> {
        Box::new(Stepping { medium, stepper, control, outer })
    }
    let held = (control, outer);
    match stepper {
        StepperKind::Rkn6 | StepperKind::Rk4Paper => stepping(medium, Rkn6, held),
        StepperKind::Dop853 => stepping(medium, Dop853, held),
        StepperKind::Dopri5 => stepping(medium, Dopri5, held),
        StepperKind::Rkf45 => stepping(medium, Rkf45, held),
        StepperKind::Rkn4 => stepping(medium, Rkn4, held),
        StepperKind::Rk4 => stepping(medium, Rk4, held),
        StepperKind::Leapfrog4 => stepping(medium, Leapfrog4, held),
    }
}

/// Whether a step between two phases stays where the inverse radius is below `outer`: it does not turn in between.
#[inline(always)]
pub fn keeps_outside<R: Real>(outer: R, start: &Phase<R>, end: &Phase<R>) -> bool {
    let zero = R::of(0.0);
    (start.w < outer) & (end.w < outer) & ((start.v > zero) == (end.v > zero))
}

/// A stepper, a spacetime, and what steps are held to.
struct Stepping<M, S, R> {
    /// The spacetime.
    medium: M,
    /// The method of integration.
    stepper: S,
    /// What its steps are held to.
    control: Control<R>,
    /// Inverse radius beyond which there is nothing to meet.
    outer: R,
}

impl<M: ConformallyFlat, S: Stepper, R: Lane> Advance for Stepping<M, S, R> {
    type Flight = CurvedFlight<R>;
    type Move = CurvedMove<R>;

    #[inline(always)]
    fn advance(&self, flight: &CurvedFlight<R>) -> CurvedMove<R> {
        let step = Step::new(&self.medium, &self.stepper, flight.b, flight.phase(), flight.h);
        let arc = fit_arc(&step);
        // What no search follows need not be followed closely.
        let arc_error =
            if keeps_outside(self.outer, &step.start, &step.end) { R::of(0.0) } else { arc.error };
        let Verdict { accepted, next_h, error } = self.control.judge::<S>(&step, arc_error, flight.error);
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
        self.control.first_step::<M, S>(&self.medium, b, phase)
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
        Step::new(&self.medium, &self.stepper, b, start, h)
    }

    fn to_infinity(&self, b: R, start: Phase<R>, fate: Fate) -> End<R> {
        follow(&self.medium, &self.stepper, &self.control, (b, start, fate), 0.0, |_| {}).end
    }
}
