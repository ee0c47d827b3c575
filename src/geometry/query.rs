//! Query of a search: a segment, how it is to be searched, and what for.

use glam::DVec3;

use super::PrimitiveId;
use crate::math::columns::{LANES, Row, plain_field};

/// Kind of search that a move needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Need {
    /// Not at all: it meets nothing.
    #[default]
    Nothing,
    /// As a whole.
    Whole,
    /// In pieces.
    Pieces,
}

plain_field!(Need);

/// A segment to be searched.
#[derive(Clone, Copy, Debug, Default)]
pub struct Query<S> {
    /// The segment, world coordinates.
    pub segment: S,
    /// Primitive that it starts on.
    pub origin_prim: PrimitiveId,
    /// Kind of search that it needs.
    pub need: Need,
}

/// A block of [`Query`].
#[derive(Clone, Copy, Default)]
pub struct QueryBlock<B> {
    pub(super) segment: B,
    pub(super) origin_prim: [PrimitiveId; LANES],
    pub(super) need: [Need; LANES],
}

impl<S: Row> Row for Query<S> {
    type Block = QueryBlock<S::Block>;

    #[inline(always)]
    fn get(block: &Self::Block, lane: usize) -> Self {
        let lane = lane % LANES;
        Query {
            segment: S::get(&block.segment, lane),
            origin_prim: block.origin_prim[lane],
            need: block.need[lane],
        }
    }

    #[inline(always)]
    fn set(block: &mut Self::Block, lane: usize, row: Self) {
        let lane = lane % LANES;
        S::set(&mut block.segment, lane, row.segment);
        (block.origin_prim[lane], block.need[lane]) = (row.origin_prim, row.need);
    }
}

/// Object of a search along a straight segment: what it finds need only tell whether that is so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sought {
    /// What is met first.
    First,
    /// That a primitive is met first.
    Primitive(PrimitiveId),
    /// That nothing is met before a point (world) of the segment.
    Point(DVec3),
    /// That nothing is met at all.
    Nothing,
}
