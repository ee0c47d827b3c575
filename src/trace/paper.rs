//! The paper's march, as the baseline: RK4 in coordinate time, straight look-ahead, step halving near surfaces.
//!
//! Reference: \[J\] Jackson, Normann, Hatledal 2025, "The Warped Universe", Algorithm 2.

use glam::DVec3;

use super::transport::{Advancing, Landing, Outcome, Start, Transport};
use crate::geodesic::{Control, Launch, OrbitEnd, Phase, Rkn6, follow, rk4_paper};
use crate::geometry::{Found, Geometry, Line, Need, PrimitiveId, Query};
use crate::light::{Beams, Lensed, LightSampler};
use crate::math::columns::{Row, columns};
use crate::math::kernel::{Kernel, NOTHING, map};
use crate::spacetime::{AtInfinity, Chart, ConformallyFlat, Fate};

/// First step \[J\].
const FIRST_STEP: f64 = 10.0;
/// A surface this near counts as hit \[J, sigma\].
const SIGMA: f64 = 0.1;
/// Step × this before a surface that is farther \[J\].
const SHRINK: f64 = 0.5;
/// Step × this after a free step \[J\].
const GROW: f64 = 1.05;
/// Largest step \[J\].
const LARGEST_STEP: f64 = 20.0;
/// Most iterations \[J\].
const MAX_ITERATIONS: u32 = 300;

/// The paper's march around a hole.
pub struct PaperMarch<M> {
    /// The spacetime.
    pub medium: M,
    /// World position of the hole.
    pub center: DVec3,
    /// Radii beyond which rays need not be followed.
    pub chart: Chart,
}

columns! {
    /// A ray of the paper's march; position relative to the hole.
    pub struct PaperFlight => PaperFlightBlock {
        /// Position.
        position: DVec3,
        /// Momentum.
        momentum: DVec3,
        /// Coordinate time to advance next.
        step: f64,
        /// Primitive that the position lies on, until the first step is taken.
        origin_prim: PrimitiveId,
        /// Iterations so far.
        steps: u32,
    }
}

columns! {
    /// One iteration: the straight look-ahead, and where RK4 goes if it is free.
    pub struct PaperMove => PaperMoveBlock {
        /// End of the look-ahead, relative to the hole.
        ahead: DVec3,
        /// Position after the step.
        position: DVec3,
        /// Momentum after the step.
        momentum: DVec3,
    }
}

/// Error of the direction at infinity, radians: the paper's room has no sky, so this is not a part of its scheme.
const TAIL: f64 = 1e-6;

impl<M: ConformallyFlat> PaperMarch<M> {
    /// Outcome of a move, given what its look-ahead found.
    #[inline(always)]
    fn outcome(&self, flight: &PaperFlight, step: &PaperMove, found: Option<Found>) -> Outcome<PaperFlight> {
        let steps = flight.steps + 1;
        if let Some(Found { point, primitive }) = found {
            if (point - self.center).distance(flight.position) < SIGMA {
                let direction = flight.momentum.normalize();
                return Outcome::Landed(Landing::conformal(point, direction, primitive));
            }
            let closer = PaperFlight { step: SHRINK * flight.step, steps, ..*flight };
            return if steps < MAX_ITERATIONS { Outcome::Flying(closer) } else { Outcome::StepLimit };
        }
        let (position, momentum) = (step.position, step.momentum);
        if !(position.is_finite() && momentum.is_finite()) {
            return Outcome::NonFinite;
        }
        let (rho, outwards) = (position.length(), position.dot(momentum));
        let b = position.cross(momentum).length();
        let fate = Fate::of(&self.medium, rho, b, outwards > 0.0);
        if self.chart.is_left(fate, 1.0 / rho, -outwards / rho) {
            return match fate {
                Fate::Falls => Outcome::Captured,
                Fate::Escapes => self.direction_at_infinity(position, momentum),
            };
        }
        if steps >= MAX_ITERATIONS {
            return Outcome::StepLimit;
        }
        Outcome::Flying(PaperFlight {
            position,
            momentum,
            step: (GROW * flight.step).min(LARGEST_STEP),
            origin_prim: PrimitiveId::NONE,
            steps,
        })
    }

    fn direction_at_infinity(&self, position: DVec3, momentum: DVec3) -> Outcome<PaperFlight> {
        let orbit = Launch::new(&self.medium, position, momentum, f64::EPSILON);
        let control = Control::new(&self.medium, TAIL, f64::INFINITY);
        let ray = (orbit.b, Phase::new(&self.medium, orbit.w, orbit.v), orbit.fate);
        match follow(&self.medium, &Rkn6, &control, ray, 0.0, |_| {}).end {
            OrbitEnd::Crosses(_, swept) => Outcome::Escaped(AtInfinity::near(
                (orbit.radial * libm::cos(swept) + orbit.along * libm::sin(swept)).normalize(),
            )),
            _ => Outcome::NonFinite,
        }
    }
}

/// Kernel that builds intersection queries from moves.
struct PaperQueries {
    center: DVec3,
}

impl Kernel for PaperQueries {
    type A = PaperFlight;
    type B = PaperMove;
    type Out = Query<Line>;

    #[inline(always)]
    fn run(&self, flight: &PaperFlight, step: &PaperMove) -> Query<Line> {
        let segment = Line { p0: flight.position + self.center, p2: step.ahead + self.center };
        Query { segment, origin_prim: flight.origin_prim, need: Need::Whole }
    }
}

impl<M: ConformallyFlat> Transport for PaperMarch<M> {
    type Flight = PaperFlight;
    type Move = PaperMove;
    type Segment = Line;
    type Scratch = ();
    type Carried = ();

    fn sampler(&self, max_winding: u32) -> Option<Box<dyn LightSampler>> {
        Some(Box::new(Lensed::new(self.medium, self.center, max_winding)?))
    }

    fn beams(&self) -> Option<Box<dyn Beams>> {
        Some(Box::new(Lensed::new(self.medium, self.center, 0)?))
    }

    fn launch(&self, &Start { position, direction, origin_prim, carried: () }: &Start) -> PaperFlight {
        let x = position - self.center;
        PaperFlight {
            position: x,
            momentum: direction * self.medium.index(1.0 / x.length()),
            step: FIRST_STEP,
            origin_prim,
            steps: 0,
        }
    }

    #[inline(always)]
    fn advance(&self, flight: &PaperFlight) -> PaperMove {
        let state = (flight.position, flight.momentum);
        let (position, momentum) = rk4_paper(&self.medium, state, flight.step);
        PaperMove { ahead: flight.position + flight.step * flight.momentum.normalize(), position, momentum }
    }

    fn advance_all(&self, flights: &[<PaperFlight as Row>::Block], moves: &mut [<PaperMove as Row>::Block]) {
        map(&Advancing(self), flights, NOTHING, moves);
    }

    fn queries_all(
        &self,
        flights: &[<PaperFlight as Row>::Block],
        moves: &[<PaperMove as Row>::Block],
        queries: &mut [<Query<Line> as Row>::Block],
    ) {
        map(&PaperQueries { center: self.center }, flights, moves, queries);
    }

    #[inline(always)]
    fn search(
        &self,
        flight: &Self::Flight,
        step: &Self::Move,
        mut search: impl FnMut(&Line, PrimitiveId) -> Option<Found>,
    ) -> Option<Found> {
        search(&Line { p0: flight.position + self.center, p2: step.ahead + self.center }, flight.origin_prim)
    }

    #[inline(always)]
    fn settle(
        &self,
        _: Option<&Geometry>,
        flight: &Self::Flight,
        step: &Self::Move,
        found: Option<Found>,
    ) -> (Outcome<PaperFlight>, ()) {
        (self.outcome(flight, step, found), ())
    }

    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Line> {
        Some(Line { p0: flight.position + self.center, p2: step.position + self.center })
    }

    fn length(&self, flight: &Self::Flight, step: &Self::Move, point: Option<DVec3>) -> f64 {
        point.map_or(step.position, |p| p - self.center).distance(flight.position)
    }
}
