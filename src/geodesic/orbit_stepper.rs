//! Ways to follow orbits step by step.

use super::{Control, Phase, Step, StepVerdict, Stepper};
use crate::math::real::Real;
use crate::spacetime::ConformallyFlat;

/// A way to follow orbits step by step: a [`Stepper`] of their equation, or a series.
pub trait OrbitStepper: Copy + Send + Sync {
    /// Order of the estimate that a first step is chosen for.
    const ORDER: u32;

    /// Step-size control, with the limits that these steps need.
    fn control<R: Real>(&self, control: &Control<R>) -> Control<R>;

    /// A step of length `h` in ξ, or a shorter one.
    fn step<M: ConformallyFlat, R: Real>(&self, medium: &M, b: R, start: Phase<R>, h: R) -> Step<R>;

    /// The step of length `h` in ξ: a part of one, its dense output.
    #[inline(always)]
    fn part<M: ConformallyFlat, R: Real>(&self, medium: &M, b: R, start: Phase<R>, h: R) -> Step<R> {
        self.step(medium, b, start, h)
    }

    /// Function that gives many parts of steps from a phase: not for kernels, whose code must be inlined.
    fn parts<M: ConformallyFlat, R: Real>(&self, medium: &M, b: R, start: Phase<R>) -> impl Fn(R) -> Step<R> {
        move |h| self.part(medium, b, start, h)
    }

    /// Judges a step whose arc is off by `arc_error`, after one whose relative error was `previous`.
    fn judge<R: Real>(
        &self,
        control: &Control<R>,
        step: &Step<R>,
        arc_error: R,
        previous: R,
    ) -> StepVerdict<R>;
}

impl<S: Stepper> OrbitStepper for S {
    const ORDER: u32 = S::ESTIMATE.order;

    fn control<R: Real>(&self, control: &Control<R>) -> Control<R> {
        *control
    }

    #[inline(always)]
    fn step<M: ConformallyFlat, R: Real>(&self, medium: &M, b: R, start: Phase<R>, h: R) -> Step<R> {
        Step::new(medium, self, b, start, h)
    }

    #[inline(always)]
    fn judge<R: Real>(
        &self,
        control: &Control<R>,
        step: &Step<R>,
        arc_error: R,
        previous: R,
    ) -> StepVerdict<R> {
        control.judge::<S>(step, arc_error, previous)
    }
}
