//! The part of curved rays that depends on the method of integration: compiled once for each, behind one interface, so
//! that everything else is compiled once.

use super::super::steppers::{UseStepper, with_stepper};
use super::flight::{CurvedFlight, CurvedMove, Lane};
use super::span::Span;
use crate::geodesic::{
    ArealSeries, Control, OrbitEnd, OrbitStepper, Phase, StepVerdict, Stepper, UsePowers, fit_arc, follow,
    until, with_powers,
};
use crate::math::columns::Row;
use crate::math::kernel::{Kernel, NOTHING, map, map_full};
use crate::math::real::Real;
use crate::scene::StepperKind;
use crate::spacetime::{Chart, ConformallyFlat, Fate, ReissnerNordstrom};
use crate::trace::land_on_ray::{PartialStep, Pose};

/// A stepper at work in a spacetime.
pub trait March<R: Lane>: Send + Sync {
    /// Order of the stepper's estimate.
    fn order(&self) -> u32;

    /// Step-size control.
    fn control(&self) -> Control<R>;

    /// The next move of a ray.
    fn advance(&self, flight: &CurvedFlight<R>) -> CurvedMove<R>;

    /// The next moves of blocks of rays.
    fn advance_all(
        &self,
        flights: &[<CurvedFlight<R> as Row>::Block],
        moves: &mut [<CurvedMove<R> as Row>::Block],
    );

    /// Pose after a part of a step.
    fn pose(&self, span: &Span<R>, part: &PartialStep) -> Pose;

    /// Poses after parts of blocks of steps.
    fn pose_all(
        &self,
        spans: &[<Span<R> as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    );

    /// Length and end of the part of a ray's next step up to the inverse radius `w`, which the step passes.
    fn until(&self, flight: &CurvedFlight<R>, w: R) -> (R, Phase<R>);

    /// Follows a ray to infinity.
    fn to_infinity(&self, b: R, start: Phase<R>, fate: Fate) -> OrbitEnd<R>;
}

/// The march by `stepper`; `None` for the paper's scheme, which is a transport of its own.
pub fn march<M: ConformallyFlat, R: Lane>(
    medium: M,
    (stepper, tolerance): (StepperKind, f64),
    control: Control<R>,
    chart: Chart,
) -> Option<Box<dyn March<R>>> {
    match medium.as_hole() {
        Some(hole) if matches!(stepper, StepperKind::Series | StepperKind::Quadrature) => {
            let medium = ReissnerNordstrom::of(hole);
            Some(with_powers(tolerance, HoleSeries { held: Held { medium, control, chart }, tolerance }))
        }
        _ => with_stepper(stepper, Held { medium, control, chart }),
    }
}

/// A march by series.
struct HoleSeries<R> {
    held: Held<ReissnerNordstrom, R>,
    tolerance: f64,
}

impl<R: Lane> UsePowers for HoleSeries<R> {
    type Output = Box<dyn March<R>>;

    fn with<const P: usize>(self) -> Box<dyn March<R>> {
        let stepper = ArealSeries::<P>::new(&self.held.medium.hole(), self.tolerance);
        Box::new(Stepping::new(self.held, stepper))
    }
}

/// The march by a stepper.
pub fn march_by<M: ConformallyFlat, R: Lane>(
    stepper: impl Stepper + 'static,
    medium: M,
    control: Control<R>,
    chart: Chart,
) -> Box<dyn March<R>> {
    Held { medium, control, chart }.with(stepper)
}

/// Parts of a march other than the stepper.
struct Held<M, R> {
    /// The spacetime.
    medium: M,
    /// Step-size control.
    control: Control<R>,
    /// Radii beyond which there is nothing to meet.
    chart: Chart,
}

impl<M: ConformallyFlat, R: Lane> UseStepper for Held<M, R> {
    type Output = Box<dyn March<R>>;

    fn with(self, stepper: impl Stepper + 'static) -> Box<dyn March<R>> {
        Box::new(Stepping::new(self, stepper))
    }
}

/// True if a step between two phases keeps outside all geometry: its ray passes that by, or the step does not turn and has
/// both ends outside.
#[inline(always)]
pub fn keeps_outside<R: Real>(chart: &Chart, b: R, start: &Phase<R>, end: &Phase<R>) -> bool {
    let (zero, outer) = (R::of(0.0), R::of(chart.outer));
    chart.is_passed_by(b.value(), start.w.value())
        | (start.w < outer) & (end.w < outer) & ((start.v > zero) == (end.v > zero))
}

/// A march.
struct Stepping<M, S, R> {
    held: Held<M, R>,
    stepper: S,
}

impl<M, S: OrbitStepper, R: Lane> Stepping<M, S, R> {
    fn new(held: Held<M, R>, stepper: S) -> Self {
        Self { held: Held { control: stepper.control(&held.control), ..held }, stepper }
    }
}

impl<M: ConformallyFlat, S: OrbitStepper, R: Lane> Kernel for Stepping<M, S, R> {
    type A = CurvedFlight<R>;
    type B = ();
    type Out = CurvedMove<R>;

    #[inline(always)]
    fn run(&self, flight: &CurvedFlight<R>, (): &()) -> CurvedMove<R> {
        let Held { medium, control, chart } = &self.held;
        let step = self.stepper.step(medium, flight.b, flight.phase(), flight.h);
        let arc = fit_arc(&step);
        // Steps that no search follows need not be followed closely.
        let searched = !keeps_outside(chart, step.b, &step.start, &step.end);
        let arc_error = if searched { arc.error } else { R::of(0.0) };
        let verdict = self.stepper.judge(control, &step, arc_error, flight.error);
        let StepVerdict { accepted, next_h, error } = control.at_seam(medium, &step, verdict);
        let ([middle_x, middle_y], [end_x, end_y]) = (arc.middle, arc.end);
        CurvedMove {
            w: step.end.w,
            v: step.end.v,
            h: step.h,
            pull: step.end.pull,
            end_x,
            end_y,
            middle_x,
            middle_y,
            weight: arc.weight,
            next_h,
            error,
            is_close: control.is_close(&arc),
            accepted: accepted & (step.end.w > R::of(0.0)),
        }
    }
}

/// Parts of steps.
struct Posing<'a, M, S, R>(&'a Stepping<M, S, R>);

impl<M: ConformallyFlat, S: OrbitStepper, R: Lane> Kernel for Posing<'_, M, S, R> {
    type A = Span<R>;
    type B = PartialStep;
    type Out = Pose;

    #[inline(always)]
    fn run(&self, span: &Span<R>, part: &PartialStep) -> Pose {
        span.pose(&self.0.held.medium, &self.0.stepper, part)
    }
}

impl<M: ConformallyFlat, S: OrbitStepper, R: Lane> March<R> for Stepping<M, S, R> {
    fn order(&self) -> u32 {
        S::ORDER
    }

    fn control(&self) -> Control<R> {
        self.held.control
    }

    fn advance(&self, flight: &CurvedFlight<R>) -> CurvedMove<R> {
        self.run(flight, &())
    }

    fn advance_all(
        &self,
        flights: &[<CurvedFlight<R> as Row>::Block],
        moves: &mut [<CurvedMove<R> as Row>::Block],
    ) {
        map_full::<R, _>(self, flights, NOTHING, moves);
    }

    fn pose(&self, span: &Span<R>, part: &PartialStep) -> Pose {
        Posing(self).run(span, part)
    }

    fn pose_all(
        &self,
        spans: &[<Span<R> as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    ) {
        map(&Posing(self), spans, parts, poses);
    }

    fn until(&self, flight: &CurvedFlight<R>, w: R) -> (R, Phase<R>) {
        let Self { held: Held { medium, .. }, stepper } = self;
        let step = stepper.step(medium, flight.b, flight.phase(), flight.h);
        let part = until(medium, stepper, &step, w);
        (part.h, part.end)
    }

    fn to_infinity(&self, b: R, start: Phase<R>, fate: Fate) -> OrbitEnd<R> {
        follow(&self.held.medium, &self.stepper, &self.held.control, (b, start, fate), 0.0, |_| {}).end
    }
}
