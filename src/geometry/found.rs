//! Answers of searches.

use glam::DVec3;

use super::PrimitiveId;

/// Something found along a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// World position of the crossing.
    pub point: DVec3,
    /// Primitive that is hit.
    pub primitive: PrimitiveId,
}

/// Things found along many segments, by lane.
#[derive(Debug, Default)]
pub struct Finds {
    by_lane: Vec<Option<Found>>,
    /// Lanes that found something, in the order in which they did.
    lanes: Vec<usize>,
}

impl Finds {
    /// Forgets all, and makes room for `lanes` lanes.
    pub fn reset(&mut self, lanes: usize) {
        let Self { by_lane, lanes: known } = self;
        known.drain(..).for_each(|lane| by_lane[lane] = None);
        by_lane.resize(lanes, None);
    }

    /// Adds what a lane found, which has found nothing yet.
    #[inline(always)]
    pub fn add(&mut self, lane: usize, found: Found) {
        self.by_lane[lane] = Some(found);
        self.lanes.push(lane);
    }

    /// What a lane found.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Option<Found> {
        self.by_lane[lane]
    }

    /// Lanes that found something, each once, and what.
    pub fn iter(&self) -> impl Iterator<Item = (usize, Found)> {
        self.lanes.iter().filter_map(|&lane| Some((lane, self.by_lane[lane]?)))
    }
}
