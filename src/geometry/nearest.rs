//! The first primitive that a segment meets, by a walk of the hierarchy.

use glam::DVec3;

use super::bvh::{LEAF_SIZE, Visitor};
use super::scene::{Item, Placed, SharedMesh};
use super::screen::Screen;
use super::{Chord, Geometry, Hit, PrimitiveId, Segment, Triangle};
use crate::math::columns::Row;
use crate::math::kernel::widest;
use crate::math::prefetch::prefetch;

impl Geometry {
    /// The first primitive that `segment` meets; `leaves` is the one it starts on.
    ///
    /// Where two primitives are met at the very same parameter the one that was given first wins, whatever the order of
    /// the hierarchy.
    #[inline]
    pub fn intersect<S: Segment>(&self, segment: &S, leaves: PrimitiveId) -> Option<Hit> {
        widest(First { geometry: self, segment, leaves })
    }

    /// First crossing of what is no triangle, by parameter (infinite if there is none) and triangle of an instance. `left`
    /// is what the segment starts on, if that is a part of it.
    fn cross_other<S: Segment>(&self, slot: u32, segment: &S, left: Option<u32>) -> (f64, u32) {
        match self.item(slot) {
            Item::Sphere(i) => (segment.cross_sphere(&self.spheres[i as usize].0, left.is_some()), 0),
            Item::Disk(i) => (segment.cross_disk(&self.disks[i as usize].0, left.is_some()), 0),
            Item::Instance(i) => self.cross_instance(&self.placed[i as usize], segment, left),
            Item::Triangle(_) => (f64::INFINITY, 0),
        }
    }

    /// First crossing of a triangle of a placed mesh by `segment` (relative to the origin), by parameter (infinite if there
    /// is none) and slot.
    fn cross_instance<S: Segment>(&self, placed: &Placed, segment: &S, leaves: Option<u32>) -> (f64, u32) {
        let Some(shared) = &self.shared[placed.mesh as usize] else { return (f64::INFINITY, 0) };
        let segment = segment.transformed(&placed.to_object);
        let along = Along::new(segment.chord());
        widest(NearestInside { shared, segment, along, own: leaves, hit: (f64::INFINITY, 0) })
    }
}

/// A search, for the widest vectors that the machine has.
struct First<'a, S> {
    geometry: &'a Geometry,
    segment: &'a S,
    leaves: PrimitiveId,
}

impl<S: Segment> pulp::NullaryFnOnce for First<'_, S> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn call(self) -> Option<Hit> {
        let mut nearest = Nearest::new(self.geometry, self.segment, self.leaves);
        self.geometry.bvh.walk(&nearest.chord(), &mut nearest);
        nearest.hit
    }
}

/// Looks for the first hit in the top hierarchy.
pub(super) struct Nearest<'a, S> {
    geometry: &'a Geometry,
    /// Relative to the origin of the geometry.
    segment: S,
    along: Along,
    leaves: PrimitiveId,
    /// The first so far.
    pub(super) hit: Option<Hit>,
}

impl<'a, S: Segment> Nearest<'a, S> {
    /// Along `segment` (world), which starts on the primitive `leaves`.
    #[inline(always)]
    pub(super) fn new(geometry: &'a Geometry, segment: &S, leaves: PrimitiveId) -> Self {
        let segment = segment.shifted(-geometry.origin);
        Self { geometry, segment, along: Along::new(segment.chord()), leaves, hit: None }
    }

    /// What is to be walked along.
    #[inline(always)]
    pub(super) fn chord(&self) -> Chord {
        self.along.chord
    }

    /// Takes a crossing if it is the first.
    #[inline(always)]
    fn consider(&mut self, s: f64, item: u32, triangle: u32) {
        let hit = Hit { s, primitive: PrimitiveId { item, triangle } };
        if s < f64::INFINITY && self.hit.is_none_or(|best| self.geometry.is_before(&hit, &best)) {
            self.hit = Some(hit);
            self.along.end_at(self.segment.point(s));
        }
    }
}

impl<S: Segment> Visitor for Nearest<'_, S> {
    #[inline(always)]
    fn leaf(&mut self, number: usize) -> f64 {
        let geometry = self.geometry;
        if !geometry.singles.is_empty() {
            let mut may = self.along.screen_block::<S>(geometry.triangles.block(number));
            while let Some(slot) = next_slot(&mut may, number) {
                let own = self.leaves == PrimitiveId { item: slot, triangle: 0 };
                if S::BENDS || !own {
                    let s = self.segment.cross_triangle(&geometry.triangle(slot), own);
                    self.consider(s, slot, 0);
                }
            }
        }
        if !geometry.others.is_empty() {
            for slot in (number * LEAF_SIZE) as u32..((number + 1) * LEAF_SIZE) as u32 {
                if (geometry.bvh.order()[slot as usize] as usize) < geometry.others.len() {
                    let left = (self.leaves.item == slot).then_some(self.leaves.triangle);
                    let (s, triangle) = geometry.cross_other(slot, &self.segment, left);
                    self.consider(s, slot, triangle);
                }
            }
        }
        self.along.until
    }

    #[inline(always)]
    fn prefetch(&self, number: usize) {
        if !self.geometry.singles.is_empty() {
            prefetch(self.geometry.triangles.block(number));
        }
    }
}

/// Looks for the first hit in the hierarchy of a shared mesh.
struct NearestInside<'a, S> {
    shared: &'a SharedMesh,
    /// In the mesh's own coordinates.
    segment: S,
    along: Along,
    own: Option<u32>,
    /// Parameter and slot.
    hit: (f64, u32),
}

impl<S: Segment> pulp::NullaryFnOnce for NearestInside<'_, S> {
    type Output = (f64, u32);

    #[inline(always)]
    fn call(mut self) -> (f64, u32) {
        let chord = self.along.chord;
        self.shared.bvh.walk(&chord, &mut self);
        self.hit
    }
}

impl<S: Segment> Visitor for NearestInside<'_, S> {
    #[inline(always)]
    fn leaf(&mut self, number: usize) -> f64 {
        let SharedMesh { bvh, triangles } = self.shared;
        let order = bvh.order();
        let mut may = self.along.screen_block::<S>(triangles.block(number));
        while let Some(slot) = next_slot(&mut may, number) {
            let s = self.segment.cross_triangle(&triangles.get(slot as usize), self.own == Some(slot));
            let (best, at) = self.hit;
            if s < best || (s == best && s < f64::INFINITY && order[slot as usize] < order[at as usize]) {
                self.hit = (s, slot);
                self.along.end_at(self.segment.point(s));
            }
        }
        self.along.until
    }

    #[inline(always)]
    fn prefetch(&self, number: usize) {
        prefetch(self.shared.triangles.block(number));
    }
}

/// Takes the next slot of a leaf from the lanes that `may` names by bytes.
#[inline(always)]
fn next_slot(may: &mut u64, leaf: usize) -> Option<u32> {
    let lane = may.trailing_zeros() / u8::BITS;
    *may &= may.wrapping_sub(1);
    (lane < LEAF_SIZE as u32).then_some((leaf * LEAF_SIZE) as u32 + lane)
}

/// How far along its chord a segment has to be searched.
struct Along {
    chord: Chord,
    /// The part of the chord that matters.
    until: f64,
    screen: Screen,
}

impl Along {
    #[inline(always)]
    fn new(chord: Chord) -> Self {
        Self { chord, until: 1.0, screen: Screen::new(&chord) }
    }

    /// One byte a lane: whether the segment may cross the triangle of that lane.
    #[inline(always)]
    fn screen_block<S: Segment>(&self, triangles: &<Triangle as Row>::Block) -> u64 {
        if S::BENDS {
            self.screen.may_cross::<true>(triangles)
        } else {
            self.screen.may_cross::<false>(triangles)
        }
    }

    /// Nothing beyond `point` matters any more.
    #[inline(always)]
    fn end_at(&mut self, point: DVec3) {
        let along = self.chord.end - self.chord.start;
        let part = (point - self.chord.start).dot(along) / along.length_squared();
        self.until = self.until.min(part);
        self.screen.end_at(part);
    }
}
