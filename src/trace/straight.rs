//! Straight rays: flat space needs one move and one query per ray.

use glam::DVec3;

use super::transport::{Advancing, Landing, Outcome, Start, Transport};
use crate::geometry::{Found, Geometry, Line, Need, PrimitiveId, Query};
use crate::light::{LightSampler, StraightAim};
use crate::math::columns::{Row, columns};
use crate::math::kernel::{Kernel, NOTHING, map};
use crate::spacetime::AtInfinity;

/// Rays of flat space, followed to where they leave the scene's bounds.
pub struct Straight {
    min: DVec3,
    max: DVec3,
}

columns! {
    /// A straight ray.
    pub struct StraightFlight => StraightFlightBlock {
        /// World start.
        position: DVec3,
        /// Unit direction.
        direction: DVec3,
        /// Primitive that it starts on.
        origin_prim: PrimitiveId,
    }
}

columns! {
    /// Its only move.
    pub struct StraightMove => StraightMoveBlock {
        /// Point where the ray has left the bounds for good; its start if it never meets them.
        end: DVec3,
    }
}

impl Straight {
    /// Rays among geometry within `bounds` (min, max), if there is any.
    pub fn new(bounds: Option<(DVec3, DVec3)>) -> Self {
        let (min, max) = bounds.unwrap_or((DVec3::INFINITY, DVec3::NEG_INFINITY));
        // Room for the rounding of the exit point.
        let margin = 1e-9 * min.abs().max(max.abs()).max_element();
        let margin = if margin.is_finite() { DVec3::splat(margin) } else { DVec3::ZERO };
        Self { min: min - margin, max: max + margin }
    }
}

/// Kernel that builds intersection queries from moves.
struct StraightQueries;

impl Kernel for StraightQueries {
    type A = StraightFlight;
    type B = StraightMove;
    type Out = Query<Line>;

    #[inline(always)]
    fn run(&self, flight: &StraightFlight, step: &StraightMove) -> Query<Line> {
        let need = if step.end == flight.position { Need::Nothing } else { Need::Whole };
        Query { segment: Line { p0: flight.position, p2: step.end }, origin_prim: flight.origin_prim, need }
    }
}

impl Transport for Straight {
    type Flight = StraightFlight;
    type Move = StraightMove;
    type Segment = Line;
    type Scratch = ();
    type Carried = ();

    const IS_STRAIGHT: bool = true;

    fn sampler(&self, _: u32) -> Option<Box<dyn LightSampler>> {
        Some(Box::new(StraightAim))
    }

    #[inline(always)]
    fn launch(&self, &Start { position, direction, origin_prim, carried: () }: &Start) -> StraightFlight {
        StraightFlight { position, direction, origin_prim }
    }

    #[inline(always)]
    fn advance(&self, flight: &StraightFlight) -> StraightMove {
        let inverse = flight.direction.recip();
        let (a, b) = ((self.min - flight.position) * inverse, (self.max - flight.position) * inverse);
        // A zero component inside its slab gives ∓∞ and on its edge NaN, which `min` and `max` pass over.
        let leave = a.max(b).min_element();
        let enter = a.min(b).max_element();
        let inside = leave >= enter && leave > 0.0 && leave.is_finite();
        StraightMove {
            end: if inside { flight.position + leave * flight.direction } else { flight.position },
        }
    }

    fn advance_all(
        &self,
        flights: &[<StraightFlight as Row>::Block],
        moves: &mut [<StraightMove as Row>::Block],
    ) {
        map(&Advancing(self), flights, NOTHING, moves);
    }

    fn queries_all(
        &self,
        flights: &[<StraightFlight as Row>::Block],
        moves: &[<StraightMove as Row>::Block],
        queries: &mut [<Query<Line> as Row>::Block],
    ) {
        map(&StraightQueries, flights, moves, queries);
    }

    #[inline(always)]
    fn search(
        &self,
        flight: &Self::Flight,
        step: &Self::Move,
        mut search: impl FnMut(&Line, PrimitiveId) -> Option<Found>,
    ) -> Option<Found> {
        if step.end == flight.position {
            return None;
        }
        search(&Line { p0: flight.position, p2: step.end }, flight.origin_prim)
    }

    #[inline(always)]
    fn settle(
        &self,
        _: Option<&Geometry>,
        flight: &Self::Flight,
        _: &Self::Move,
        found: Option<Found>,
    ) -> (Outcome<StraightFlight>, ()) {
        let direction = flight.direction;
        let outcome = match found {
            Some(Found { point, primitive }) => {
                Outcome::Landed(Landing::conformal(point, direction, primitive))
            }
            None => Outcome::Escaped(AtInfinity::near(direction)),
        };
        (outcome, ())
    }

    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Line> {
        Some(Line { p0: flight.position, p2: step.end })
    }

    fn length(&self, flight: &Self::Flight, step: &Self::Move, point: Option<DVec3>) -> f64 {
        point.unwrap_or(step.end).distance(flight.position)
    }
}
