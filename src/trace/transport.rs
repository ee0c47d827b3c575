//! How rays move: the interface between spacetimes and the schedules.
//!
//! A ray in flight is advanced by one move at a time. A move is a piece of the ray that the scene is searched along;
//! what was found decides how the flight goes on. Straight rays are one move long.

use std::convert::Infallible;

use glam::DVec3;

use crate::geometry::{Found, Geometry, PrimitiveId, Query, SideBySide};
use crate::math::columns::{Columns, Row};
use crate::math::kernel::Kernel;

/// Where and how a ray arrives at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// World position, on the primitive.
    pub position: DVec3,
    /// Unit direction of travel in the static frame.
    pub direction: DVec3,
    /// What is met.
    pub primitive: PrimitiveId,
}

/// What becomes of a ray after a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome<Flight> {
    /// It flies on.
    Flying(Flight),
    /// It meets a surface.
    Landed(Landing),
    /// It leaves to infinity, with this unit direction there.
    Escaped(DVec3),
    /// It falls through the horizon.
    Captured,
    /// It took more steps than allowed.
    StepLimit,
    /// Its state is no longer finite.
    NonFinite,
}

impl<Flight> Outcome<Flight> {
    /// How the ray ended; the ray if it flies on.
    #[inline(always)]
    pub fn end(self) -> Result<Outcome<Infallible>, Flight> {
        match self {
            Self::Flying(next) => Err(next),
            Self::Landed(landing) => Ok(Outcome::Landed(landing)),
            Self::Escaped(direction) => Ok(Outcome::Escaped(direction)),
            Self::Captured => Ok(Outcome::Captured),
            Self::StepLimit => Ok(Outcome::StepLimit),
            Self::NonFinite => Ok(Outcome::NonFinite),
        }
    }
}

/// Where a ray starts.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Lane of the ray.
    pub lane: usize,
    /// World position.
    pub position: DVec3,
    /// Unit direction in the static frame.
    pub direction: DVec3,
    /// The primitive it lies on.
    pub leaves: PrimitiveId,
}

/// Rays of a wavefront after a move.
pub struct Moved<'a, T: Transport> {
    /// What the rays move among.
    pub geometry: &'a Geometry,
    /// The rays as they were before; those that fly on are to be moved.
    pub flights: &'a mut Columns<T::Flight>,
    /// Their moves.
    pub moves: &'a Columns<T::Move>,
    /// What they meet.
    pub found: &'a [Option<Found>],
    /// Whether it matters where exactly a ray lands; else a landing may be on what was searched.
    pub exactly: &'a [bool],
}

/// A way for rays to move.
///
/// Methods named after another with `_all` do the same for many rays, bit for bit.
pub trait Transport: Send + Sync + Sized {
    /// A ray in flight.
    type Flight: Row;
    /// One move of a ray.
    type Move: Row;
    /// What the scene is searched along.
    type Segment: SideBySide;
    /// Memory that a wavefront keeps from round to round.
    type Scratch: Default + Send;

    /// A ray that starts at `position` (world) in the unit `direction`, on the primitive `leaves`.
    fn launch(&self, position: DVec3, direction: DVec3, leaves: PrimitiveId) -> Self::Flight;

    /// Launches rays into their lanes.
    fn launch_all(&self, starts: &[Start], flights: &mut Columns<Self::Flight>, _: &mut Self::Scratch) {
        for start in starts {
            flights.set(start.lane, self.launch(start.position, start.direction, start.leaves));
        }
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

    /// Blocks of moves as they are to be searched.
    fn queries_all(
        &self,
        flights: &[<Self::Flight as Row>::Block],
        moves: &[<Self::Move as Row>::Block],
        queries: &mut [<Query<Self::Segment> as Row>::Block],
    );

    /// What becomes of the ray, given what the search found; without `geometry` a landing is on what was searched rather
    /// than on the ray itself.
    fn settle(
        &self,
        geometry: Option<&Geometry>,
        flight: &Self::Flight,
        step: &Self::Move,
        found: Option<Found>,
    ) -> Outcome<Self::Flight>;

    /// Moves all rays that fly on, and tells `end` of the others, by lane.
    fn settle_all(
        &self,
        moved: Moved<Self>,
        _: &mut Self::Scratch,
        mut end: impl FnMut(usize, Outcome<Self::Flight>),
    ) {
        let Moved { geometry, flights, moves, found, exactly } = moved;
        for (lane, (&found, &exactly)) in found.iter().zip(exactly).enumerate() {
            match self.settle(exactly.then_some(geometry), &flights.get(lane), &moves.get(lane), found) {
                Outcome::Flying(next) => flights.set(lane, next),
                outcome => end(lane, outcome),
            }
        }
    }

    /// The whole of a move, in world coordinates; `None` if the step was not good enough to be taken.
    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Self::Segment>;

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

/// Something to be done with whichever transport a scene calls for.
pub trait Errand {
    /// What it gives.
    type Output;

    /// Does it; the transport may be kept.
    fn run<T: Transport + 'static>(self, transport: T) -> Self::Output;
}
