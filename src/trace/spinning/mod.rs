//! Rays around a spinning hole: Taylor series in Mino time, searched as arcs in the Kerr–Schild chart.
//!
//! Rays are traced into the past, so the photon that is followed is one of the spacetime with time reversed
//! ([`UnitHole::reversed`](crate::geodesic::kerr::UnitHole::reversed)). Directions at cameras and surfaces are those of
//! the frame at rest, places and normals those of the chart: [`RestFrame`](crate::spacetime::RestFrame) goes between.

mod commit_step;
mod flight;
mod launch;
mod march;
mod span;

use glam::DVec3;

use super::arc_sweep::ArcSweep;
use super::flight_status::FlightStatus;
use super::land_on_arc::{ArcLandings, land_all_on_arcs, land_on_arc};
use super::land_on_ray::{RayLandings, land_all_on_rays, land_on_ray};
use super::launch_point::LaunchPoint;
use super::transport::{Landing, Moved, Outcome, Start, Transport};
use crate::geodesic::Arc;
use crate::geodesic::kerr::{KerrEnd, KerrLaunch, PlacedHole, follow};
use crate::geometry::{Found, Geometry, Need, PrimitiveId, Query};
use crate::light::{LightSampler, Regions};
use crate::math::columns::{Columns, Row};
use crate::math::kernel::{Kernel, NOTHING, map, update};
use crate::scene::Baked;
use crate::spacetime::{AtInfinity, Chart, KerrNewman, Placement, RestFrame};
use commit_step::SpinningCommits;
use flight::{SpinningFlight, SpinningMove};
use launch::SpinningLaunches;
use march::{SeriesMarch, SpinningMarch, keeps_outside, march};
use span::SpinningSpan;

/// Rays around a spinning hole.
pub struct Spinning {
    place: PlacedHole,
    frame: RestFrame,
    march: Box<dyn SeriesMarch>,
    /// Inverse radii, in units of the mass, beyond which rays need not be followed.
    chart: Chart,
    /// True if the directions of escaped rays at infinity matter; else rays are not followed there.
    sky: bool,
    tolerance: f64,
    /// Largest distance between an arc and the curve, scene units.
    arc_tolerance: f64,
    sweep: ArcSweep,
}

impl Spinning {
    /// Rays through `scene` around a hole; falling ones are followed at least to the distance `core` from it, and leaving
    /// ones to infinity only for a `sky`.
    pub fn new(scene: &Baked, (placement, hole): (Placement, KerrNewman), core: f64, sky: bool) -> Self {
        let place = PlacedHole::new(placement, &hole);
        let (nearest, farthest) = scene.geometry.radii(placement.center).unwrap_or((f64::INFINITY, 0.0));
        let nearest = nearest.min(core) / place.mass;
        // Spheroidal radii of points at a distance d are between √(d² − a²) and d.
        let a = place.hole.a;
        let nearest = (nearest * nearest - a * a).max(0.0).sqrt();
        let farthest = farthest.max(hole.outermost_photon_orbit()) / place.mass;
        let chart = Chart { outer: 1.0 / farthest, inner: place.hole.horizon.min(1.0 / nearest) };
        let tolerance = scene.settings.tolerance;
        let arc_tolerance = scene.arc_tolerance_around(placement.center);
        let marching = SpinningMarch { place, chart, tolerance, arc_tolerance: arc_tolerance / place.mass };
        Self {
            place,
            frame: scene.spacetime.rest_frame(),
            march: march(marching),
            chart,
            sky,
            tolerance,
            arc_tolerance,
            sweep: ArcSweep::new(scene, arc_tolerance),
        }
    }

    /// The step's arc, in world coordinates.
    #[inline(always)]
    fn arc(&self, flight: &SpinningFlight, step: &SpinningMove) -> Arc {
        let start = flight.position + self.place.center;
        Arc { p0: start, p1: start + step.middle, p2: start + step.end, w: step.weight }
    }

    /// True if a step can meet anything.
    #[inline(always)]
    fn is_searched(&self, flight: &SpinningFlight, step: &SpinningMove) -> bool {
        let end = crate::geodesic::kerr::MinoState { u: step.u, v: step.v, ..flight.state() };
        step.accepted & !keeps_outside(self.chart.outer, &flight.state(), &end)
    }

    /// Outcome of a move that met nothing, given the ray's next state.
    fn outcome(&self, next: &SpinningFlight) -> Outcome<SpinningFlight> {
        match next.status {
            FlightStatus::Flies => Outcome::Flying(*next),
            FlightStatus::Leaves => self.escaped(next),
            FlightStatus::Falls => Outcome::Captured,
            FlightStatus::StepLimit => Outcome::StepLimit,
            FlightStatus::NonFinite => Outcome::NonFinite,
        }
    }

    /// The direction at infinity of a ray that meets nothing more; where nobody asks for that, where it is.
    fn escaped(&self, flight: &SpinningFlight) -> Outcome<SpinningFlight> {
        let (constants, state) = (flight.constants(), flight.state());
        if !self.sky {
            let [velocity, _] = state.motion(&self.place.hole, &constants);
            return Outcome::Escaped(AtInfinity::near(self.place.outwards(velocity).normalize()));
        }
        let launch = KerrLaunch { constants, state };
        match follow(&self.place.hole, &launch, self.tolerance, 0.0, |_, _| {}).end {
            KerrEnd::Crosses(end) => Outcome::Escaped(AtInfinity::near(self.place.outwards(end.n))),
            KerrEnd::StepLimit => Outcome::StepLimit,
            KerrEnd::Falls | KerrEnd::Misses | KerrEnd::NonFinite => Outcome::NonFinite,
        }
    }

    /// Landing as the frame at rest has it, from one in the chart. What reaches into the ergosphere in spite of the
    /// scene's checks takes the ray with it.
    fn landed(&self, landing: Landing) -> Outcome<SpinningFlight> {
        let direction = self.frame.direction(landing.position, landing.direction);
        if !direction.is_finite() {
            return Outcome::Captured;
        }
        Outcome::Landed(Landing { direction, ..landing })
    }
}

/// Kernel that builds intersection queries from moves.
struct SpinningQueries<'a>(&'a Spinning);

impl Kernel for SpinningQueries<'_> {
    type A = SpinningFlight;
    type B = SpinningMove;
    type Out = Query<Arc>;

    #[inline(always)]
    fn run(&self, flight: &SpinningFlight, step: &SpinningMove) -> Query<Arc> {
        let segment = self.0.arc(flight, step);
        let whole = if self.0.sweep.is_split(&segment, 0) { Need::Pieces } else { Need::Whole };
        let may = self.0.is_searched(flight, step) & self.0.sweep.may_meet(&segment);
        let need = if may { whole } else { Need::Nothing };
        Query { segment, origin_prim: flight.origin_prim, need }
    }
}

/// Buffers that a wavefront keeps from round to round.
#[derive(Default)]
pub struct SpinningScratch {
    starts: Columns<LaunchPoint>,
    launched: Columns<SpinningFlight>,
    on_rays: RayLandings<SpinningSpan>,
    on_arcs: ArcLandings,
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
        (self.landed(landing), ())
    }

    fn settle_all(
        &self,
        moved: Moved<Self>,
        scratch: &mut SpinningScratch,
        mut end: impl FnMut(usize, Outcome<SpinningFlight>, ()),
    ) {
        let Moved { geometry, flights, moves, found, exactly } = moved;
        let SpinningScratch { on_rays, on_arcs, .. } = scratch;
        let lanes = found.len();
        on_rays.hits.clear();
        on_arcs.hits.clear();
        for (lane, found) in found.iter().enumerate() {
            let Some(found) = *found else { continue };
            let stays = !exactly[lane] || moves.get(lane).is_close;
            let hits = if stays { &mut on_arcs.hits } else { &mut on_rays.hits };
            hits.push((lane, found));
        }
        let mut land = |lane, landing| end(lane, self.landed(landing), ());
        land_all_on_arcs(on_arcs, |lane| self.arc(&flights.get(lane), &moves.get(lane)), &mut land);
        land_all_on_rays(self, geometry, (flights, moves), on_rays, &mut land);
        // Those that landed go on as well, to nowhere.
        update(&SpinningCommits(self), flights.blocks_mut(lanes), moves.blocks(lanes));
        for (lane, found) in found.iter().enumerate() {
            if flights.get(lane).status != FlightStatus::Flies && found.is_none() {
                end(lane, self.outcome(&flights.get(lane)), ());
            }
        }
    }

    fn course(&self, flight: &SpinningFlight, step: &SpinningMove) -> Option<Arc> {
        step.accepted.then(|| self.arc(flight, step))
    }

    fn length(&self, flight: &SpinningFlight, step: &SpinningMove, point: Option<DVec3>) -> f64 {
        if !step.accepted {
            return 0.0;
        }
        let arc = self.arc(flight, step);
        arc.length(point.map_or(1.0, |point| arc.parameter_beside(point)))
    }
}
