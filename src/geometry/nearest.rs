//! The first primitive that a segment meets, by a walk of the hierarchy.

use super::bvh::{LEAF_SIZE, Visitor};
use super::cull::{Cull, min};
use super::query::Sought;
use super::scene::{Item, Placed, SharedMesh};
use super::shortlist::Shortlist;
use super::{Chord, Geometry, Hit, PrimitiveId, Segment, Triangle};
use crate::math::columns::Row;
use crate::math::prefetch::prefetch;
use crate::math::simd8::{Simd8, Simd8Work, with_simd8};
use crate::spacetime::Side;

impl Geometry {
    /// The first primitive that `segment` meets on the side of the one it starts on, `origin_prim`.
    ///
    /// Of two primitives met at the very same parameter the one that was given first wins, whatever the order of the
    /// hierarchy.
    #[inline]
    pub fn intersect<S: Segment>(&self, segment: &S, origin_prim: PrimitiveId) -> Option<Hit> {
        let side = origin_prim.side();
        let hit = self.of(side)?.own_intersection(segment, origin_prim.on(Side::Near))?;
        Some(hit.on(side))
    }

    /// [`Self::intersect`] on the near side.
    #[inline]
    pub(super) fn own_intersection<S: Segment>(&self, segment: &S, origin_prim: PrimitiveId) -> Option<Hit> {
        let first = self.first(segment, origin_prim)?;
        let point = segment.point(first.s);
        if origin_prim != PrimitiveId::NONE && self.is_near_start(segment.chord().start, point) {
            return self.past_start(segment, origin_prim, first);
        }
        Some(first)
    }

    /// The first hit of a segment that leaves what `origin_prim` tells.
    #[inline]
    pub(super) fn first<S: Segment, L: Leaving>(&self, segment: &S, origin_prim: L) -> Option<Hit> {
        with_simd8(First { geometry: self, segment, origin_prim })
    }
}

/// Primitives that a segment starts on; their crossings at its start do not count.
pub(super) trait Leaving: Copy {
    /// True if it leaves no more than one primitive, which a line does not meet again.
    const IS_ONE: bool;

    /// Slot of the triangle that the segment starts on in the top hierarchy, or in that of the mesh placed in a slot;
    /// any other if there is none.
    fn own_slot(&self, placed: Option<u32>) -> u32;

    /// True if the segment starts on a primitive.
    fn starts_on(&self, primitive: PrimitiveId) -> bool;

    /// True if a crossing of another primitive at `s` is but the start: the segment leaves that one as well.
    fn leaves_also(&self, primitive: PrimitiveId, s: f64) -> bool;
}

/// A primitive alone.
impl Leaving for PrimitiveId {
    const IS_ONE: bool = true;

    #[inline(always)]
    fn own_slot(&self, placed: Option<u32>) -> u32 {
        match placed {
            None => self.item,
            Some(slot) if slot == self.item => self.triangle,
            Some(_) => Self::NONE.triangle,
        }
    }

    #[inline(always)]
    fn starts_on(&self, primitive: PrimitiveId) -> bool {
        *self == primitive
    }

    #[inline(always)]
    fn leaves_also(&self, _: PrimitiveId, _: f64) -> bool {
        false
    }
}

/// A search, for the widest vectors that the machine has.
struct First<'a, S, L> {
    geometry: &'a Geometry,
    segment: &'a S,
    origin_prim: L,
}

impl<S: Segment, L: Leaving> Simd8Work for First<'_, S, L> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<V: Simd8>(self, simd: V) -> Option<Hit> {
        let mut nearest = Nearest::new(self.geometry, self.segment, self.origin_prim);
        self.geometry.bvh.walk(simd, &nearest.chord(), 1.0, &mut nearest);
        nearest.settle();
        nearest.hit
    }
}

/// Looks for the first hit in the top hierarchy.
pub(super) struct Nearest<'a, S, L> {
    pub(super) geometry: &'a Geometry,
    /// Relative to the origin of the geometry.
    segment: S,
    along: Along,
    origin_prim: L,
    /// Any hit before this parameter is as good as the first.
    any_before: f64,
    /// The first so far.
    pub(super) hit: Option<Hit>,
    /// What is not yet tested.
    shortlist: Shortlist,
}

/// Difference of parameters that rounding does not make.
const APART: f64 = 1e-6;

impl<'a, S: Segment, L: Leaving> Nearest<'a, S, L> {
    /// Along `segment` (world), which leaves what `origin_prim` tells.
    #[inline(always)]
    pub(super) fn new(geometry: &'a Geometry, segment: &S, origin_prim: L) -> Self {
        let segment = segment.shifted(-geometry.origin);
        let along = Along::new(segment.chord());
        let shortlist = Shortlist::default();
        Self { geometry, segment, along, origin_prim, any_before: 0.0, hit: None, shortlist }
    }

    /// Looks no longer than it takes to tell whether what is `sought` is so.
    #[inline(always)]
    pub(super) fn seek(&mut self, sought: Sought) {
        match sought {
            Sought::First => {}
            Sought::Primitive(primitive) => {
                let PrimitiveId { item, .. } = primitive.on(Side::Near);
                if let Item::Triangle(_) = self.geometry.item(item) {
                    let own = self.origin_prim.starts_on(PrimitiveId { item, triangle: 0 });
                    let s = self.segment.cross_triangle(&self.geometry.triangle(item), own);
                    self.consider(s, item, 0);
                    self.any_before = self.hit.map_or(0.0, |hit| hit.s);
                }
            }
            Sought::Point(point) => {
                let s = self.segment.parameter_beside(point - self.geometry.origin);
                self.any_before = s - APART;
                self.along.end_at(s + APART);
            }
            Sought::Nothing => self.any_before = f64::INFINITY,
        }
    }

    /// Chord to walk the hierarchy along.
    #[inline(always)]
    pub(super) fn chord(&self) -> Chord {
        self.along.chord
    }

    /// Part of the chord that matters.
    #[inline(always)]
    pub(super) fn until(&self) -> f32 {
        self.along.until
    }

    /// Tests what was put off: only then [`Self::hit`] is the first.
    #[inline(always)]
    pub(super) fn settle(&mut self) {
        while let Some(slot) = self.shortlist.pop() {
            let s = self.segment.cross_triangle(&self.geometry.triangle(slot), false);
            self.consider(s, slot, 0);
        }
    }

    /// Takes a crossing if it is the first.
    #[inline(always)]
    fn consider(&mut self, s: f64, item: u32, triangle: u32) {
        let hit = Hit { s, primitive: PrimitiveId { item, triangle } };
        if s < f64::INFINITY && self.hit.is_none_or(|best| self.geometry.is_before(&hit, &best)) {
            self.hit = Some(hit);
            let is_enough = s < self.any_before;
            self.along.end_at(if is_enough { BEFORE_ALL.into() } else { self.segment.part_beside(s) });
        }
    }
}

/// Part of a chord that is before all of it.
const BEFORE_ALL: f32 = -1.0;

/// True if triangles are tested at the end: if all that surely are crossed count, and it is known where.
const fn puts_off<S: Segment, L: Leaving>() -> bool {
    !S::BENDS && L::IS_ONE
}

impl<S: Segment, L: Leaving> Visitor for Nearest<'_, S, L> {
    #[inline(always)]
    fn leaf<V: Simd8>(&mut self, simd: V, number: usize, until: f32) -> f32 {
        let Self { geometry, origin_prim, .. } = *self;
        if !geometry.singles.is_empty() && puts_off::<S, L>() {
            let met = self.along.cull.may_cross_line(simd, geometry.triangles.block(number), until);
            let own = lane_in(number, origin_prim.own_slot(None));
            let before = self.shortlist.add(&met.without(own), number);
            let is_enough = f64::from(before) < self.any_before;
            self.along.until = min(self.along.until, if is_enough { BEFORE_ALL } else { before });
            if self.shortlist.is_long() {
                self.settle();
            }
        } else if !geometry.singles.is_empty() {
            let mut may = self.along.screen_block::<S, V>(simd, geometry.triangles.block(number), until);
            while let Some(slot) = next_slot(&mut may, number) {
                let primitive = PrimitiveId { item: slot, triangle: 0 };
                let own = origin_prim.starts_on(primitive);
                if S::BENDS || !own {
                    let mut s = self.segment.cross_triangle(&geometry.triangle(slot), own);
                    if origin_prim.leaves_also(primitive, s) {
                        s = self.segment.cross_triangle(&geometry.triangle(slot), true);
                    }
                    self.consider(s, slot, 0);
                }
            }
        }
        if !geometry.others.is_empty() {
            for slot in (number * LEAF_SIZE) as u32..((number + 1) * LEAF_SIZE) as u32 {
                if (geometry.bvh.order()[slot as usize] as usize) < geometry.others.len() {
                    let before = if puts_off::<S, L>() {
                        self.along.until.into()
                    } else {
                        self.hit.map_or(f64::INFINITY, |hit| hit.s)
                    };
                    let (s, triangle) = cross_other(geometry, slot, (&self.segment, before), origin_prim);
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

/// First crossing of what is no triangle by a segment (relative to the origin), by parameter (infinite if there is
/// none) and triangle of an instance. Those that are not `before` a parameter need not be found.
fn cross_other<S: Segment, L: Leaving>(
    geometry: &Geometry,
    slot: u32,
    (segment, before): (&S, f64),
    origin_prim: L,
) -> (f64, u32) {
    let primitive = PrimitiveId { item: slot, triangle: 0 };
    let own = origin_prim.starts_on(primitive);
    match geometry.item(slot) {
        Item::Sphere(i) => {
            let sphere = &geometry.spheres[i as usize].0;
            let s = segment.cross_sphere(sphere, own);
            (if origin_prim.leaves_also(primitive, s) { segment.cross_sphere(sphere, true) } else { s }, 0)
        }
        Item::Disk(i) => {
            let disk = &geometry.disks[i as usize].0;
            let s = segment.cross_disk(disk, own);
            (if origin_prim.leaves_also(primitive, s) { segment.cross_disk(disk, true) } else { s }, 0)
        }
        Item::Instance(i) => {
            cross_instance(geometry, slot, &geometry.placed[i as usize], (segment, before), origin_prim)
        }
        Item::Triangle(_) => (f64::INFINITY, 0),
    }
}

/// First crossing of a triangle of the mesh placed in a slot, by parameter (infinite if there is none) and slot in the
/// mesh. Those that are not `before` a parameter need not be found.
fn cross_instance<S: Segment, L: Leaving>(
    geometry: &Geometry,
    item: u32,
    placed: &Placed,
    (segment, before): (&S, f64),
    origin_prim: L,
) -> (f64, u32) {
    let Some(shared) = &geometry.shared[placed.mesh as usize] else { return (f64::INFINITY, 0) };
    let segment = segment.transformed(&placed.to_object);
    let mut along = Along::new(segment.chord());
    if before < f64::INFINITY {
        along.end_at(segment.part_beside(before));
    }
    with_simd8(NearestInside {
        shared,
        segment,
        along,
        origin_prim,
        item,
        hit: (f64::INFINITY, 0),
        shortlist: Shortlist::default(),
    })
}

/// Looks for the first hit in the hierarchy of a shared mesh.
struct NearestInside<'a, S, L> {
    shared: &'a SharedMesh,
    /// In the mesh's own coordinates.
    segment: S,
    along: Along,
    origin_prim: L,
    /// Slot of the placed mesh.
    item: u32,
    /// Parameter and slot.
    hit: (f64, u32),
    /// What is not yet tested.
    shortlist: Shortlist,
}

impl<S: Segment, L: Leaving> Simd8Work for NearestInside<'_, S, L> {
    type Output = (f64, u32);

    #[inline(always)]
    fn run<V: Simd8>(mut self, simd: V) -> (f64, u32) {
        let Along { chord, until, .. } = self.along;
        self.shared.bvh.walk(simd, &chord, until, &mut self);
        self.settle();
        self.hit
    }
}

impl<S: Segment, L: Leaving> NearestInside<'_, S, L> {
    /// Tests what was put off.
    #[inline(always)]
    fn settle(&mut self) {
        while let Some(slot) = self.shortlist.pop() {
            let s = self.segment.cross_triangle(&self.shared.triangles.get(slot as usize), false);
            self.consider(s, slot);
        }
    }

    /// Takes a crossing if it is the first.
    #[inline(always)]
    fn consider(&mut self, s: f64, slot: u32) {
        let ((best, at), order) = (self.hit, self.shared.bvh.order());
        if s < best || (s == best && s < f64::INFINITY && order[slot as usize] < order[at as usize]) {
            self.hit = (s, slot);
            self.along.end_at(self.segment.part_beside(s));
        }
    }
}

impl<S: Segment, L: Leaving> Visitor for NearestInside<'_, S, L> {
    #[inline(always)]
    fn leaf<V: Simd8>(&mut self, simd: V, number: usize, until: f32) -> f32 {
        let SharedMesh { triangles, .. } = self.shared;
        if puts_off::<S, L>() {
            let met = self.along.cull.may_cross_line(simd, triangles.block(number), until);
            let own = lane_in(number, self.origin_prim.own_slot(Some(self.item)));
            self.along.until = min(self.along.until, self.shortlist.add(&met.without(own), number));
            if self.shortlist.is_long() {
                self.settle();
            }
            return self.along.until;
        }
        let mut may = self.along.screen_block::<S, V>(simd, triangles.block(number), until);
        while let Some(slot) = next_slot(&mut may, number) {
            let primitive = PrimitiveId { item: self.item, triangle: slot };
            let own = self.origin_prim.starts_on(primitive);
            let mut s = self.segment.cross_triangle(&triangles.get(slot as usize), own);
            if self.origin_prim.leaves_also(primitive, s) {
                s = self.segment.cross_triangle(&triangles.get(slot as usize), true);
            }
            self.consider(s, slot);
        }
        self.along.until
    }

    #[inline(always)]
    fn prefetch(&self, number: usize) {
        prefetch(self.shared.triangles.block(number));
    }
}

/// Lane of a slot, if it is in a leaf.
#[inline(always)]
fn lane_in(leaf: usize, slot: u32) -> Option<usize> {
    (slot as usize / LEAF_SIZE == leaf).then_some(slot as usize % LEAF_SIZE)
}

/// Takes the next slot of a leaf from the lanes that `may` names by bits.
#[inline(always)]
pub(super) fn next_slot(may: &mut u32, leaf: usize) -> Option<u32> {
    let lane = may.trailing_zeros();
    *may &= may.wrapping_sub(1);
    (lane < LEAF_SIZE as u32).then_some((leaf * LEAF_SIZE) as u32 + lane)
}

/// Extent of a search along the chord of a segment.
struct Along {
    chord: Chord,
    /// The part of the chord that matters, or a little more.
    until: f32,
    cull: Cull,
}

impl Along {
    #[inline(always)]
    fn new(chord: Chord) -> Self {
        Self { chord, until: 1.0, cull: Cull::new(&chord) }
    }

    /// Lanes whose triangles the segment may cross, a bit each.
    #[inline(always)]
    fn screen_block<S: Segment, V: Simd8>(
        &self,
        simd: V,
        triangles: &<Triangle as Row>::Block,
        until: f32,
    ) -> u32 {
        if S::BENDS {
            self.cull.may_cross(simd, triangles, until)
        } else {
            self.cull.may_cross_line(simd, triangles, until).may
        }
    }

    /// Nothing beyond a `part` of the chord matters any more.
    #[inline(always)]
    fn end_at(&mut self, part: f64) {
        self.until = min(part as f32 * (1.0 + 4.0 * f32::EPSILON), self.until);
    }
}
