//! Single rays, followed to their ends without shading.

use std::convert::Infallible;

use glam::DVec3;
use rayon::prelude::*;

use super::choice::with_transport;
use super::halt::Halt;
use super::stages::intersect::intersect;
use super::stats::Counters;
use super::transport::{Landing, Outcome, Start, Transport, TransportVisitor};
use crate::geometry::{Found, Geometry, PrimitiveId};
use crate::scene::Baked;

/// A ray to be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// World start.
    pub position: DVec3,
    /// Unit direction in the static frame.
    pub direction: DVec3,
    /// Primitive that it starts on: [`PrimitiveId::NONE`] in free space.
    pub origin_prim: PrimitiveId,
}

impl Ray {
    /// Start of the ray, with nothing else said about it.
    pub(super) fn start<C: Default>(&self) -> Start<C> {
        let Self { position, direction, origin_prim } = *self;
        Start { position, direction, origin_prim, carried: C::default() }
    }
}

/// Steps between two looks at the clock.
const PATIENCE: u64 = 64;

/// Outcome of a followed ray, and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Outcome of the ray; never flying.
    pub end: Outcome<Infallible>,
    /// March steps, rejected ones included.
    pub steps: u64,
    /// BVH queries.
    pub queries: u64,
}

/// Follows `rays` through `scene`, each to the first thing it meets or to where it is lost, on all threads.
pub fn shoot(scene: &Baked, rays: &[Ray]) -> Vec<Shot> {
    with_transport(scene, Shooting { geometry: &scene.geometry, rays })
}

struct Shooting<'a> {
    geometry: &'a Geometry,
    rays: &'a [Ray],
}

impl TransportVisitor for Shooting<'_> {
    type Output = Vec<Shot>;

    fn run<T: Transport + 'static>(self, transport: T) -> Vec<Shot> {
        let halt = Halt::default();
        self.rays
            .par_iter()
            .map(|ray| follow(&transport, self.geometry, &ray.start(), &halt, |_, _, _, _| {}).0)
            .collect()
    }
}

/// Follows one ray to its end, or until `halt` as if it were out of steps; `each` sees every move, the hit found along
/// it, and the landing of the ray on it, if any. With the shot comes the ray's payload at its end.
pub(super) fn follow<T: Transport>(
    transport: &T,
    geometry: &Geometry,
    start: &Start<T::Carried>,
    halt: &Halt,
    mut each: impl FnMut(&T::Flight, &T::Move, Option<Found>, Option<&Landing>),
) -> (Shot, T::Carried) {
    let mut flight = transport.launch(start);
    let mut counters = Counters::default();
    loop {
        let step = transport.advance(&flight);
        let found = intersect(transport, geometry, &flight, &step, &mut counters);
        let (outcome, carried) = transport.settle(Some(geometry), &flight, &step, found);
        each(
            &flight,
            &step,
            found,
            if let Outcome::Landed(landing) = &outcome { Some(landing) } else { None },
        );
        match outcome.end() {
            Ok(end) => {
                return (Shot { end, steps: counters.steps, queries: counters.queries }, carried);
            }
            Err(next) => flight = next,
        }
        if counters.steps.is_multiple_of(PATIENCE) && halt.is_due() {
            let Counters { steps, queries, .. } = counters;
            return (Shot { end: Outcome::StepLimit, steps, queries }, carried);
        }
    }
}
