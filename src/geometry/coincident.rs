//! Surfaces that lie upon each other: objects doubled by accident, glass that stands on a floor.
//!
//! Rounding must not decide which of them a ray meets first, nor whether it meets the others at all. A segment that
//! leaves a primitive leaves all that coincides with it at its start ([`Geometry::past_start`]); what a ray meets
//! together with something is asked for ([`Geometry::upon`]).

use glam::DVec3;

use super::bvh::{LEAF_SIZE, Visitor};
use super::cull::Cull;
use super::distance::Reach;
use super::nearest::{Leaving, next_slot};
use super::scene::Item;
use super::{Geometry, Hit, Line, PrimitiveId, Segment, SharedMesh, Sphere, SupportingSurface};
use crate::math::simd8::{Simd8, Simd8Work, with_simd8};

/// Height of a point over a surface that it lies on, relative to the coordinates that the surface is made of: of
/// triangles they are in f32.
const ON: f64 = 1e-12;
const ON_TRIANGLES: f64 = 2.5e-7;
/// Square of the sine of the angle between surfaces that lie upon each other.
const PARALLEL: f64 = 1e-6;
/// Distance from its start, relative to the coordinates there, within which a segment may meet what it leaves.
const NEAR_START: f64 = 1e-4;
/// Half the length of a line that meets what coincides where it is, relative to the height that is allowed.
const PROBE: f64 = 8.0;

impl Geometry {
    /// Largest height over a surface at which a point counts as on it.
    fn slack(&self, primitive: PrimitiveId, support: &SupportingSurface, point: DVec3) -> f64 {
        let largest = |v: DVec3| v.abs().max_element();
        let reach =
            largest(point - self.origin).max(largest(support.anchor - self.origin)).max(support.radius);
        match self.item(primitive.item) {
            Item::Triangle(_) | Item::Instance(_) => ON_TRIANGLES * reach,
            // The origin is taken off and added.
            Item::Sphere(_) | Item::Disk(_) => ON * reach.max(largest(self.origin)),
        }
    }

    /// True if two primitives coincide at a point of the first, provided that both reach there.
    fn coincide(&self, one: PrimitiveId, other: PrimitiveId, point: DVec3) -> bool {
        let [support, beside] = [one, other].map(|primitive| self.support(primitive));
        let (normal, (height, beside_normal)) = (support.height(point).1, beside.height(point));
        let slack = self.slack(one, &support, point).min(self.slack(other, &beside, point));
        height.abs() <= slack && normal.cross(beside_normal).length_squared() <= PARALLEL
    }

    /// True if a crossing of a segment may be its start: the primitive that it leaves lies there, and others may.
    #[inline(always)]
    pub(super) fn is_near_start(&self, start: DVec3, point: DVec3) -> bool {
        let near =
            NEAR_START * (start - self.origin).abs().max_element().max(NEAR_START * self.typical_extent);
        point.distance_squared(start) <= near * near
    }

    /// The first hit of a segment that leaves a primitive, given the first that there is if all others are met, which
    /// is near its start.
    #[cold]
    pub(super) fn past_start<S: Segment>(
        &self,
        segment: &S,
        origin_prim: PrimitiveId,
        first: Hit,
    ) -> Option<Hit> {
        let leaving = PastStart { geometry: self, segment, origin_prim };
        if leaving.leaves_also(first.primitive, first.s) { self.first(segment, leaving) } else { Some(first) }
    }

    /// Primitives near each sphere; empty if finding them would be much work.
    pub(super) fn near_spheres(&self) -> Vec<Vec<PrimitiveId>> {
        /// Most pairs of a sphere and a primitive that are looked at.
        const PAIRS: usize = 1 << 18;
        let members: Vec<(u32, Item)> = self.members().collect();
        if !self.placed.is_empty() || self.spheres.len().saturating_mul(members.len()) > PAIRS {
            return Vec::new();
        }
        let (low, high) = self.bvh.bounds().unwrap_or_default();
        let largest = low.abs().max(high.abs()).max(self.origin.abs()).max_element();
        let is_near = |index: usize, slot: u32, item: Item| {
            let Sphere { center, radius } = self.spheres[index].0;
            let on = if let Item::Triangle(_) = item { ON_TRIANGLES } else { ON };
            let (Reach { nearest, farthest }, room) = (self.reach(slot, center), 4.0 * PROBE * on * largest);
            (nearest - room..=farthest + room).contains(&radius)
        };
        let near = |index: usize| {
            let others =
                members.iter().filter(|(_, item)| !matches!(item, Item::Sphere(i) if *i as usize == index));
            let near = others.filter(|(slot, item)| is_near(index, *slot, *item));
            near.map(|&(item, _)| PrimitiveId { item, triangle: 0 }).collect()
        };
        (0..self.spheres.len()).map(near).collect()
    }

    /// All other primitives that lie upon `primitive` at one of its points, in the order in which they were given.
    pub fn upon(&self, primitive: PrimitiveId, point: DVec3) -> Vec<PrimitiveId> {
        let (owner, own) = self.owner(primitive);
        let mut found = owner.own_upon(own, point);
        found.iter_mut().for_each(|other| *other = other.on(primitive.side()));
        found
    }

    fn own_upon(&self, primitive: PrimitiveId, point: DVec3) -> Vec<PrimitiveId> {
        if let Item::Sphere(i) = self.item(primitive.item)
            && let Some(near) = self.near_spheres.get(i as usize)
            && !near.iter().any(|&other| self.coincide(primitive, other, point))
        {
            return Vec::new();
        }
        let support = self.support(primitive);
        let way = PROBE * self.slack(primitive, &support, point) * support.height(point).1;
        let local = point - self.origin;
        let line = Line { p0: local - way, p2: local + way };
        let mut found = with_simd8(Upon::new(self, line, primitive));
        found.retain(|&other| self.coincide(primitive, other, point));
        found.sort_by_key(|&other| self.given(other));
        found
    }
}

/// A segment that leaves all that coincides with a primitive at its start.
struct PastStart<'a, S> {
    geometry: &'a Geometry,
    /// World coordinates.
    segment: &'a S,
    origin_prim: PrimitiveId,
}

impl<S> Clone for PastStart<'_, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S> Copy for PastStart<'_, S> {}

impl<S: Segment> Leaving for PastStart<'_, S> {
    const IS_ONE: bool = false;

    fn own_slot(&self, _: Option<u32>) -> u32 {
        u32::MAX
    }

    fn starts_on(&self, primitive: PrimitiveId) -> bool {
        self.origin_prim == primitive
    }

    fn leaves_also(&self, primitive: PrimitiveId, s: f64) -> bool {
        let Self { geometry, segment, origin_prim } = *self;
        let start = segment.chord().start;
        origin_prim != primitive
            && s < f64::INFINITY
            && geometry.is_near_start(start, segment.point(s))
            && geometry.coincide(origin_prim, primitive, start)
    }
}

/// All that a short line meets beside a primitive.
struct Upon<'a> {
    geometry: &'a Geometry,
    /// Relative to the origin of the geometry.
    line: Line,
    cull: Cull,
    primitive: PrimitiveId,
    found: Vec<PrimitiveId>,
}

impl<'a> Upon<'a> {
    fn new(geometry: &'a Geometry, line: Line, primitive: PrimitiveId) -> Self {
        Self { geometry, line, cull: Cull::new(&line.chord()), primitive, found: Vec::new() }
    }

    #[inline(always)]
    fn add(&mut self, s: f64, met: PrimitiveId) {
        if s < f64::INFINITY && met != self.primitive {
            self.found.push(met);
        }
    }
}

impl Simd8Work for Upon<'_> {
    type Output = Vec<PrimitiveId>;

    #[inline(always)]
    fn run<V: Simd8>(mut self, simd: V) -> Vec<PrimitiveId> {
        self.geometry.bvh.walk(simd, &self.line.chord(), 1.0, &mut self);
        self.found
    }
}

impl Visitor for Upon<'_> {
    #[inline(always)]
    fn leaf<V: Simd8>(&mut self, simd: V, number: usize, _: f32) -> f32 {
        let Self { geometry, line, .. } = *self;
        if !geometry.singles.is_empty() {
            let mut may = self.cull.may_cross_line(simd, geometry.triangles.block(number), 1.0).may;
            while let Some(slot) = next_slot(&mut may, number) {
                let s = line.cross_triangle(&geometry.triangle(slot), false);
                self.add(s, PrimitiveId { item: slot, triangle: 0 });
            }
        }
        if !geometry.others.is_empty() {
            for slot in (number * LEAF_SIZE) as u32..((number + 1) * LEAF_SIZE) as u32 {
                if (geometry.bvh.order()[slot as usize] as usize) < geometry.others.len() {
                    self.other(slot);
                }
            }
        }
        1.0
    }

    fn prefetch(&self, _: usize) {}
}

impl Upon<'_> {
    /// Adds what is no triangle if the line meets it.
    fn other(&mut self, slot: u32) {
        let Self { geometry, line, .. } = *self;
        let met = PrimitiveId { item: slot, triangle: 0 };
        match geometry.item(slot) {
            Item::Sphere(i) => self.add(line.cross_sphere(&geometry.spheres[i as usize].0, false), met),
            Item::Disk(i) => self.add(line.cross_disk(&geometry.disks[i as usize].0, false), met),
            Item::Instance(i) => {
                let placed = &geometry.placed[i as usize];
                if let Some(shared) = &geometry.shared[placed.mesh as usize] {
                    let line = line.transformed(&placed.to_object);
                    let chord = line.chord();
                    let inside =
                        UponTriangles { shared, line, cull: Cull::new(&chord), item: slot, upon: self };
                    with_simd8(inside);
                }
            }
            Item::Triangle(_) => {}
        }
    }
}

/// All triangles of a placed mesh that a short line meets.
struct UponTriangles<'a, 'g> {
    shared: &'a SharedMesh,
    /// In the mesh's own coordinates.
    line: Line,
    cull: Cull,
    item: u32,
    upon: &'a mut Upon<'g>,
}

impl Simd8Work for UponTriangles<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd8>(mut self, simd: V) {
        self.shared.bvh.walk(simd, &self.line.chord(), 1.0, &mut self);
    }
}

impl Visitor for UponTriangles<'_, '_> {
    #[inline(always)]
    fn leaf<V: Simd8>(&mut self, simd: V, number: usize, _: f32) -> f32 {
        let triangles = &self.shared.triangles;
        let mut may = self.cull.may_cross_line(simd, triangles.block(number), 1.0).may;
        while let Some(slot) = next_slot(&mut may, number) {
            let s = self.line.cross_triangle(&triangles.get(slot as usize), false);
            self.upon.add(s, PrimitiveId { item: self.item, triangle: slot });
        }
        1.0
    }

    fn prefetch(&self, _: usize) {}
}
