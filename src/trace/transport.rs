//! How rays move: the interface between spacetimes and the schedules.
//!
//! A ray in flight is advanced by one move at a time. A move is a piece of the ray that the scene is searched along;
//! what was found decides how the flight goes on. Straight rays are one move long.

use glam::DVec3;

use super::columns::Row;
use super::stages::advance::{Own, advance_blocks};
use crate::geometry::{Geometry, PrimitiveId, Segment};

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

/// Something found along a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// World position of the crossing.
    pub point: DVec3,
    /// What is crossed.
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

/// A way for rays to move.
pub trait Transport: Sync + Sized {
    /// A ray in flight.
    type Flight: Row;
    /// One move of a ray.
    type Move: Row;
    /// What the scene is searched along.
    type Segment: Segment;

    /// A ray that starts at `position` (world) in the unit `direction`, on the primitive `leaves`.
    fn launch(&self, position: DVec3, direction: DVec3, leaves: PrimitiveId) -> Self::Flight;

    /// The next move of a ray; touches nothing but the ray.
    fn advance(&self, flight: &Self::Flight) -> Self::Move;

    /// The next moves of blocks of rays, bit for bit those of [`Self::advance`].
    fn advance_blocks(
        &self,
        flights: &[<Self::Flight as Row>::Block],
        moves: &mut [<Self::Move as Row>::Block],
    ) {
        advance_blocks(&Own(self), flights, moves);
    }

    /// The pieces of a move to be searched in turn, none if nothing can be met: calls `search` until it finds
    /// something. `search` takes a piece and the primitive that the piece starts on.
    fn search(
        &self,
        flight: &Self::Flight,
        step: &Self::Move,
        search: impl FnMut(&Self::Segment, PrimitiveId) -> Option<Found>,
    ) -> Option<Found>;

    /// What becomes of the ray, given what the search found; without `geometry` a landing is on what was searched rather
    /// than on the ray itself.
    fn settle(
        &self,
        geometry: Option<&Geometry>,
        flight: &Self::Flight,
        step: &Self::Move,
        found: Option<Found>,
    ) -> Outcome<Self::Flight>;

    /// The whole of a move, in world coordinates; `None` if the step was not good enough to be taken.
    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Self::Segment>;

    /// Coordinate length of a move, up to `point` if given.
    fn length(&self, flight: &Self::Flight, step: &Self::Move, point: Option<DVec3>) -> f64;
}

/// Something to be done with whichever transport a scene calls for.
pub trait Errand {
    /// What it gives.
    type Output;

    /// Does it.
    fn run<T: Transport>(self, transport: &T) -> Self::Output;
}
