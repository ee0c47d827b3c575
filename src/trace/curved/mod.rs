//! Curved rays: orbits stepped under error control, searched as arcs.

mod commit_step;
mod land_on_arc;
mod launch;
pub mod march;
mod span;

use glam::DVec3;

use super::land_on_ray::{RayLandings, land_all_on_rays, land_on_ray};
use super::transport::{Landing, Moved, Outcome, Start, Transport};
use crate::geodesic::{Arc, Control, End, Phase, PlaneArc};
use crate::geometry::{Found, Geometry, Need, PrimitiveId, Query};
use crate::light::Lensed;
use crate::math::columns::{Columns, Field, LANES, Row, columns, plain_field};
use crate::math::kernel::{Kernel, NOTHING, map, update};
use crate::math::real::Real;
use crate::spacetime::{Chart, ConformallyFlat, Fate};
use commit_step::{Committing, Turn};
use land_on_arc::ArcLandings;
use launch::{Launching, Place};
use march::{March, keeps_outside};
use span::Span;

/// A number that columns can hold.
pub trait Lane: Real + Field<Block<LANES>: Send> {}
impl<R: Real + Field<Block<LANES>: Send>> Lane for R {}

/// Rays of a static, spherically symmetric spacetime, followed in numbers of type `R`.
///
/// Orbits are in `R`; places are in f64, and moved by displacements that are good to the rounding of `R` relative to
/// the step: nothing jitters far from the origin.
pub struct Curved<M, R> {
    /// The spacetime.
    pub medium: M,
    /// The method of integration in it.
    pub march: Box<dyn March<R>>,
    /// World position of its centre.
    pub center: DVec3,
    /// Whether it matters where rays go that leave; else they are not followed there.
    pub sky: bool,
    /// Where rays may stop.
    pub chart: Chart,
    /// What steps are held to.
    pub control: Control<R>,
    /// Largest error of a ray's direction, radians.
    pub tolerance: f64,
    /// Largest distance between an arc and the curve.
    pub arc_tolerance: f64,
    /// Arcs with a larger sagitta are searched in halves: a thick chord meets too many boxes. Infinite without boxes.
    pub longest_sagitta: f64,
    /// Longer arcs are searched in halves: beside them, the geometry would drown in their rounding.
    pub longest_chord: f64,
    /// World bounds of the geometry; arcs outside are not searched.
    pub bounds: (DVec3, DVec3),
}

plain_field!(Fate);

columns! {
    /// A curved ray.
    pub struct CurvedFlight<R> => CurvedFlightBlock {
        /// Position, relative to the spacetime's centre.
        position: DVec3,
        /// Unit vector from the centre to the position.
        radial: DVec3,
        /// Unit vector across it in the orbit's plane, in the sense of motion.
        along: DVec3,
        /// Impact parameter.
        b: R,
        /// Inverse radius.
        w: R,
        /// dw/dψ.
        v: R,
        /// ½ dn²/dw.
        pull: R,
        /// Length in ξ to try next.
        h: R,
        /// Relative error of the step before.
        error: R,
        /// How the ray ends if nothing is in its way.
        fate: Fate,
        /// What the position lies on, until the first step is taken.
        leaves: PrimitiveId,
        /// Steps so far, rejected ones included.
        steps: u32,
        /// What became of it in the last of them.
        turn: Turn,
    }
}

columns! {
    /// One step of a curved ray; places from its start, along the radius there and across it.
    pub struct CurvedMove<R> => CurvedMoveBlock {
        /// Inverse radius at the end.
        w: R,
        /// dw/dψ at the end.
        v: R,
        /// ½ dn²/dw at the end.
        pull: R,
        /// End, outwards.
        end_x: R,
        /// End, across.
        end_y: R,
        /// Middle control point of the arc, outwards.
        middle_x: R,
        /// Middle control point of the arc, across.
        middle_y: R,
        /// Its weight.
        weight: R,
        /// Length in ξ to try next.
        next_h: R,
        /// Relative error.
        error: R,
        /// Whether the arc is so near the ray that what it meets is where the ray meets it.
        is_close: bool,
        /// Whether the step is good enough to be taken.
        accepted: bool,
    }
}

/// Most times that an arc is halved because of its sagitta.
const MOST_FOR_SAGITTA: u32 = 8;
/// Most times that an arc is halved because of its length.
const MOST_FOR_LENGTH: u32 = 60;
/// How far outside the geometry a step may end, as a part of the inverse radius that bounds it.
const OUTSIDE: f64 = 0.5;
/// Where a step from far outside ends, as a part of the same: so far out that the pull does not take it in.
const EDGE: f64 = 0.7;

impl<R: Lane> CurvedFlight<R> {
    /// Where the ray is on its orbit.
    #[inline(always)]
    pub fn phase(&self) -> Phase<R> {
        Phase { w: self.w, v: self.v, pull: self.pull }
    }

    /// Unit direction of travel.
    fn direction(&self) -> DVec3 {
        self.place(-self.v, self.b * self.w).normalize()
    }

    /// A vector in the orbit's plane, from components along the radius and across it.
    #[inline(always)]
    pub(super) fn place(&self, outwards: R, across: R) -> DVec3 {
        outwards.value() * self.radial + across.value() * self.along
    }
}

impl<M: ConformallyFlat, R: Lane> Curved<M, R> {
    /// The step's arc, in world coordinates.
    #[inline(always)]
    fn arc(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> Arc {
        let plane = PlaneArc {
            middle: [step.middle_x, step.middle_y],
            end: [step.end_x, step.end_y],
            weight: step.weight,
            error: R::of(0.0),
        };
        plane.placed(flight.position + self.center, flight.radial, flight.along)
    }

    /// Whether a step can meet anything.
    #[inline(always)]
    fn is_searched(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> bool {
        let end = Phase { w: step.w, v: step.v, pull: step.pull };
        step.accepted & !keeps_outside(R::of(self.chart.outer), &flight.phase(), &end)
    }

    #[inline(always)]
    fn may_meet(&self, arc: &Arc) -> bool {
        let (min, max) = self.bounds;
        let (low, high) = (arc.p0.min(arc.p1).min(arc.p2), arc.p0.max(arc.p1).max(arc.p2));
        let within = |low: f64, high: f64, min: f64, max: f64| (low <= max) & (high >= min);
        within(low.x, high.x, min.x, max.x)
            & within(low.y, high.y, min.y, max.y)
            & within(low.z, high.z, min.z, max.z)
    }

    /// Searches an arc, in halves if it is thick or long beside the geometry.
    fn sweep<F>(&self, arc: &Arc, leaves: PrimitiveId, halvings: u32, search: &mut F) -> Option<Found>
    where
        F: FnMut(&Arc, PrimitiveId) -> Option<Found>,
    {
        if !self.may_meet(arc) {
            return None;
        }
        if self.is_split(arc, halvings) {
            let (left, right) = arc.halves();
            let first = self.sweep(&left, leaves, halvings + 1, search);
            return first.or_else(|| self.sweep(&right, PrimitiveId::NONE, halvings + 1, search));
        }
        search(arc, leaves)
    }

    /// A length of at most `h` for the next step: far outside the geometry, rays go to its edge in one step, and on
    /// their way out they do not go far beyond.
    #[inline(always)]
    fn within(&self, h: R, b: R, phase: &Phase<R>) -> R {
        let h = self.control.within(h, b, phase);
        let outer = R::of(self.chart.outer);
        let (outside, edge) = (R::of(OUTSIDE), R::of(EDGE) * outer);
        let (w, v) = (phase.w, phase.v);
        if v < R::of(0.0) {
            let end = if w > outer { outside * outer } else { outside * w };
            h.at_most((end - w) / v)
        } else if w < outside * edge {
            h.at_most((edge - w) / v)
        } else {
            h
        }
    }

    /// What becomes of a ray that met nothing, given its next state.
    fn outcome(&self, next: &CurvedFlight<R>) -> Outcome<CurvedFlight<R>> {
        match next.turn {
            Turn::Flies => Outcome::Flying(*next),
            Turn::Leaves if !self.sky => Outcome::Escaped(next.direction()),
            Turn::Leaves => self.direction_at_infinity(next),
            Turn::Falls => Outcome::Captured,
            Turn::StepLimit => Outcome::StepLimit,
            Turn::NonFinite => Outcome::NonFinite,
        }
    }

    /// The direction at infinity of a ray that meets nothing more.
    fn direction_at_infinity(&self, flight: &CurvedFlight<R>) -> Outcome<CurvedFlight<R>> {
        match self.march.to_infinity(flight.b, flight.phase(), flight.fate) {
            End::Crosses(_, swept) => {
                let (sin, cos) = libm::sincos(swept.value());
                Outcome::Escaped((cos * flight.radial + sin * flight.along).normalize())
            }
            End::StepLimit => Outcome::StepLimit,
            End::Falls | End::Misses | End::NonFinite => Outcome::NonFinite,
        }
    }

    /// Where a ray lands that meets what a search found: if a `geometry` is given on the ray itself, unless the arc is as
    /// good.
    fn landing(
        &self,
        geometry: Option<&Geometry>,
        flight: &CurvedFlight<R>,
        step: &CurvedMove<R>,
        found: Found,
    ) -> Landing {
        match geometry {
            Some(geometry) if !step.is_close => land_on_ray(self, geometry, (flight, step), found),
            _ => self.land_on_arc(flight, step, found),
        }
    }

    /// Whether an arc is to be searched in halves, after it has been halved so often.
    #[inline(always)]
    fn is_split(&self, arc: &Arc, halvings: u32) -> bool {
        let length2 = arc.p0.distance_squared(arc.p2);
        ((halvings < MOST_FOR_SAGITTA) & (arc.sagitta() > self.longest_sagitta))
            | ((halvings < MOST_FOR_LENGTH) & (length2 > self.longest_chord * self.longest_chord))
    }
}

/// How moves are searched.
struct Asking<'a, M, R>(&'a Curved<M, R>);

impl<M: ConformallyFlat, R: Lane> Kernel for Asking<'_, M, R> {
    type A = CurvedFlight<R>;
    type B = CurvedMove<R>;
    type Out = Query<Arc>;

    #[inline(always)]
    fn run(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> Query<Arc> {
        let segment = self.0.arc(flight, step);
        let whole = if self.0.is_split(&segment, 0) { Need::Pieces } else { Need::Whole };
        let may = self.0.is_searched(flight, step) & self.0.may_meet(&segment);
        let need = if may { whole } else { Need::Nothing };
        Query { segment, leaves: flight.leaves, need }
    }
}

/// What a wavefront of curved rays keeps from round to round.
#[derive(Default)]
pub struct Scratch<R: Lane> {
    starts: Columns<Place>,
    launched: Columns<CurvedFlight<R>>,
    on_rays: RayLandings<Span<R>>,
    on_arcs: ArcLandings,
}

impl<M: ConformallyFlat, R: Lane> Transport for Curved<M, R> {
    type Flight = CurvedFlight<R>;
    type Move = CurvedMove<R>;
    type Segment = Arc;
    type Scratch = Scratch<R>;
    type Carried = ();
    type Aim = Lensed<M>;

    fn aim(&self, max_winding: u32) -> Option<Lensed<M>> {
        Lensed::new(self.medium, self.center, max_winding)
    }

    fn launch(&self, &Start { position, direction, leaves, carried: () }: &Start) -> CurvedFlight<R> {
        Launching::of(self).run(&Place { position, direction, leaves }, &())
    }

    fn launch_all(
        &self,
        starts: &[(usize, Start)],
        flights: &mut Columns<CurvedFlight<R>>,
        scratch: &mut Scratch<R>,
    ) {
        let Scratch { starts: places, launched, .. } = scratch;
        let lanes = starts.len();
        places.gather(lanes, |i| {
            let (_, Start { position, direction, leaves, carried: () }) = starts[i];
            Place { position, direction, leaves }
        });
        launched.resize(lanes);
        map(&Launching::of(self), places.blocks(lanes), NOTHING, launched.blocks_mut(lanes));
        for (i, &(lane, _)) in starts.iter().enumerate() {
            flights.set(lane, launched.get(i));
        }
    }

    fn advance(&self, flight: &CurvedFlight<R>) -> CurvedMove<R> {
        self.march.advance(flight)
    }

    fn advance_all(
        &self,
        flights: &[<Self::Flight as Row>::Block],
        moves: &mut [<Self::Move as Row>::Block],
    ) {
        self.march.advance_all(flights, moves);
    }

    fn queries_all(
        &self,
        flights: &[<Self::Flight as Row>::Block],
        moves: &[<Self::Move as Row>::Block],
        queries: &mut [<Query<Arc> as Row>::Block],
    ) {
        map(&Asking(self), flights, moves, queries);
    }

    #[inline(always)]
    fn search(
        &self,
        flight: &Self::Flight,
        step: &Self::Move,
        mut search: impl FnMut(&Arc, PrimitiveId) -> Option<Found>,
    ) -> Option<Found> {
        if !self.is_searched(flight, step) {
            return None;
        }
        self.sweep(&self.arc(flight, step), flight.leaves, 0, &mut search)
    }

    #[inline(always)]
    fn settle(
        &self,
        geometry: Option<&Geometry>,
        flight: &Self::Flight,
        step: &Self::Move,
        found: Option<Found>,
    ) -> (Outcome<CurvedFlight<R>>, ()) {
        let outcome = match found {
            Some(found) => Outcome::Landed(self.landing(geometry, flight, step, found)),
            None => self.outcome(&Committing(self).run(flight, step)),
        };
        (outcome, ())
    }

    fn settle_all(
        &self,
        moved: Moved<Self>,
        scratch: &mut Scratch<R>,
        mut end: impl FnMut(usize, Outcome<CurvedFlight<R>>, ()),
    ) {
        let Moved { geometry, flights, moves, found, exactly } = moved;
        let Scratch { on_rays, on_arcs, .. } = scratch;
        let lanes = found.len();
        on_rays.hits.clear();
        on_arcs.hits.clear();
        for (lane, found) in found.iter().enumerate() {
            let Some(found) = *found else { continue };
            let stays = !exactly[lane] || moves.get(lane).is_close;
            let hits = if stays { &mut on_arcs.hits } else { &mut on_rays.hits };
            hits.push((lane, found));
        }
        self.land_all_on_arcs(flights, moves, on_arcs, |lane, landing| {
            end(lane, Outcome::Landed(landing), ())
        });
        land_all_on_rays(self, geometry, (flights, moves), on_rays, |lane, landing| {
            end(lane, Outcome::Landed(landing), ());
        });
        // Those that landed go on as well, to nowhere.
        update(&Committing(self), flights.blocks_mut(lanes), moves.blocks(lanes));
        for (lane, found) in found.iter().enumerate() {
            // Few rays end without landing: what was found is seldom asked for.
            if flights.get(lane).turn != Turn::Flies && found.is_none() {
                end(lane, self.outcome(&flights.get(lane)), ());
            }
        }
    }

    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Arc> {
        step.accepted.then(|| self.arc(flight, step))
    }

    fn length(&self, flight: &Self::Flight, step: &Self::Move, point: Option<DVec3>) -> f64 {
        if !step.accepted {
            return 0.0;
        }
        let arc = self.arc(flight, step);
        arc.length(point.map_or(1.0, |point| arc.parameter_beside(point)))
    }
}
