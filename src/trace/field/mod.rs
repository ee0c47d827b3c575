//! Rays in fields of refraction, in three dimensions: stepped under error control, searched as arcs.

mod commit_step;
mod flight;
mod march;
mod rays;
mod retrace;
mod span;

use glam::DVec3;

use super::flight_status::FlightStatus;
use super::land_on_arc::{ArcLandings, land_all_on_arcs, land_on_arc};
use super::land_on_ray::{RayLandings, land_all_on_rays, land_on_ray};
use super::launch_point::LaunchPoint;
use super::sort_hits::sort_hits;
use super::transport::{Landing, Moved, Outcome, Start, Transport};
use crate::geodesic::Arc;
use crate::geometry::{Found, Geometry, PrimitiveId, Query};
use crate::light::LightSampler;
use crate::math::columns::{Columns, Row};
use crate::math::kernel::{Kernel, map, update};
use crate::spacetime::AtInfinity;
use commit_step::FieldCommits;
use flight::{FieldFlight, FieldMove};
pub use rays::FieldTransport;
use span::FieldSpan;

impl FieldTransport {
    /// Outcome of a move that met nothing, given the ray's next state.
    fn outcome(&self, next: &FieldFlight) -> Outcome<FieldFlight> {
        match next.status {
            FlightStatus::Flies => Outcome::Flying(*next),
            FlightStatus::Leaves if !self.sky => {
                Outcome::Escaped(AtInfinity::near(next.momentum.normalize()))
            }
            FlightStatus::Leaves => {
                let direction = self.march.at_infinity(next);
                direction.map_or(Outcome::NonFinite, |to| Outcome::Escaped(AtInfinity::near(to)))
            }
            FlightStatus::Falls => Outcome::Captured,
            FlightStatus::StepLimit => Outcome::StepLimit,
            FlightStatus::NonFinite => Outcome::NonFinite,
        }
    }

    /// Landing of a ray on what a search found: if a `geometry` is given on the ray itself, unless the arc is as good.
    fn landing(
        &self,
        geometry: Option<&Geometry>,
        flight: &FieldFlight,
        step: &FieldMove,
        found: Found,
    ) -> Landing {
        match geometry {
            Some(geometry) if !step.is_close => land_on_ray(self, geometry, (flight, step), found),
            _ => land_on_arc(&Self::arc(flight, step), found),
        }
    }
}

/// Kernel that builds intersection queries from moves.
struct FieldQueries<'a>(&'a FieldTransport);

impl Kernel for FieldQueries<'_> {
    type A = FieldFlight;
    type B = FieldMove;
    type Out = Query<Arc>;

    #[inline(always)]
    fn run(&self, flight: &FieldFlight, step: &FieldMove) -> Query<Arc> {
        let segment = FieldTransport::arc(flight, step);
        self.0.sweep.query(segment, flight.origin_prim, self.0.is_searched(flight, step))
    }
}

/// Buffers that a wavefront of rays in a field keeps from round to round.
#[derive(Default)]
pub struct FieldScratch {
    starts: Columns<LaunchPoint>,
    launched: Columns<FieldFlight>,
    on_rays: RayLandings<FieldSpan>,
    on_arcs: ArcLandings,
}

impl Transport for FieldTransport {
    type Flight = FieldFlight;
    type Move = FieldMove;
    type Segment = Arc;
    type Scratch = FieldScratch;
    type Carried = ();

    fn sampler(&self, max_winding: u32) -> Option<Box<dyn LightSampler>> {
        Some(self.march.sampler(max_winding))
    }

    fn launch(&self, start: &Start) -> FieldFlight {
        self.march.launch(&(*start).into())
    }

    fn launch_all(
        &self,
        starts: &[(usize, Start)],
        flights: &mut Columns<FieldFlight>,
        scratch: &mut FieldScratch,
    ) {
        let FieldScratch { starts: places, launched, .. } = scratch;
        let lanes = starts.len();
        places.gather(lanes, |i| starts[i].1.into());
        launched.resize(lanes);
        self.march.launch_all(places.blocks(lanes), launched.blocks_mut(lanes));
        for (i, &(lane, _)) in starts.iter().enumerate() {
            flights.set(lane, launched.get(i));
        }
    }

    fn advance(&self, flight: &FieldFlight) -> FieldMove {
        self.march.advance(flight)
    }

    fn advance_all(&self, flights: &[<FieldFlight as Row>::Block], moves: &mut [<FieldMove as Row>::Block]) {
        self.march.advance_all(flights, moves);
    }

    fn queries_all(
        &self,
        flights: &[<FieldFlight as Row>::Block],
        moves: &[<FieldMove as Row>::Block],
        queries: &mut [<Query<Arc> as Row>::Block],
    ) {
        map(&FieldQueries(self), flights, moves, queries);
    }

    #[inline(always)]
    fn search(
        &self,
        flight: &FieldFlight,
        step: &FieldMove,
        mut search: impl FnMut(&Arc, PrimitiveId) -> Option<Found>,
    ) -> Option<Found> {
        if !self.is_searched(flight, step) {
            return None;
        }
        self.sweep.search(&Self::arc(flight, step), flight.origin_prim, 0, &mut search)
    }

    #[inline(always)]
    fn settle(
        &self,
        geometry: Option<&Geometry>,
        flight: &FieldFlight,
        step: &FieldMove,
        found: Option<Found>,
    ) -> (Outcome<FieldFlight>, ()) {
        let outcome = match found {
            Some(found) => Outcome::Landed(self.landing(geometry, flight, step, found)),
            None => self.outcome(&FieldCommits(self).run(flight, step)),
        };
        (outcome, ())
    }

    fn settle_all(
        &self,
        moved: Moved<Self>,
        scratch: &mut FieldScratch,
        mut end: impl FnMut(usize, Outcome<FieldFlight>, ()),
    ) {
        let Moved { geometry, flights, moves, found, exactly } = moved;
        let FieldScratch { on_rays, on_arcs, .. } = scratch;
        let lanes = exactly.len();
        sort_hits((found, exactly), |lane| moves.get(lane).is_close, on_arcs, on_rays);
        let arc = |lane| Self::arc(&flights.get(lane), &moves.get(lane));
        land_all_on_arcs(on_arcs, arc, |lane, landing| end(lane, Outcome::Landed(landing), ()));
        land_all_on_rays(self, geometry, (flights, moves), on_rays, |lane, landing| {
            end(lane, Outcome::Landed(landing), ());
        });
        // Those that landed go on as well, to nowhere.
        update(&FieldCommits(self), flights.blocks_mut(lanes), moves.blocks(lanes));
        for lane in flights.lanes_where(lanes, |flight| flight.status != FlightStatus::Flies) {
            if found.get(lane).is_none() {
                end(lane, self.outcome(&flights.get(lane)), ());
            }
        }
    }

    fn course(&self, flight: &FieldFlight, step: &FieldMove) -> Option<Arc> {
        step.accepted.then(|| Self::arc(flight, step))
    }

    fn length(&self, flight: &FieldFlight, step: &FieldMove, point: Option<DVec3>) -> f64 {
        if !step.accepted {
            return 0.0;
        }
        let arc = Self::arc(flight, step);
        arc.length(point.map_or(1.0, |point| arc.parameter_beside(point)))
    }
}
