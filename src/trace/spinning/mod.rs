//! Rays around a spinning hole: Taylor series in Mino time, searched as arcs in the Kerr–Schild chart.
//!
//! Rays are traced into the past, so the photon that is followed is one of the spacetime with time reversed
//! ([`UnitHole::reversed`](crate::geodesic::kerr::UnitHole::reversed)). Directions at cameras and surfaces are those of
//! the frame at rest, places and normals those of the chart: [`RestFrame`](crate::spacetime::RestFrame) goes between.

mod at_rest;
mod commit_step;
mod flight;
mod launch;
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
use super::transport::{Moved, Outcome, Start, Transport};
use crate::geodesic::Arc;
use crate::geometry::{Found, Geometry, PrimitiveId, Query};
use crate::light::{LightSampler, Regions};
use crate::math::columns::{Columns, Row};
use crate::math::kernel::{Kernel, NOTHING, map, update};
use at_rest::{LandingsAtRest, land_all_at_rest, land_at_rest};
use commit_step::SpinningCommits;
use flight::{SpinningFlight, SpinningMove};
use launch::SpinningLaunches;
pub use rays::Spinning;
use span::SpinningSpan;

/// Kernel that builds intersection queries from moves.
struct SpinningQueries<'a>(&'a Spinning);

impl Kernel for SpinningQueries<'_> {
    type A = SpinningFlight;
    type B = SpinningMove;
    type Out = Query<Arc>;

    #[inline(always)]
    fn run(&self, flight: &SpinningFlight, step: &SpinningMove) -> Query<Arc> {
        let (segment, is_searched) = (self.0.arc(flight, step), self.0.is_searched(flight, step));
        self.0.sweep.query(segment, flight.origin_prim, is_searched)
    }
}

/// Buffers that a wavefront keeps from round to round.
#[derive(Default)]
pub struct SpinningScratch {
    starts: Columns<LaunchPoint>,
    launched: Columns<SpinningFlight>,
    on_rays: RayLandings<SpinningSpan>,
    on_arcs: ArcLandings,
    at_rest: LandingsAtRest,
}

impl Transport for Spinning {
    type Flight = SpinningFlight;
    type Move = SpinningMove;
    type Segment = Arc;
    type Scratch = SpinningScratch;
    type Carried = ();

    fn sampler(&self, max_winding: u32) -> Option<Box<dyn LightSampler>> {
        Some(Box::new(Regions::new(self.place, self.frame, max_winding)))
    }

    fn launch(&self, start: &Start) -> SpinningFlight {
        SpinningLaunches(&self.place).run(&(*start).into(), &())
    }

    fn launch_all(
        &self,
        starts: &[(usize, Start)],
        flights: &mut Columns<SpinningFlight>,
        scratch: &mut SpinningScratch,
    ) {
        let SpinningScratch { starts: points, launched, .. } = scratch;
        let lanes = starts.len();
        points.gather(lanes, |i| starts[i].1.into());
        launched.resize(lanes);
        map(&SpinningLaunches(&self.place), points.blocks(lanes), NOTHING, launched.blocks_mut(lanes));
        for (i, &(lane, _)) in starts.iter().enumerate() {
            flights.set(lane, launched.get(i));
        }
    }

    fn advance(&self, flight: &SpinningFlight) -> SpinningMove {
        self.march.advance(flight)
    }

    fn advance_all(
        &self,
        flights: &[<SpinningFlight as Row>::Block],
        moves: &mut [<SpinningMove as Row>::Block],
    ) {
        self.march.advance_all(flights, moves);
    }

    fn queries_all(
        &self,
        flights: &[<SpinningFlight as Row>::Block],
        moves: &[<SpinningMove as Row>::Block],
        queries: &mut [<Query<Arc> as Row>::Block],
    ) {
        map(&SpinningQueries(self), flights, moves, queries);
    }

    #[inline(always)]
    fn search(
        &self,
        flight: &SpinningFlight,
        step: &SpinningMove,
        mut search: impl FnMut(&Arc, PrimitiveId) -> Option<Found>,
    ) -> Option<Found> {
        if !self.is_searched(flight, step) {
            return None;
        }
        self.sweep.search(&self.arc(flight, step), flight.origin_prim, 0, &mut search)
    }

    fn settle(
        &self,
        geometry: Option<&Geometry>,
        flight: &SpinningFlight,
        step: &SpinningMove,
        found: Option<Found>,
    ) -> (Outcome<SpinningFlight>, ()) {
        let Some(found) = found else {
            return (self.outcome(&SpinningCommits(self).run(flight, step)), ());
        };
        let landing = match geometry {
            Some(geometry) if !step.is_close => land_on_ray(self, geometry, (flight, step), found),
            _ => land_on_arc(&self.arc(flight, step), found),
        };
        (land_at_rest(&self.place, &landing), ())
    }

    fn settle_all(
        &self,
        moved: Moved<Self>,
        scratch: &mut SpinningScratch,
        mut end: impl FnMut(usize, Outcome<SpinningFlight>, ()),
    ) {
        let Moved { geometry, flights, moves, found, exactly } = moved;
        let SpinningScratch { on_rays, on_arcs, at_rest, .. } = scratch;
        let lanes = exactly.len();
        sort_hits((found, exactly), |lane| moves.get(lane).is_close, on_arcs, on_rays);
        let mut land = |lane, landing| at_rest.landings.push((lane, landing));
        land_all_on_arcs(on_arcs, |lane| self.arc(&flights.get(lane), &moves.get(lane)), &mut land);
        land_all_on_rays(self, geometry, (flights, moves), on_rays, &mut land);
        land_all_at_rest(&self.place, at_rest, |lane, outcome| end(lane, outcome, ()));
        // Those that landed go on as well, to nowhere.
        update(&SpinningCommits(self), flights.blocks_mut(lanes), moves.blocks(lanes));
        for lane in flights.lanes_where(lanes, |flight| flight.status != FlightStatus::Flies) {
            if found.get(lane).is_none() {
                end(lane, self.outcome(&flights.get(lane)), ());
            }
        }
    }

    fn course(&self, flight: &SpinningFlight, step: &SpinningMove) -> Option<Arc> {
        step.accepted.then(|| self.arc(flight, step))
    }

    fn course_error(&self) -> f64 {
        self.arc_tolerance
    }

    fn length(&self, flight: &SpinningFlight, step: &SpinningMove, point: Option<DVec3>) -> f64 {
        if !step.accepted {
            return 0.0;
        }
        let arc = self.arc(flight, step);
        arc.length(point.map_or(1.0, |point| arc.parameter_beside(point)))
    }
}
