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
        let first = widest(First::<S, false> { geometry: self, segment, leaves })?;
        let point = segment.point(first.s);
        if leaves != PrimitiveId::NONE && self.is_near_start(segment.chord().start, point) {
            return self.past_start(segment, leaves, first);
        }
        Some(first)
    }

    /// The same, with all crossings at the start of the segment left out that are of what coincides with what it starts on.
    pub(super) fn intersect_past_start<S: Segment>(&self, segment: &S, leaves: PrimitiveId) -> Option<Hit> {
        widest(First::<S, true> { geometry: self, segment, leaves })
    }
}

/// A search, for the widest vectors that the machine has.
struct First<'a, S, const PAST_START: bool> {
    geometry: &'a Geometry,
    segment: &'a S,
    leaves: PrimitiveId,
}

impl<S: Segment, const PAST_START: bool> pulp::NullaryFnOnce for First<'_, S, PAST_START> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn call(self) -> Option<Hit> {
        let mut nearest = Nearest::<S, PAST_START>::new(self.geometry, self.segment, self.leaves);
        nearest.leaving.whole = PAST_START.then_some(self.segment);
        self.geometry.bvh.walk(&nearest.chord(), &mut nearest);
        nearest.hit
    }
}

/// Looks for the first hit in the top hierarchy; with `PAST_START`, beyond what coincides with what the segment starts on.
pub(super) struct Nearest<'a, S, const PAST_START: bool> {
    leaving: Leaving<'a, S>,
    /// Relative to the origin of the geometry.
    segment: S,
    along: Along,
    /// The first so far.
    pub(super) hit: Option<Hit>,
}

/// A segment and what it starts on.
#[derive(Clone, Copy)]
struct Leaving<'a, S> {
    geometry: &'a Geometry,
    /// World coordinates; only of a search past the start.
    whole: Option<&'a S>,
    leaves: PrimitiveId,
}

impl<S: Segment> Leaving<'_, S> {
    /// Whether the crossing of another primitive at `s` is but the start of the segment, which leaves it with its own.
    #[inline(always)]
    fn leaves_also(&self, primitive: PrimitiveId, s: f64) -> bool {
        self.leaves != primitive
            && self.whole.is_some_and(|whole| self.geometry.is_left(whole, self.leaves, s, primitive))
    }
}

impl<'a, S: Segment, const PAST_START: bool> Nearest<'a, S, PAST_START> {
    /// Along `segment` (world), which starts on the primitive `leaves`.
    #[inline(always)]
    pub(super) fn new(geometry: &'a Geometry, segment: &S, leaves: PrimitiveId) -> Self {
        let segment = segment.shifted(-geometry.origin);
        let leaving = Leaving { geometry, whole: None, leaves };
        Self { leaving, segment, along: Along::new(segment.chord()), hit: None }
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
        if s < f64::INFINITY && self.hit.is_none_or(|best| self.leaving.geometry.is_before(&hit, &best)) {
            self.hit = Some(hit);
            self.along.end_at(self.segment.point(s));
        }
    }

    /// First crossing of what is no triangle, by parameter (infinite if there is none) and triangle of an instance.
    fn cross_other(&self, slot: u32) -> (f64, u32) {
        let (geometry, segment) = (self.leaving.geometry, &self.segment);
        let primitive = PrimitiveId { item: slot, triangle: 0 };
        let own = self.leaving.leaves == primitive;
        match geometry.item(slot) {
            Item::Sphere(i) => {
                let sphere = &geometry.spheres[i as usize].0;
                let s = segment.cross_sphere(sphere, own);
                let again = PAST_START && self.leaving.leaves_also(primitive, s);
                (if again { segment.cross_sphere(sphere, true) } else { s }, 0)
            }
            Item::Disk(i) => {
                let disk = &geometry.disks[i as usize].0;
                let s = segment.cross_disk(disk, own);
                let again = PAST_START && self.leaving.leaves_also(primitive, s);
                (if again { segment.cross_disk(disk, true) } else { s }, 0)
            }
            Item::Instance(i) => self.cross_instance(slot, &geometry.placed[i as usize]),
            Item::Triangle(_) => (f64::INFINITY, 0),
        }
    }

    /// First crossing of a triangle of a placed mesh, by parameter (infinite if there is none) and slot.
    fn cross_instance(&self, item: u32, placed: &Placed) -> (f64, u32) {
        let leaving = self.leaving;
        let Some(shared) = &leaving.geometry.shared[placed.mesh as usize] else { return (f64::INFINITY, 0) };
        let segment = self.segment.transformed(&placed.to_object);
        let along = Along::new(segment.chord());
        let hit = (f64::INFINITY, 0);
        widest(NearestInside::<S, PAST_START> { leaving, item, shared, segment, along, hit })
    }
}

impl<S: Segment, const PAST_START: bool> Visitor for Nearest<'_, S, PAST_START> {
    #[inline(always)]
    fn leaf(&mut self, number: usize) -> f64 {
        let Leaving { geometry, leaves, .. } = self.leaving;
        if !geometry.singles.is_empty() {
            let mut may = self.along.screen_block::<S>(geometry.triangles.block(number));
            while let Some(slot) = next_slot(&mut may, number) {
                let primitive = PrimitiveId { item: slot, triangle: 0 };
                if S::BENDS || leaves != primitive {
                    let mut s = self.segment.cross_triangle(&geometry.triangle(slot), leaves == primitive);
                    if PAST_START && self.leaving.leaves_also(primitive, s) {
                        s = self.segment.cross_triangle(&geometry.triangle(slot), true);
                    }
                    self.consider(s, slot, 0);
                }
            }
        }
        if !geometry.others.is_empty() {
            for slot in (number * LEAF_SIZE) as u32..((number + 1) * LEAF_SIZE) as u32 {
                if (geometry.bvh.order()[slot as usize] as usize) < geometry.others.len() {
                    let (s, triangle) = self.cross_other(slot);
                    self.consider(s, slot, triangle);
                }
            }
        }
        self.along.until
    }

    #[inline(always)]
    fn prefetch(&self, number: usize) {
        let geometry = self.leaving.geometry;
        if !geometry.singles.is_empty() {
            prefetch(geometry.triangles.block(number));
        }
    }
}

/// Looks for the first hit in the hierarchy of a shared mesh.
struct NearestInside<'a, S, const PAST_START: bool> {
    leaving: Leaving<'a, S>,
    /// Slot of the placed mesh.
    item: u32,
    shared: &'a SharedMesh,
    /// In the mesh's own coordinates.
    segment: S,
    along: Along,
    /// Parameter and slot.
    hit: (f64, u32),
}

impl<S: Segment, const PAST_START: bool> pulp::NullaryFnOnce for NearestInside<'_, S, PAST_START> {
    type Output = (f64, u32);

    #[inline(always)]
    fn call(mut self) -> (f64, u32) {
        let chord = self.along.chord;
        self.shared.bvh.walk(&chord, &mut self);
        self.hit
    }
}

impl<S: Segment, const PAST_START: bool> Visitor for NearestInside<'_, S, PAST_START> {
    #[inline(always)]
    fn leaf(&mut self, number: usize) -> f64 {
        let SharedMesh { bvh, triangles } = self.shared;
        let order = bvh.order();
        let mut may = self.along.screen_block::<S>(triangles.block(number));
        while let Some(slot) = next_slot(&mut may, number) {
            let primitive = PrimitiveId { item: self.item, triangle: slot };
            let own = self.leaving.leaves == primitive;
            let mut s = self.segment.cross_triangle(&triangles.get(slot as usize), own);
            if PAST_START && self.leaving.leaves_also(primitive, s) {
                s = self.segment.cross_triangle(&triangles.get(slot as usize), true);
            }
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
