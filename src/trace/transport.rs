//! Transport of rays: the interface between spacetimes and the schedules.
//!
//! A ray in flight is advanced by one move at a time. A move is a piece of the ray that the scene is searched along;
//! what was found decides how the flight goes on. Straight rays are one move long.

use std::convert::Infallible;
use std::fmt::Debug;

use glam::DVec3;

use crate::geometry::{Finds, Found, Geometry, PrimitiveId, Query, SideBySide};
use crate::light::{Beams, LightSampler};
use crate::math::columns::{Columns, Row};
use crate::math::kernel::Kernel;
use crate::spacetime::{AtInfinity, Side, Stretch};

/// Arrival of a ray at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// World position, on the primitive.
    pub position: DVec3,
    /// Unit direction of travel in the static frame.
    pub direction: DVec3,
    /// Primitive that is met.
    pub primitive: PrimitiveId,
    /// Stretch of the space at rest there.
    pub stretch: Stretch,
}

impl Landing {
    /// Arrival where the angles of the chart are true.
    #[inline(always)]
    pub fn conformal(position: DVec3, direction: DVec3, primitive: PrimitiveId) -> Self {
        Self { position, direction, primitive, stretch: Stretch::NONE }
    }
}

/// Outcome of a ray's move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome<Flight> {
    /// It flies on.
    Flying(Flight),
    /// It meets a surface.
    Landed(Landing),
    /// It leaves to infinity.
    Escaped(AtInfinity),
    /// It falls through the horizon.
    Captured,
    /// It took more steps than allowed.
    StepLimit,
    /// Its state is no longer finite.
    NonFinite,
}

impl<Flight> Outcome<Flight> {
    /// Outcome of a ray that ended; the ray if it flies on.
    #[inline(always)]
    pub fn end(self) -> Result<Outcome<Infallible>, Flight> {
        match self {
            Self::Flying(next) => Err(next),
            Self::Landed(landing) => Ok(Outcome::Landed(landing)),
            Self::Escaped(there) => Ok(Outcome::Escaped(there)),
            Self::Captured => Ok(Outcome::Captured),
            Self::StepLimit => Ok(Outcome::StepLimit),
            Self::NonFinite => Ok(Outcome::NonFinite),
        }
    }
}

/// Start of a ray, with its [payload](Transport::Carried).
#[derive(Clone, Copy, Debug)]
pub struct Start<C = ()> {
    /// World position.
    pub position: DVec3,
    /// Unit direction in the static frame.
    pub direction: DVec3,
    /// The primitive it lies on, or none: on the ray's side of a wormhole.
    pub origin_prim: PrimitiveId,
    /// Payload of the ray from there.
    pub carried: C,
}

/// Rays of a wavefront after a move.
pub struct Moved<'a, T: Transport> {
    /// Geometry that the rays move among.
    pub geometry: &'a Geometry,
    /// The rays as they were before; those that fly on are to be moved.
    pub flights: &'a mut Columns<T::Flight>,
    /// Their moves.
    pub moves: &'a Columns<T::Move>,
    /// Hits on the moves.
    pub found: &'a Finds,
    /// True for rays whose exact landing matters; else a landing may be on the segment that was searched.
    pub exactly: &'a [bool],
}

/// Motion of rays: moves, the segments that are searched along them, and their outcomes.
///
/// Methods named after another with `_all` do the same for many rays, bit for bit.
pub trait Transport: Send + Sync + Sized {
    /// A ray in flight.
    type Flight: Row;
    /// One move of a ray.
    type Move: Row;
    /// Segment that the scene is searched along.
    type Segment: SideBySide;
    /// Memory that a wavefront keeps from round to round.
    type Scratch: Default + Send;
    /// Payload of a ray: its state beside place and direction, which passes from its start to its end, and on to the
    /// rays that start there: time, the ratio of frequencies. (The side of a wormhole is told by the primitives that a
    /// ray starts and ends on.) Nothing, `()`, takes neither memory nor time. Rays of the camera and of lamps start with
    /// the default.
    type Carried: Copy + Debug + Default + PartialEq + Send + Sync;
    /// True if all rays are straight lines.
    const IS_STRAIGHT: bool = false;

    /// Light sampling along these rays, with winding numbers up to `max_winding`; `None` if there is none in this
    /// spacetime.
    fn sampler(&self, max_winding: u32) -> Option<Box<dyn LightSampler>>;

    /// Widths of narrow beams; `None` where they are taken to be those of straight ones.
    fn beams(&self) -> Option<Box<dyn Beams>> {
        None
    }

    /// A ray that starts.
    fn launch(&self, start: &Start<Self::Carried>) -> Self::Flight;

    /// Launches rays into their lanes.
    fn launch_all(
        &self,
        starts: &[(usize, Start<Self::Carried>)],
        flights: &mut Columns<Self::Flight>,
        _: &mut Self::Scratch,
    ) {
        for (lane, start) in starts {
            flights.set(*lane, self.launch(start));
        }
    }

    /// Launches a ray of the camera, which may start at the edge of all geometry instead of where nothing is near; its end
    /// if it never comes near any.
    fn enter(&self, start: &Start<Self::Carried>) -> Outcome<Self::Flight> {
        Outcome::Flying(self.launch(start))
    }

    /// Launches rays of the camera into their lanes, and calls `end` for those that never come near any geometry, by
    /// lane, with their payloads there.
    fn enter_all(
        &self,
        starts: &[(usize, Start<Self::Carried>)],
        flights: &mut Columns<Self::Flight>,
        scratch: &mut Self::Scratch,
        _: impl FnMut(usize, Outcome<Self::Flight>, Self::Carried),
    ) {
        self.launch_all(starts, flights, scratch);
    }

    /// Coordinate length of the way that a ray of the camera has come when it has `entered`.
    fn length_before(&self, _: &Start<Self::Carried>, _entered: &Self::Flight) -> f64 {
        0.0
    }

    /// The next move of a ray; touches nothing but the ray.
    fn advance(&self, flight: &Self::Flight) -> Self::Move;

    /// The next moves of blocks of rays.
    fn advance_all(&self, flights: &[<Self::Flight as Row>::Block], moves: &mut [<Self::Move as Row>::Block]);

    /// The pieces of a move to be searched in turn, none if nothing can be met: calls `search` until it finds
    /// something. `search` takes a piece and the primitive that the piece starts on.
    fn search(
        &self,
        flight: &Self::Flight,
        step: &Self::Move,
        search: impl FnMut(&Self::Segment, PrimitiveId) -> Option<Found>,
    ) -> Option<Found>;

    /// Builds the intersection queries for blocks of moves.
    fn queries_all(
        &self,
        flights: &[<Self::Flight as Row>::Block],
        moves: &[<Self::Move as Row>::Block],
        queries: &mut [<Query<Self::Segment> as Row>::Block],
    );

    /// Outcome of a move and the ray's payload there, given what the search found; without `geometry` a landing is on
    /// the segment that was searched rather than on the ray itself.
    fn settle(
        &self,
        geometry: Option<&Geometry>,
        flight: &Self::Flight,
        step: &Self::Move,
        found: Option<Found>,
    ) -> (Outcome<Self::Flight>, Self::Carried);

    /// Moves all rays that fly on, and calls `end` for the others, by lane, with their payloads there.
    fn settle_all(
        &self,
        moved: Moved<Self>,
        _: &mut Self::Scratch,
        mut end: impl FnMut(usize, Outcome<Self::Flight>, Self::Carried),
    ) {
        let Moved { geometry, flights, moves, found, exactly } = moved;
        for (lane, exactly) in exactly.iter().enumerate() {
            let (geometry, found) = (exactly.then_some(geometry), found.get(lane));
            match self.settle(geometry, &flights.get(lane), &moves.get(lane), found) {
                (Outcome::Flying(next), _) => flights.set(lane, next),
                (outcome, carried) => end(lane, outcome, carried),
            }
        }
    }

    /// Side of a wormhole that a ray is on before its move.
    fn side(&self, _: &Self::Flight) -> Side {
        Side::Near
    }

    /// The whole of a move, in world coordinates; `None` if the step was not good enough to be taken.
    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Self::Segment>;

    /// Largest distance between a course and its ray, scene units, if that is more than next to nothing.
    fn course_error(&self) -> f64 {
        0.0
    }

    /// Coordinate length of a move, up to `point` if given.
    fn length(&self, flight: &Self::Flight, step: &Self::Move, point: Option<DVec3>) -> f64;
}

/// A transport as the kernel of its moves.
pub struct Advancing<'a, T>(pub &'a T);

impl<T: Transport> Kernel for Advancing<'_, T> {
    type A = T::Flight;
    type B = ();
    type Out = T::Move;

    #[inline(always)]
    fn run(&self, flight: &T::Flight, (): &()) -> T::Move {
        self.0.advance(flight)
    }
}

/// Visitor of the transport that a scene calls for.
pub trait TransportVisitor {
    /// Result of the visit.
    type Output;

    /// Visits the transport, which may be kept.
    fn run<T: Transport + 'static>(self, transport: T) -> Self::Output;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Line, Need, Primitives, Sphere, Surface};
    use crate::math::columns::{LANES, columns, plain_field};
    use crate::math::kernel::{NOTHING, map};
    use crate::trace::halt::Halt;
    use crate::trace::ray_batch::RayBatch;
    use crate::trace::shoot::follow;
    use crate::trace::straight::{Straight, StraightMove};

    /// The half of a room with a door in the plane x = 0.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub enum Half {
        /// x < 0.
        #[default]
        Near,
        /// x > 0.
        Far,
    }

    plain_field!(Half);

    columns! {
        /// A straight ray on its side.
        pub struct SidedFlight => SidedFlightBlock {
            /// World start.
            position: DVec3,
            /// Unit direction.
            direction: DVec3,
            /// Primitive that it starts on.
            origin_prim: PrimitiveId,
            /// Half on which it starts.
            side: Half,
        }
    }

    /// Straight rays that know the side they are on.
    struct Sided(Straight);

    impl Sided {
        fn straight(&self, flight: &SidedFlight) -> <Straight as Transport>::Flight {
            let &SidedFlight { position, direction, origin_prim, .. } = flight;
            self.0.launch(&Start { position, direction, origin_prim, carried: () })
        }
    }

    impl Transport for Sided {
        type Flight = SidedFlight;
        type Move = StraightMove;
        type Segment = Line;
        type Scratch = ();
        type Carried = Half;

        fn sampler(&self, _: u32) -> Option<Box<dyn LightSampler>> {
            None
        }

        fn launch(&self, start: &Start<Half>) -> SidedFlight {
            let &Start { position, direction, origin_prim, carried: side } = start;
            SidedFlight { position, direction, origin_prim, side }
        }

        fn advance(&self, flight: &SidedFlight) -> StraightMove {
            self.0.advance(&self.straight(flight))
        }

        fn advance_all(
            &self,
            flights: &[<SidedFlight as Row>::Block],
            moves: &mut [<StraightMove as Row>::Block],
        ) {
            map(&Advancing(self), flights, NOTHING, moves);
        }

        fn search(
            &self,
            flight: &SidedFlight,
            step: &StraightMove,
            search: impl FnMut(&Line, PrimitiveId) -> Option<Found>,
        ) -> Option<Found> {
            self.0.search(&self.straight(flight), step, search)
        }

        fn queries_all(
            &self,
            flights: &[<SidedFlight as Row>::Block],
            moves: &[<StraightMove as Row>::Block],
            queries: &mut [<Query<Line> as Row>::Block],
        ) {
            for ((flights, moves), queries) in flights.iter().zip(moves).zip(queries) {
                for lane in 0..LANES {
                    let SidedFlight { position: p0, origin_prim, .. } = Row::get(flights, lane);
                    let StraightMove { end: p2 } = Row::get(moves, lane);
                    let query = Query { segment: Line { p0, p2 }, origin_prim, need: Need::Whole };
                    Query::set(queries, lane, query);
                }
            }
        }

        fn settle(
            &self,
            geometry: Option<&Geometry>,
            flight: &SidedFlight,
            step: &StraightMove,
            found: Option<Found>,
        ) -> (Outcome<SidedFlight>, Half) {
            let (outcome, ()) = self.0.settle(geometry, &self.straight(flight), step, found);
            let end = found.map_or(step.end, |found| found.point);
            let side = match (flight.side, flight.position.x * end.x < 0.0) {
                (side, false) => side,
                (Half::Near, true) => Half::Far,
                (Half::Far, true) => Half::Near,
            };
            let outcome = match outcome {
                Outcome::Landed(landing) => Outcome::Landed(landing),
                Outcome::Escaped(there) => Outcome::Escaped(there),
                other => panic!("{other:?} of a straight ray"),
            };
            (outcome, side)
        }

        fn course(&self, flight: &SidedFlight, step: &StraightMove) -> Option<Line> {
            self.0.course(&self.straight(flight), step)
        }

        fn length(&self, flight: &SidedFlight, step: &StraightMove, point: Option<DVec3>) -> f64 {
            self.0.length(&self.straight(flight), step, point)
        }
    }

    #[test]
    fn a_ray_that_starts_where_another_landed_carries_on_with_its_side() {
        let sphere =
            |x| (Sphere { center: DVec3::new(x, 0.0, 0.0), radius: 1.0 }, Surface { material: 0, entity: 0 });
        let spheres = vec![sphere(-5.0), sphere(5.0)];
        let geometry = Geometry::build(Primitives { spheres, ..Primitives::default() });
        let (sided, halt) = (Sided(Straight::new(geometry.bounds())), Halt::default());
        let start = Start {
            position: DVec3::new(-3.0, 0.0, 0.0),
            direction: DVec3::X,
            origin_prim: PrimitiveId::NONE,
            carried: Half::Near,
        };
        let mut batch = RayBatch::default();
        let mut fly = |start: &Start<Half>| {
            let (shot, side) = follow(&sided, &geometry, start, &halt, |_, _, _, _| {});
            let mut ends = Vec::new();
            batch.follow(&sided, &geometry, &[*start], &halt, &mut ends);
            assert_eq!(ends, [(shot.end, side)]);
            let Outcome::Landed(Landing { position, direction, primitive: origin_prim, .. }) = shot.end
            else {
                panic!("{:?}", shot.end)
            };
            Start { position, direction: -direction, origin_prim, carried: side }
        };
        let there = fly(&start);
        assert!((there.position.x - 4.0).abs() < 1e-12 && there.carried == Half::Far, "{there:?}");
        let back = fly(&there);
        assert!((back.position.x + 4.0).abs() < 1e-12 && back.carried == Half::Near, "{back:?}");
    }
}
