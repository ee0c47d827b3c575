//! The part of rays around a spinning hole that depends on the length of the series: compiled once for each, behind one
//! interface, so that everything else is compiled once.

use glam::DVec3;

use super::flight::{SpinningFlight, SpinningMove};
use super::span::SpinningSpan;
use crate::geodesic::kerr::{
    MinoState, PlacedHole, Series, SeriesControl, SeriesStep, UnitHole, dense_displacement,
};
use crate::geodesic::{SpaceArc, UsePowers, fit_sampled_arc, with_powers};
use crate::geometry::PrimitiveId;
use crate::math::columns::Row;
use crate::math::fast_log2;
use crate::math::kernel::{Kernel, NOTHING, map};
use crate::spacetime::Chart;
use crate::trace::land_on_ray::{PartialStep, Pose};

/// Series of one length at work.
pub trait SeriesMarch: Send + Sync {
    /// The next move of a ray.
    fn advance(&self, flight: &SpinningFlight) -> SpinningMove;

    /// The next moves of blocks of rays.
    fn advance_all(
        &self,
        flights: &[<SpinningFlight as Row>::Block],
        moves: &mut [<SpinningMove as Row>::Block],
    );

    /// Pose after a part of a step.
    fn pose(&self, span: &SpinningSpan, part: &PartialStep) -> Pose;

    /// Poses after parts of blocks of steps.
    fn pose_all(
        &self,
        spans: &[<SpinningSpan as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    );

    /// Pose beside a span's point, given about what part of the step leads there.
    fn pose_beside(&self, span: &SpinningSpan, part: &PartialStep) -> Pose;

    /// Poses beside the points of blocks of spans, given about what parts of the steps lead there.
    fn pose_beside_all(
        &self,
        spans: &[<SpinningSpan as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    );
}

/// A march without the length of its series.
pub struct SpinningMarch {
    /// The hole.
    pub place: PlacedHole,
    /// Inverse radii beyond which there is nothing to meet.
    pub chart: Chart,
    /// Largest error of a ray's direction, radians.
    pub tolerance: f64,
    /// Largest distance between an arc and the curve, in units of the mass.
    pub arc_tolerance: f64,
}

impl UsePowers for SpinningMarch {
    type Output = Box<dyn SeriesMarch>;

    fn with<const P: usize>(self) -> Box<dyn SeriesMarch> {
        let control = SeriesControl::new(P, self.tolerance);
        let negligible = NEGLIGIBLE * self.tolerance;
        Box::new(SpinningSteps::<P> { held: self, control, negligible2: negligible * negligible })
    }
}

/// The march with series of the length that the tolerance calls for.
pub fn march(marching: SpinningMarch) -> Box<dyn SeriesMarch> {
    with_powers(marching.tolerance, marching)
}

struct SpinningSteps<const P: usize> {
    held: SpinningMarch,
    control: SeriesControl,
    /// Distance between an arc and the curve, relative to the chord, that is as good as none; squared.
    negligible2: f64,
}

/// Part of the tolerance by which an arc may miss the curve and still stand for it.
const NEGLIGIBLE: f64 = 0.1;
/// Aims a little below the tolerance, so that most arcs are accepted.
const SAFETY: f32 = 0.8;
/// Bounds on how arcs may grow from one to the next, and on how a rejected one shrinks.
const GROWTH: (f32, f32) = (0.8, 4.0);
const SHRINKAGE: (f32, f32) = (0.2, 0.7);
/// Inverse radius down to which a step may end outside the geometry, as a part of that which bounds it.
const OUTSIDE: f64 = 0.5;
/// Inverse radius down to which a step may end, as a part of that at its start: a longer way is no arc.
const FARTHEST: f64 = 0.25;
/// Parts of the way at which the arc is compared with the ray, at about which it is farthest off.
const EARLY: f64 = 0.2;
const LATE: f64 = 0.8;
/// Inverse radius at which a step from far outside ends, as a part of the same: so far out that the pull does not take
/// it in.
const EDGE: f64 = 0.7;

/// True if a step between two states stays at inverse radii below `outer`: it does not turn in between.
#[inline(always)]
pub fn keeps_outside(outer: f64, start: &MinoState, end: &MinoState) -> bool {
    (start.u < outer) & (end.u < outer) & ((start.v > 0.0) == (end.v > 0.0))
}

/// Displacement after about a `part` of the way of a step of length `h`.
///
/// Parts of the way are other parts of λ: on a straight radius u is linear. On a long way out the ray is bent, and its
/// arc is off, near its start: between both.
#[inline(always)]
fn on_the_way<const P: usize>(
    hole: &UnitHole,
    series: &Series<P>,
    step: &SeriesStep,
    h: f64,
    part: f64,
) -> DVec3 {
    let near = part * series.start.u;
    let of_way = near / (near + (1.0 - part) * step.end.u);
    dense_displacement(hole, series, 0.5 * (part + of_way) * h)
}

impl SpinningMarch {
    /// Length of a step: far outside the geometry, rays go to its edge in one step, and on their way out they do not go
    /// far beyond.
    #[inline(always)]
    fn length<const P: usize>(&self, control: &SeriesControl, series: &Series<P>) -> f64 {
        let outer = self.chart.outer;
        let edge = EDGE * outer;
        let MinoState { u, v, .. } = series.start;
        let end = OUTSIDE * if u > outer { outer } else { u };
        let end = if end > FARTHEST * u { end } else { FARTHEST * u };
        let h = control.length_to(&self.place.hole, series, end);
        let to_edge = (edge - u) / v;
        if (v > 0.0) & (u < OUTSIDE * edge) & (to_edge < h) { to_edge } else { h }
    }
}

impl<const P: usize> Kernel for SpinningSteps<P> {
    type A = SpinningFlight;
    type B = ();
    type Out = SpinningMove;

    #[inline(always)]
    fn run(&self, flight: &SpinningFlight, (): &()) -> SpinningMove {
        let held = &self.held;
        let (hole, state, constants) = (&held.place.hole, flight.state(), flight.constants());
        let series = Series::<P>::new(hole, &constants, &state);
        let h = held.length(&self.control, &series);
        let h = if flight.longest < h { flight.longest } else { h };
        let step = SeriesStep::new(hole, &constants, &series, h);
        let points = [
            on_the_way(hole, &series, &step, h, EARLY),
            on_the_way(hole, &series, &step, h, 0.5),
            on_the_way(hole, &series, &step, h, LATE),
        ];
        let tangents = [state.velocity_winding(hole, series.winding[0]), step.end.velocity(hole, &constants)];
        let SpaceArc { middle, weight, error } = {
            let starts_on = flight.origin_prim != PrimitiveId::NONE;
            fit_sampled_arc(step.displacement, points, tangents, starts_on)
        };
        // What no search follows need not be followed closely.
        let searched = !keeps_outside(held.chart.outer, &state, &step.end);
        let error = if searched { error } else { 0.0 };
        let holds = step.is_accepted(hole, &constants, &state);
        let accepted = holds & (error <= held.arc_tolerance);
        // Twisted curves part from their arcs with the third power of the length.
        let ratio = (held.arc_tolerance / error) as f32;
        let root = fast_log2::exp2(fast_log2::log2(ratio) / 3);
        let (least, most) = if accepted { GROWTH } else { SHRINKAGE };
        let factor = SAFETY * root;
        let factor = if factor > least { factor } else { least };
        let factor = if factor < most { factor } else { most };
        let by_arc = if searched { f64::from(factor) * h } else { f64::INFINITY };
        let chord2 = step.displacement.length_squared();
        let scale = |vector: DVec3| held.place.outwards(vector * held.place.mass);
        let MinoState { u, v, n, m } = step.end;
        SpinningMove {
            h,
            u,
            v,
            n,
            m,
            end: scale(step.displacement),
            middle: scale(middle),
            weight,
            longest: if holds { by_arc } else { 0.5 * h },
            is_close: error * error <= self.negligible2 * chord2,
            accepted,
        }
    }
}

/// Parts of steps: as they are, or `BESIDE` the points of their spans, by a step of Newton's method, which costs less
/// than to make the series again.
struct SpinningPoses<'a, const P: usize, const BESIDE: bool>(&'a SpinningSteps<P>);

impl<const P: usize, const BESIDE: bool> Kernel for SpinningPoses<'_, P, BESIDE> {
    type A = SpinningSpan;
    type B = PartialStep;
    type Out = Pose;

    #[inline(always)]
    fn run(&self, span: &SpinningSpan, part: &PartialStep) -> Pose {
        let place = &self.0.held.place;
        let (hole, state, constants) = (&place.hole, span.state(), span.constants());
        let series = Series::<P>::new(hole, &constants, &state);
        let part = if BESIDE {
            let there = series.at(hole, part.s * span.h).state;
            let velocity = there.velocity(hole, &constants);
            let way = place.inwards(span.way) * (1.0 / place.mass);
            let ahead = way - dense_displacement(hole, &series, part.s * span.h);
            let share = ahead.dot(velocity) / velocity.length_squared();
            let nearer = part.s + share * (there.u * there.u) / span.h;
            let nearer = if nearer > 0.0 { nearer } else { 0.0 };
            if nearer < 1.0 { nearer } else { 1.0 }
        } else {
            part.s
        };
        let step = SeriesStep::new(hole, &constants, &series, part * span.h);
        let [velocity, turning] = step.end.motion(hole, &constants);
        let length = velocity.length();
        let tangent = velocity * (1.0 / length);
        let across = turning - turning.dot(tangent) * tangent;
        let bending = across.length();
        let u = step.end.u;
        let per_mass = 1.0 / place.mass;
        let unbent = bending > 0.0;
        let bend = across * (1.0 / if unbent { bending } else { 1.0 });
        Pose {
            position: span.position + place.outwards(step.displacement * place.mass),
            tangent: place.outwards(tangent),
            bend: place.outwards(bend),
            curvature: bending / (length * length) * per_mass,
            inverse_scale: u * per_mass,
            speed: span.h * length / (u * u) * place.mass,
            s: part,
        }
    }
}

impl<const P: usize> SeriesMarch for SpinningSteps<P> {
    fn advance(&self, flight: &SpinningFlight) -> SpinningMove {
        self.run(flight, &())
    }

    fn advance_all(
        &self,
        flights: &[<SpinningFlight as Row>::Block],
        moves: &mut [<SpinningMove as Row>::Block],
    ) {
        map(self, flights, NOTHING, moves);
    }

    fn pose(&self, span: &SpinningSpan, part: &PartialStep) -> Pose {
        SpinningPoses::<P, false>(self).run(span, part)
    }

    fn pose_all(
        &self,
        spans: &[<SpinningSpan as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    ) {
        map(&SpinningPoses::<P, false>(self), spans, parts, poses);
    }

    fn pose_beside(&self, span: &SpinningSpan, part: &PartialStep) -> Pose {
        SpinningPoses::<P, true>(self).run(span, part)
    }

    fn pose_beside_all(
        &self,
        spans: &[<SpinningSpan as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    ) {
        map(&SpinningPoses::<P, true>(self), spans, parts, poses);
    }
}
