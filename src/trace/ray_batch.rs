//! Rays followed together, each to its end, without shading.

use std::convert::Infallible;

use super::halt::Halt;
use super::stages::intersect::intersect_all;
use super::stats::Counters;
use super::transport::{Moved, Outcome, Start, Transport};
use crate::geometry::{Geometry, Search, Sought};
use crate::math::columns::Columns;

/// A worker's rays. Lanes are dense, as in a wavefront; none is filled again.
pub struct RayBatch<T: Transport> {
    flights: Columns<T::Flight>,
    moves: Columns<T::Move>,
    search: Search<T::Segment>,
    scratch: T::Scratch,
    /// Index of the ray in each lane.
    rays: Vec<usize>,
    /// True for all rays: the exact landing always matters.
    exactly: Vec<bool>,
    starts: Vec<(usize, Start<T::Carried>)>,
    /// Lanes whose rays ended in this round.
    ended: Vec<usize>,
}

impl<T: Transport> Default for RayBatch<T> {
    fn default() -> Self {
        Self {
            flights: Columns::default(),
            moves: Columns::default(),
            search: Search::default(),
            scratch: T::Scratch::default(),
            rays: Vec::new(),
            exactly: Vec::new(),
            starts: Vec::new(),
            ended: Vec::new(),
        }
    }
}

impl<T: Transport> RayBatch<T> {
    /// Ends of the rays from `from`, in their order, and their payloads there, as [`follow`](super::shoot::follow)
    /// gives for each; not worth anything once `halt` is due.
    pub fn follow(
        &mut self,
        transport: &T,
        geometry: &Geometry,
        from: &[Start<T::Carried>],
        halt: &Halt,
        ends: &mut Vec<(Outcome<Infallible>, T::Carried)>,
    ) {
        ends.clear();
        ends.resize(from.len(), (Outcome::NonFinite, T::Carried::default()));
        self.launch(transport, from);
        let (mut live, mut counters) = (from.len(), Counters::default());
        let Self { flights, moves, search, scratch, rays, exactly, ended, .. } = self;
        while live > 0 && !halt.is_due() {
            transport.advance_all(flights.blocks(live), moves.blocks_mut(live));
            let sought = (live, |_| Sought::First);
            intersect_all(transport, geometry, (flights, moves), search, sought, &mut counters);
            let (found, exactly) = (&search.found, &exactly[..live]);
            transport.settle_all(
                Moved { geometry, flights, moves, found, exactly },
                scratch,
                |lane, outcome, carried| {
                    if let Ok(end) = outcome.end() {
                        ends[rays[lane]] = (end, carried);
                        ended.push(lane);
                    }
                },
            );
            // From the back, so that no lane that ended is moved.
            ended.sort_unstable();
            while let Some(lane) = ended.pop() {
                live -= 1;
                flights.set(lane, flights.get(live));
                rays[lane] = rays[live];
            }
        }
    }

    fn launch(&mut self, transport: &T, from: &[Start<T::Carried>]) {
        self.flights.resize(from.len());
        self.moves.resize(from.len());
        self.exactly.resize(from.len(), true);
        self.rays.clear();
        self.rays.extend(0..from.len());
        self.starts.clear();
        self.starts.extend(from.iter().copied().enumerate());
        transport.launch_all(&self.starts, &mut self.flights, &mut self.scratch);
    }
}
