//! Curved rays: orbits stepped under error control, searched as arcs.

mod commit_step;
mod cross_throat;
pub mod departure;
mod enter;
mod entrance;
mod flight;
mod launch;
pub mod march;
mod rays;
mod retrace;
mod span;
pub mod worlds;

use glam::DVec3;

use super::flight_status::FlightStatus;
use super::land_on_arc::{ArcLandings, land_all_on_arcs, land_on_arc};
use super::land_on_ray::{RayLandings, land_all_on_rays, land_on_ray};
use super::launch_point::LaunchPoint;
use super::sort_hits::sort_hits;
use super::transport::{Landing, Moved, Outcome, Start, Transport};
use crate::geodesic::{Arc, OrbitEnd};
use crate::geometry::{Found, Geometry, PrimitiveId, Query};
use crate::light::{Beams, LightSampler};
use crate::math::columns::{Columns, Row};
use crate::math::kernel::{Kernel, NOTHING, map, update};
use crate::spacetime::{AtInfinity, ConformallyFlat, Side};
use commit_step::Committing;
use departure::Departure;
use enter::Entering;
pub use entrance::Entrance;
pub use flight::{CurvedFlight, CurvedMove, Lane};
use launch::Launching;
pub use rays::Curved;
use span::Span;
use worlds::Worlds;

impl<M: ConformallyFlat, R: Lane, W: Worlds<M> + 'static> Curved<M, R, W> {
    /// Outcome of a move that met nothing, given the ray's next state.
    fn outcome(&self, next: &CurvedFlight<R>) -> Outcome<CurvedFlight<R>> {
        match next.status {
            FlightStatus::Flies => Outcome::Flying(*next),
            FlightStatus::Leaves if !self.sky => self.escaped(next, next.direction()),
            FlightStatus::Leaves => match &self.way_out {
                Some(way) => self.departed(next, &way.depart(Departure::of(next))),
                None => self.direction_at_infinity(next),
            },
            FlightStatus::Falls => Outcome::Captured,
            FlightStatus::StepLimit => Outcome::StepLimit,
            FlightStatus::NonFinite => Outcome::NonFinite,
        }
    }

    fn escaped(&self, flight: &CurvedFlight<R>, direction: DVec3) -> Outcome<CurvedFlight<R>> {
        Outcome::Escaped(AtInfinity { side: flight.origin_prim.side(), direction })
    }

    /// The end of a ray that meets nothing more, given where it is on its way to infinity.
    fn departed(&self, flight: &CurvedFlight<R>, departure: &Departure<R>) -> Outcome<CurvedFlight<R>> {
        if departure.status == FlightStatus::Leaves {
            let direction = departure.cos * flight.radial + departure.sin * flight.along;
            self.escaped(flight, direction.normalize())
        } else {
            self.direction_at_infinity(flight)
        }
    }

    /// The direction at infinity of a ray that meets nothing more, followed by itself.
    fn direction_at_infinity(&self, flight: &CurvedFlight<R>) -> Outcome<CurvedFlight<R>> {
        match self.march.to_infinity(flight.b, flight.phase(), flight.fate) {
            OrbitEnd::Crosses(_, swept) => {
                let (sin, cos) = libm::sincos(swept.value());
                self.escaped(flight, (cos * flight.radial + sin * flight.along).normalize())
            }
            OrbitEnd::StepLimit => Outcome::StepLimit,
            OrbitEnd::Falls | OrbitEnd::Misses | OrbitEnd::NonFinite => Outcome::NonFinite,
        }
    }

    /// Ends of the `leaving` ones of some rays; `end` is told each.
    fn depart_all(
        &self,
        flights: &Columns<CurvedFlight<R>>,
        (leaving, departures): (&[usize], &mut Columns<Departure<R>>),
        mut end: impl FnMut(usize, Outcome<CurvedFlight<R>>),
    ) {
        let Some(way) = self.way_out.as_ref().filter(|_| self.sky) else {
            return leaving.iter().for_each(|&lane| end(lane, self.outcome(&flights.get(lane))));
        };
        departures.gather(leaving.len(), |i| Departure::of(&flights.get(leaving[i])));
        way.depart_all(departures.blocks_mut(leaving.len()));
        for (i, &lane) in leaving.iter().enumerate() {
            end(lane, self.departed(&flights.get(lane), &departures.get(i)));
        }
    }

    /// Launches rays together, side by side.
    fn launch_together(&self, starts: &[(usize, Start)], scratch: &mut Scratch<R>) {
        let Scratch { starts: places, launched, .. } = scratch;
        let lanes = starts.len();
        places.gather(lanes, |i| starts[i].1.into());
        launched.resize(lanes);
        map(&Launching::of(self), places.blocks(lanes), NOTHING, launched.blocks_mut(lanes));
    }

    /// Kernel that takes rays to the `entrance`.
    fn entering<'a>(&'a self, entrance: &'a Entrance<R>) -> Entering<'a, M, R, W> {
        Entering { curved: self, entrance, order: self.march.order() }
    }

    /// Landing of a ray on what a search found: if a `geometry` is given on the ray itself, unless the arc is as good.
    fn landing(
        &self,
        geometry: Option<&Geometry>,
        flight: &CurvedFlight<R>,
        step: &CurvedMove<R>,
        found: Found,
    ) -> Landing {
        match geometry {
            Some(geometry) if !step.is_close => land_on_ray(self, geometry, (flight, step), found),
            _ => land_on_arc(&self.arc(flight, step), found),
        }
    }
}

/// Kernel that builds intersection queries from moves.
struct CurvedQueries<'a, M, R, W>(&'a Curved<M, R, W>);

impl<M: ConformallyFlat, R: Lane, W: Worlds<M>> Kernel for CurvedQueries<'_, M, R, W> {
    type A = CurvedFlight<R>;
    type B = CurvedMove<R>;
    type Out = Query<Arc>;

    #[inline(always)]
    fn run(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> Query<Arc> {
        let (segment, is_searched) = (self.0.arc(flight, step), self.0.is_searched(flight, step));
        self.0.worlds.of(flight.origin_prim).sweep.query(segment, flight.origin_prim, is_searched)
    }
}

/// Buffers that a wavefront of curved rays keeps from round to round.
#[derive(Default)]
pub struct Scratch<R: Lane> {
    starts: Columns<LaunchPoint>,
    launched: Columns<CurvedFlight<R>>,
    on_rays: RayLandings<Span<R>>,
    on_arcs: ArcLandings,
    crossings: Vec<(usize, CurvedFlight<R>)>,
    leaving: Vec<usize>,
    departures: Columns<Departure<R>>,
}

impl<M: ConformallyFlat, R: Lane, W: Worlds<M> + 'static> Transport for Curved<M, R, W> {
    type Flight = CurvedFlight<R>;
    type Move = CurvedMove<R>;
    type Segment = Arc;
    type Scratch = Scratch<R>;
    type Carried = ();

    fn sampler(&self, max_winding: u32) -> Option<Box<dyn LightSampler>> {
        Some(Box::new(self.worlds.aim(self.medium, max_winding)?))
    }

    fn beams(&self) -> Option<Box<dyn Beams>> {
        Some(Box::new(self.worlds.aim(self.medium, 0)?))
    }

    fn launch(&self, start: &Start) -> CurvedFlight<R> {
        Launching::of(self).run(&(*start).into(), &())
    }

    fn launch_all(
        &self,
        starts: &[(usize, Start)],
        flights: &mut Columns<CurvedFlight<R>>,
        scratch: &mut Scratch<R>,
    ) {
        self.launch_together(starts, scratch);
        for (i, &(lane, _)) in starts.iter().enumerate() {
            flights.set(lane, scratch.launched.get(i));
        }
    }

    fn enter(&self, start: &Start) -> Outcome<CurvedFlight<R>> {
        let flight = self.launch(start);
        self.outcome(
            &self.entrance.as_ref().map_or(flight, |entrance| self.entering(entrance).run(&flight, &())),
        )
    }

    fn enter_all(
        &self,
        starts: &[(usize, Start)],
        flights: &mut Columns<CurvedFlight<R>>,
        scratch: &mut Scratch<R>,
        mut end: impl FnMut(usize, Outcome<CurvedFlight<R>>, ()),
    ) {
        let Some(entrance) = &self.entrance else { return self.launch_all(starts, flights, scratch) };
        self.launch_together(starts, scratch);
        let Scratch { launched, leaving, departures, .. } = scratch;
        update(&self.entering(entrance), launched.blocks_mut(starts.len()), NOTHING);
        leaving.clear();
        for (i, &(lane, _)) in starts.iter().enumerate() {
            let flight = launched.get(i);
            flights.set(lane, flight);
            if flight.status == FlightStatus::Leaves {
                leaving.push(i);
            }
        }
        self.depart_all(launched, (leaving, departures), |i, outcome| end(starts[i].0, outcome, ()));
    }

    fn length_before(&self, start: &Start, entered: &CurvedFlight<R>) -> f64 {
        let (mut flight, mut length) = (self.launch(start), 0.0);
        if self.entrance.is_none() || entered.w <= flight.w {
            return length;
        }
        let end = entered.position + self.worlds.of(start.origin_prim).center;
        loop {
            let step = self.advance(&flight);
            if step.accepted && (step.w >= entered.w || step.v < R::of(0.0)) {
                return length + self.length(&flight, &step, Some(end));
            }
            length += self.length(&flight, &step, None);
            match self.settle(None, &flight, &step, None).0 {
                Outcome::Flying(next) => flight = next,
                _ => return length,
            }
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
        map(&CurvedQueries(self), flights, moves, queries);
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
        let sweep = &self.worlds.of(flight.origin_prim).sweep;
        sweep.search(&self.arc(flight, step), flight.origin_prim, 0, &mut search)
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
            None => match self.crossing(flight, step) {
                Some(beyond) => Outcome::Flying(beyond),
                None => self.outcome(&Committing(self).run(flight, step)),
            },
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
        let Scratch { on_rays, on_arcs, crossings, leaving, departures, .. } = scratch;
        let lanes = exactly.len();
        sort_hits((found, exactly), |lane| moves.get(lane).is_close, on_arcs, on_rays);
        let arc = |lane| self.arc(&flights.get(lane), &moves.get(lane));
        land_all_on_arcs(on_arcs, arc, |lane, landing| end(lane, Outcome::Landed(landing), ()));
        land_all_on_rays(self, geometry, (flights, moves), on_rays, |lane, landing| {
            end(lane, Outcome::Landed(landing), ());
        });
        crossings.clear();
        if self.worlds.throat().is_some() {
            let flying = (0..lanes).filter(|&lane| found.get(lane).is_none());
            crossings.extend(flying.filter_map(|lane| {
                self.crossing(&flights.get(lane), &moves.get(lane)).map(|beyond| (lane, beyond))
            }));
        }
        // Those that landed go on as well, to nowhere.
        update(&Committing(self), flights.blocks_mut(lanes), moves.blocks(lanes));
        crossings.iter().for_each(|&(lane, beyond)| flights.set(lane, beyond));
        leaving.clear();
        for lane in flights.lanes_where(lanes, |flight| flight.status != FlightStatus::Flies) {
            if found.get(lane).is_some() {
                continue;
            }
            let flight = flights.get(lane);
            match flight.status {
                FlightStatus::Leaves => leaving.push(lane),
                _ => end(lane, self.outcome(&flight), ()),
            }
        }
        self.depart_all(flights, (leaving, departures), |lane, outcome| end(lane, outcome, ()));
    }

    fn side(&self, flight: &Self::Flight) -> Side {
        flight.origin_prim.side()
    }

    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Arc> {
        let (flight, step) = self.before_throat(flight, step);
        step.accepted.then(|| self.arc(&flight, &step))
    }

    fn length(&self, flight: &Self::Flight, step: &Self::Move, point: Option<DVec3>) -> f64 {
        let (flight, step) = self.before_throat(flight, step);
        if !step.accepted {
            return 0.0;
        }
        let arc = self.arc(&flight, &step);
        arc.length(point.map_or(1.0, |point| arc.parameter_beside(point)))
    }
}
