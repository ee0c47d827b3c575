//! Searching the scene along a move.

use super::super::stats::Counters;
use super::super::transport::Transport;
use crate::geometry::{Found, Geometry, Need, Search, Segment, Sought};
use crate::math::columns::Columns;

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
    transport.search(flight, step, |segment, origin_prim| {
        counters.queries += 1;
        let hit = geometry.intersect(segment, origin_prim)?;
        Some(Found { point: segment.point(hit.s), primitive: hit.primitive })
    })
}

/// The first things that the moves in the first `lanes` lanes meet; of moves that are all of a ray, what tells whether what
/// is `sought` is so.
pub fn intersect_all<T: Transport>(
    transport: &T,
    geometry: &Geometry,
    (flights, moves): (&Columns<T::Flight>, &Columns<T::Move>),
    search: &mut Search<T::Segment>,
    (lanes, sought): (usize, impl Fn(usize) -> Sought),
    counters: &mut Counters,
) {
    search.queries.resize(lanes);
    let queries = search.queries.blocks_mut(lanes);
    transport.queries_all(flights.blocks(lanes), moves.blocks(lanes), queries);
    if T::IS_STRAIGHT {
        geometry.seek_all(search, lanes, sought);
    } else {
        geometry.search_all(search, lanes);
    }
    let Search { queries, found, .. } = search;
    counters.queries += queries.lanes_where(lanes, |query| query.need == Need::Whole).count() as u64;
    let mut whole = lanes;
    for lane in queries.lanes_where(lanes, |query| query.need == Need::Pieces) {
        whole -= 1;
        let (flight, step) = (flights.get(lane), moves.get(lane));
        if let Some(first) = intersect(transport, geometry, &flight, &step, counters) {
            found.add(lane, first);
        }
    }
    counters.steps += whole as u64;
}
