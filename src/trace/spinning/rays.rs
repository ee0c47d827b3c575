//! Rays around a spinning hole: their tolerances, the arcs that are searched along them, and how they end.

use super::flight::{SpinningFlight, SpinningMove};
use super::march::{SeriesMarch, SpinningMarch, keeps_outside, march};
use crate::geodesic::Arc;
use crate::geodesic::kerr::{KerrEnd, KerrLaunch, MinoState, PlacedHole, follow};
use crate::scene::Baked;
use crate::spacetime::{AtInfinity, Chart, KerrNewman, Placement, RestFrame};
use crate::trace::arc_sweep::ArcSweep;
use crate::trace::flight_status::FlightStatus;
use crate::trace::transport::Outcome;

/// Rays around a spinning hole.
pub struct Spinning {
    /// The hole in its place.
    pub place: PlacedHole,
    /// Frames at rest around it.
    pub frame: RestFrame,
    /// Its series.
    pub march: Box<dyn SeriesMarch>,
    /// Inverse radii, in units of the mass, beyond which rays need not be followed.
    pub chart: Chart,
    /// True if the directions of escaped rays at infinity matter; else rays are not followed there.
    pub sky: bool,
    /// Largest error of a ray's direction, radians.
    pub tolerance: f64,
    /// Largest distance between an arc and the curve, scene units.
    pub arc_tolerance: f64,
    /// Search along its arcs.
    pub sweep: ArcSweep,
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
        let chart = Chart {
            outer: 1.0 / farthest,
            inner: place.hole.horizon.min(1.0 / nearest),
            widest: f64::INFINITY,
        };
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
    pub fn arc(&self, flight: &SpinningFlight, step: &SpinningMove) -> Arc {
        let start = flight.position + self.place.center;
        Arc { p0: start, p1: start + step.middle, p2: start + step.end, w: step.weight }
    }

    /// True if a step can meet anything.
    #[inline(always)]
    pub fn is_searched(&self, flight: &SpinningFlight, step: &SpinningMove) -> bool {
        let end = MinoState { u: step.u, v: step.v, ..flight.state() };
        step.accepted & !keeps_outside(self.chart.outer, &flight.state(), &end)
    }

    /// Outcome of a move that met nothing, given the ray's next state.
    pub fn outcome(&self, next: &SpinningFlight) -> Outcome<SpinningFlight> {
        match next.status {
            FlightStatus::Flies => Outcome::Flying(*next),
            FlightStatus::Leaves => self.escaped(next),
            FlightStatus::Falls => Outcome::Captured,
            FlightStatus::StepLimit => Outcome::StepLimit,
            FlightStatus::NonFinite => Outcome::NonFinite,
        }
    }

    /// The direction at infinity of a ray that meets nothing more; where nobody asks for that, where it is.
    pub fn escaped(&self, flight: &SpinningFlight) -> Outcome<SpinningFlight> {
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
}
