//! Searching the scene along a move.

use super::super::stats::Counters;
use super::super::transport::{Found, Transport};
use crate::geometry::{Geometry, Segment};

/// The first thing that a move meets.
#[inline(always)]
pub fn intersect<T: Transport>(
    transport: &T,
    geometry: &Geometry,
    flight: &T::Flight,
    step: &T::Move,
    counters: &mut Counters,
) -> Option<Found> {
    counters.steps += 1;
    transport.search(flight, step, |segment, leaves| {
        counters.queries += 1;
        let hit = geometry.intersect(segment, leaves)?;
        Some(Found { point: segment.point(hit.s), primitive: hit.primitive })
    })
}
