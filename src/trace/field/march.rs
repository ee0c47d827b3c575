//! The part of the march in a field that depends on the method of integration, behind one interface, so that everything
//! else is compiled once.

use glam::DVec3;

use super::flight::{FieldFlight, FieldMove};
use super::span::{FieldSpan, gather};
use crate::geodesic::{
    Dop853, FieldControl, FieldRays, FieldStep, FieldVerdict, Rkn6, Stepper, alone, at_infinity, lane,
    set_lane,
};
use crate::geometry::PrimitiveId;
use crate::light::{FieldRegions, LightSampler};
use crate::math::columns::{LANES, Row};
use crate::math::kernel::widest;
use crate::scene::StepperKind;
use crate::spacetime::IndexField;
use crate::trace::flight_status::FlightStatus;
use crate::trace::land_on_ray::{PartialStep, Pose};
use crate::trace::launch_point::LaunchPoint;

/// Place of capture: nothing is met within.
#[derive(Clone, Copy, Debug)]
pub struct Trap {
    /// World position of the hole.
    pub center: DVec3,
    /// Square of the distance within which rays that move inwards are captured.
    pub radius2: f64,
}

/// A stepper at work in a field.
pub trait FieldMarch: Send + Sync {
    /// A ray that starts.
    fn launch(&self, start: &LaunchPoint) -> FieldFlight;

    /// Blocks of rays that start.
    fn launch_all(&self, starts: &[<LaunchPoint as Row>::Block], flights: &mut [<FieldFlight as Row>::Block]);

    /// The next move of a ray.
    fn advance(&self, flight: &FieldFlight) -> FieldMove;

    /// The next moves of blocks of rays.
    fn advance_all(&self, flights: &[<FieldFlight as Row>::Block], moves: &mut [<FieldMove as Row>::Block]);

    /// Pose after a part of a step.
    fn pose(&self, span: &FieldSpan, part: &PartialStep) -> Pose;

    /// Poses after parts of blocks of steps.
    fn pose_all(
        &self,
        spans: &[<FieldSpan as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    );

    /// The direction at infinity of a ray that leaves and meets nothing more; `None` if it is lost.
    fn at_infinity(&self, flight: &FieldFlight) -> Option<DVec3>;

    /// Light sampling along these rays, with winding numbers up to `max_winding` about each hole.
    fn sampler(&self, max_winding: u32) -> Box<dyn LightSampler>;
}

/// The march by `stepper` in `field`, into `traps`. The steppers of higher order and of the least work stand for all: a
/// field takes [`Dop853`] where that is asked for, else [`Rkn6`].
pub fn march<F: IndexField>(
    field: F,
    stepper: StepperKind,
    control: FieldControl,
    traps: Vec<Trap>,
) -> Box<dyn FieldMarch> {
    match stepper {
        StepperKind::Dop853 => Box::new(FieldStepping { field, stepper: Dop853, control, traps }),
        StepperKind::Rkn6
        | StepperKind::Dopri5
        | StepperKind::Rkf45
        | StepperKind::Rkn4
        | StepperKind::Rk4
        | StepperKind::Leapfrog4
        | StepperKind::Series
        | StepperKind::Quadrature
        | StepperKind::Rk4Paper => Box::new(FieldStepping { field, stepper: Rkn6, control, traps }),
    }
}

/// A march.
struct FieldStepping<F, S> {
    field: F,
    stepper: S,
    control: FieldControl,
    traps: Vec<Trap>,
}

impl<F: IndexField, S: Stepper> FieldStepping<F, S> {
    /// Rays that start beside each other.
    #[inline(always)]
    fn starts<const L: usize>(
        &self,
        start: impl Fn(usize) -> LaunchPoint,
        mut each: impl FnMut(usize, FieldFlight),
    ) {
        let (mut x, mut d) = ([[0.0; L]; 3], [[0.0; L]; 3]);
        for l in 0..L {
            set_lane(&mut x, l, start(l).position);
            set_lane(&mut d, l, start(l).direction);
        }
        let rays = FieldRays::new(&self.field, &x, &d);
        for l in 0..L {
            let [position, momentum, force, lean] = vectors(&rays, l);
            each(
                l,
                FieldFlight {
                    position,
                    momentum,
                    force,
                    lean,
                    room: rays.room[l],
                    h: self.control.first_step(S::ESTIMATE.order, &rays, l),
                    error: 1.0,
                    origin_prim: start(l).origin_prim,
                    steps: 0,
                    status: FlightStatus::Flies,
                },
            );
        }
    }

    /// Moves of rays beside each other; `N` is 3 `L`.
    #[inline(always)]
    fn moves<const L: usize, const N: usize>(
        &self,
        rays: &FieldRays<L>,
        (h, previous): (&[f64; L], &[f64; L]),
        starts_on: &[bool; L],
        mut each: impl FnMut(usize, FieldMove),
    ) {
        let step = FieldStep::new::<N>(&self.field, &self.stepper, rays, h);
        let mut falls = [false; L];
        for &Trap { center, radius2 } in &self.traps {
            for (l, falls) in falls.iter_mut().enumerate() {
                let away = lane(&step.end.x, l) - center;
                let inwards = away.dot(lane(&step.end.p, l)) < 0.0;
                *falls |= inwards & (away.length_squared() <= radius2);
            }
        }
        for l in 0..L {
            let (middle, chord, weight, arc_error) = step.arc(rays, h[l], starts_on[l], l);
            let [position, momentum, force, lean] = vectors(&step.end, l);
            // What no search follows need not be followed closely.
            let start = (lane(&rays.x, l), lane(&rays.p, l));
            let searched = !self.control.keeps_outside(start, (position, momentum));
            let arc_error = if searched { arc_error } else { 0.0 };
            let FieldVerdict { accepted, next_h, error } =
                self.control.judge::<L, S>((&step, h[l]), arc_error, previous[l], l);
            let next = self.control.within(next_h, &step.end, l);
            each(
                l,
                FieldMove {
                    position,
                    momentum,
                    force,
                    lean,
                    room: step.end.room[l],
                    middle,
                    chord,
                    weight,
                    next_h: if accepted { next } else { next_h },
                    error,
                    is_close: self.control.is_close(chord, arc_error),
                    accepted,
                    falls: falls[l],
                },
            );
        }
    }

    /// Poses of rays beside each other.
    #[inline(always)]
    fn poses<const L: usize, const N: usize>(
        &self,
        rays: &FieldRays<L>,
        h: &[f64; L],
        part: impl Fn(usize) -> PartialStep,
        mut each: impl FnMut(usize, Pose),
    ) {
        let mut reached = *h;
        for (l, reached) in reached.iter_mut().enumerate() {
            *reached *= part(l).s;
        }
        let step = FieldStep::new::<N>(&self.field, &self.stepper, rays, &reached);
        for (l, &h) in h.iter().enumerate() {
            let [position, momentum, force, _] = vectors(&step.end, l);
            let per_n2 = 1.0 / momentum.length_squared();
            let tangent = momentum * per_n2.sqrt();
            let across = force - force.dot(tangent) * tangent;
            let pull = across.length();
            let bend = across * if pull > 0.0 { 1.0 / pull } else { 0.0 };
            // |dx/dτ| = n (1 + β·y)².
            let speed = h / (per_n2.sqrt() * step.ahead[l] * step.ahead[l]);
            let curvature = pull * per_n2;
            let inverse_scale = self.control.inverse_scale(curvature, step.end.room[l]);
            each(l, Pose { position, tangent, bend, curvature, inverse_scale, speed, s: part(l).s });
        }
    }
}

/// Places, momenta, forces and β of rays in a lane.
#[inline(always)]
fn vectors<const L: usize>(rays: &FieldRays<L>, l: usize) -> [DVec3; 4] {
    [lane(&rays.x, l), lane(&rays.p, l), lane(&rays.force, l), lane(&rays.lean, l)]
}

/// Blocks of rays that start.
struct FieldLaunches<'a, F, S> {
    march: &'a FieldStepping<F, S>,
    starts: &'a [<LaunchPoint as Row>::Block],
    flights: &'a mut [<FieldFlight as Row>::Block],
}

impl<F: IndexField, S: Stepper> pulp::NullaryFnOnce for FieldLaunches<'_, F, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (starts, flights) in self.starts.iter().zip(self.flights) {
            let start = |l| LaunchPoint::get(starts, l);
            self.march.starts::<LANES>(start, |l, flight| FieldFlight::set(flights, l, flight));
        }
    }
}

/// Blocks of rays to be moved.
struct FieldMoves<'a, F, S> {
    march: &'a FieldStepping<F, S>,
    flights: &'a [<FieldFlight as Row>::Block],
    moves: &'a mut [<FieldMove as Row>::Block],
}

impl<F: IndexField, S: Stepper> pulp::NullaryFnOnce for FieldMoves<'_, F, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (flights, moves) in self.flights.iter().zip(self.moves) {
            let (rays, h) = gather(|l| FieldFlight::get(flights, l).span());
            let (mut previous, mut starts_on) = ([0.0; LANES], [false; LANES]);
            for l in 0..LANES {
                let FieldFlight { error, origin_prim, .. } = FieldFlight::get(flights, l);
                (previous[l], starts_on[l]) = (error, origin_prim != PrimitiveId::NONE);
            }
            self.march.moves::<LANES, { 3 * LANES }>(&rays, (&h, &previous), &starts_on, |l, step| {
                FieldMove::set(moves, l, step);
            });
        }
    }
}

/// Blocks of parts of steps.
struct FieldPoses<'a, F, S> {
    march: &'a FieldStepping<F, S>,
    spans: &'a [<FieldSpan as Row>::Block],
    parts: &'a [<PartialStep as Row>::Block],
    poses: &'a mut [<Pose as Row>::Block],
}

impl<F: IndexField, S: Stepper> pulp::NullaryFnOnce for FieldPoses<'_, F, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for ((spans, parts), poses) in self.spans.iter().zip(self.parts).zip(self.poses) {
            let (rays, h) = FieldSpan::rays(spans);
            let part = |l| PartialStep::get(parts, l);
            self.march.poses::<LANES, { 3 * LANES }>(&rays, &h, part, |l, pose| Pose::set(poses, l, pose));
        }
    }
}

impl<F: IndexField, S: Stepper> FieldMarch for FieldStepping<F, S> {
    fn launch(&self, start: &LaunchPoint) -> FieldFlight {
        let mut launched = FieldFlight::default();
        self.starts::<1>(|_| *start, |_, flight| launched = flight);
        launched
    }

    fn launch_all(
        &self,
        starts: &[<LaunchPoint as Row>::Block],
        flights: &mut [<FieldFlight as Row>::Block],
    ) {
        widest(FieldLaunches { march: self, starts, flights });
    }

    fn advance(&self, flight: &FieldFlight) -> FieldMove {
        let mut moved = FieldMove::default();
        let (rays, h) = flight.span().ray();
        let starts_on = [flight.origin_prim != PrimitiveId::NONE];
        self.moves::<1, 3>(&rays, (&h, &[flight.error]), &starts_on, |_, step| moved = step);
        moved
    }

    fn advance_all(&self, flights: &[<FieldFlight as Row>::Block], moves: &mut [<FieldMove as Row>::Block]) {
        widest(FieldMoves { march: self, flights, moves });
    }

    fn pose(&self, span: &FieldSpan, part: &PartialStep) -> Pose {
        let mut posed = Pose::default();
        let (rays, h) = span.ray();
        self.poses::<1, 3>(&rays, &h, |_| *part, |_, pose| posed = pose);
        posed
    }

    fn pose_all(
        &self,
        spans: &[<FieldSpan as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    ) {
        widest(FieldPoses { march: self, spans, parts, poses });
    }

    fn at_infinity(&self, flight: &FieldFlight) -> Option<DVec3> {
        let rays = FieldRays::new(&self.field, &alone(flight.position), &alone(flight.momentum));
        at_infinity(&self.field, &self.stepper, &self.control, rays)
    }

    fn sampler(&self, max_winding: u32) -> Box<dyn LightSampler> {
        Box::new(FieldRegions::new(self.field.clone(), self.control.outer, max_winding))
    }
}
