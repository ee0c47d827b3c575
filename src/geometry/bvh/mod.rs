//! The bounding volume hierarchy: built by obvhs, made eight children wide and walked here.
//!
//! The walk differs from obvhs's own in what curved rays need: a segment is searched along its chord as a *thick* ray,
//! every box widened by that segment's own bow. (Inflating the boxes at build time by the largest sagitta allowed makes
//! straight segments pay for the most curved one.) Boxes are narrowed to f32 outwards and the slab test is widened by
//! its own rounding, so that the walk is conservative: what is hit in f64 is never culled.
//!
//! And in what wide vectors want: a leaf is a block of primitives that are tested side by side, children are visited by
//! distance, and what lies beyond the nearest hit is dropped when its turn comes. Measured against obvhs's own
//! hierarchies by `cargo bench -- search`.

mod collapse;
mod node;
mod thick_ray;

use std::ops::Range;

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::faststack::FastStack;
use obvhs::ploc::PlocBuilder;
use obvhs::{BvhBuildParams, fast_stack};
use rayon::prelude::*;

use self::collapse::Wide;
use self::node::{BvhNode, LEAF, WIDTH};
pub use self::node::{EMPTY, LEAF_SIZE};
use self::thick_ray::ThickRay;
use super::Chord;
use crate::math::prefetch::prefetch;
use crate::math::simd8::Simd8;

/// Visitor of the leaves that a traversal comes to. (A closure cannot be forced inline, and only what is inlined gets
/// the wide vectors.)
pub trait Visitor {
    /// Looks at a leaf, `until` a part of the chord: that at which the search may end, not less than it is.
    fn leaf<V: Simd8>(&mut self, simd: V, number: usize, until: f32) -> f32;

    /// Asks for the memory of a leaf.
    fn prefetch(&self, number: usize);
}

/// A hierarchy over boxes given by index.
pub struct Bvh {
    /// None where there are few boxes.
    nodes: Vec<BvhNode>,
    order: Vec<u32>,
    len: usize,
    bounds: Aabb,
    /// The most that a walk has to remember.
    pending: usize,
}

/// Up to this many boxes are not worth a walk. Measured on the paper's nine spheres.
const FEW: usize = 16;
/// Most boxes of which ties may take time in proportion to the square of their number.
const MANY: usize = 1 << 12;

impl Bvh {
    /// Builds the hierarchy over `count` boxes, on all threads. A box is (min, max), finite, and within f32's range. Those
    /// that are `alone` hold much, and have a leaf each.
    pub fn build(count: usize, alone: Range<usize>, bounds: impl Fn(usize) -> (DVec3, DVec3) + Sync) -> Self {
        let mut boxes: Vec<Aabb> = (0..count).into_par_iter().map(|i| outwards(bounds(i))).collect();
        let indices: Vec<u32> = (0..count as u32).collect();
        let whole = boxes.iter().fold(Aabb::empty(), |all, next| all.union(next));
        if count <= if alone.is_empty() { FEW } else { 1 } {
            let mut order = indices;
            order.resize(count.next_multiple_of(LEAF_SIZE), EMPTY);
            return Self { nodes: Vec::new(), order, len: count, bounds: whole, pending: 1 };
        }
        if count > MANY {
            break_ties(&mut boxes);
        }
        let params = BvhBuildParams::medium_build();
        let (distance, precision) = (params.ploc_search_distance, params.sort_precision);
        let mut binary = PlocBuilder::with_capacity(count).build(
            distance,
            &boxes,
            indices,
            precision,
            params.search_depth_threshold,
        );
        drop(boxes);
        if count > MANY {
            let Bvh2 { nodes, primitive_indices, .. } = &mut binary;
            nodes.par_iter_mut().filter(|node| node.is_leaf()).for_each(|node| {
                node.set_aabb(outwards(bounds(primitive_indices[node.first_index as usize] as usize)));
            });
            binary.refit_all();
        }
        ReinsertionOptimizer::default().run(&mut binary, params.reinsertion_batch_ratio, None);
        binary.parents = Vec::new();
        let Wide { nodes, order, depth } = Wide::collapse(&binary, |index| alone.contains(&(index as usize)));
        Self { nodes, order, len: count, bounds: whole, pending: depth * (WIDTH - 1) }
    }

    /// Box index of each leaf slot, or [`EMPTY`]; leaf after leaf.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Number of boxes.
    pub fn len(&self) -> usize {
        self.len
    }

    /// The most that a walk has to remember.
    pub fn pending(&self) -> usize {
        self.pending
    }

    /// Slots that hold something, with their box index.
    pub fn filled(&self) -> impl Iterator<Item = (u32, u32)> {
        (0..).zip(self.order.iter().copied()).filter(|&(_, index)| index != EMPTY)
    }

    /// Bounds of everything, or `None` if there is nothing.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        (!self.order.is_empty()).then(|| (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3()))
    }

    /// Heap memory, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.order[..])
    }

    /// Shows `visitor` the leaves whose boxes the thick ray around `chord` meets `until` a part of it, roughly front to
    /// back; where there are few boxes, all.
    #[inline(always)]
    pub fn walk<V: Simd8>(&self, simd: V, chord: &Chord, until: f32, visitor: &mut impl Visitor) {
        fast_stack!(u64, (64, 256), self.pending, stack, {
            let mut walk = Walk::new(stack);
            walk.start(simd, self, chord, until, visitor);
            while walk.is_on {
                walk.step(simd, self, visitor);
            }
        })
    }
}

/// Widens boxes by different parts of themselves, while they are joined to a tree.
///
/// The builder joins boxes that are each other's best partner; of equal or nested ones (copies of a triangle, strips
/// and fans of faces) each has the same favourite, and it would join one pair a round.
fn break_ties(boxes: &mut [Aabb]) {
    /// Part of its size that a box grows by at most, and of its coordinates, as far as they resolve.
    const MOST: f32 = 1e-3;
    const RESOLVED: f32 = 2e-6;
    /// A sequence in three dimensions whose neighbours differ much (Roberts 2018), as parts of 2³².
    const STEPS: [u32; 3] = [0xd1b5_4a33, 0xabc9_8388, 0x8cb9_2ba7];
    boxes.par_iter_mut().enumerate().for_each(|(index, grown)| {
        let parts = STEPS.map(|step| (index as u32).wrapping_mul(step) as f32 / u32::MAX as f32);
        let size = (grown.max - grown.min).max_element() * MOST;
        grown.max += Vec3A::from(parts) * size.max(grown.max.abs().max_element() * RESOLVED);
    });
}

/// A walk under way: the thick ray, and what it has still to visit.
pub struct Walk<S> {
    ray: ThickRay,
    stack: S,
    next: StackEntry,
    /// True while there is more to visit.
    pub is_on: bool,
}

impl<S: FastStack<u64>> Walk<S> {
    /// A walk that is over, with room for others.
    #[inline(always)]
    pub fn new(stack: S) -> Self {
        Self { ray: ThickRay::default(), stack, next: StackEntry::ROOT, is_on: false }
    }

    /// Starts along `chord`, `until` a part of it.
    #[inline(always)]
    pub fn start<V: Simd8>(
        &mut self,
        simd: V,
        bvh: &Bvh,
        chord: &Chord,
        until: f32,
        visitor: &mut impl Visitor,
    ) {
        if bvh.nodes.is_empty() {
            for number in 0..bvh.order.len() / LEAF_SIZE {
                visitor.leaf(simd, number, until);
            }
        } else if chord.end != chord.start {
            self.ray = ThickRay::new(chord);
            self.ray.shorten(until);
            (self.next, self.is_on) = (StackEntry::ROOT, true);
        }
    }

    /// Asks for the memory of the next visit.
    #[inline(always)]
    pub fn prefetch(&self, bvh: &Bvh, visitor: &impl Visitor) {
        let number = self.next.number();
        if number & LEAF != 0 {
            visitor.prefetch((number & !LEAF) as usize);
        } else {
            prefetch(&bvh.nodes[number as usize]);
        }
    }

    /// Visits the next node or leaf.
    #[inline(always)]
    pub fn step<V: Simd8>(&mut self, simd: V, bvh: &Bvh, visitor: &mut impl Visitor) {
        let number = self.next.number();
        if number & LEAF != 0 {
            let leaf = (number & !LEAF) as usize;
            self.ray.shorten(visitor.leaf(simd, leaf, self.ray.until()));
        } else {
            let node = &bvh.nodes[number as usize];
            let (mut met, enter) = self.ray.meets(simd, node);
            if met != 0 {
                let mut nearest = StackEntry::pull(&mut met, &enter, node);
                while met != 0 {
                    let other = StackEntry::pull(&mut met, &enter, node);
                    self.stack.push(nearest.max(other).0);
                    nearest = nearest.min(other);
                }
                self.next = nearest;
                return;
            }
        }
        while let Some(entry) = self.stack.pop() {
            self.next = StackEntry(entry);
            if self.ray.reaches(self.next.part()) {
                return;
            }
        }
        self.is_on = false;
    }
}

/// A node or leaf to be visited, and the part of the chord at which it is entered: that above the number, so that
/// entries compare by it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct StackEntry(u64);

impl StackEntry {
    const ROOT: StackEntry = StackEntry(0);

    /// The next child of `node` that `met` names by bits.
    #[inline(always)]
    fn pull(met: &mut u32, enter: &[f32; WIDTH], node: &BvhNode) -> Self {
        let child = met.trailing_zeros() as usize % WIDTH;
        *met &= *met - 1;
        // Parts are not negative: they are ordered as their bits are.
        Self(u64::from(enter[child].to_bits()) << 32 | u64::from(node.children[child]))
    }

    #[inline(always)]
    fn number(self) -> u32 {
        self.0 as u32
    }

    #[inline(always)]
    fn part(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

/// The smallest f32 box that holds an f64 box.
fn outwards((min, max): (DVec3, DVec3)) -> Aabb {
    let down = |v: f64| {
        let narrow = v as f32;
        if f64::from(narrow) > v { narrow.next_down() } else { narrow }
    };
    let up = |v: f64| {
        let narrow = v as f32;
        if f64::from(narrow) < v { narrow.next_up() } else { narrow }
    };
    Aabb::new(Vec3A::new(down(min.x), down(min.y), down(min.z)), Vec3A::new(up(max.x), up(max.y), up(max.z)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::simd8::{LaneByLane, Simd8Work, with_simd8};

    /// `count` boxes in a row along x, of half-width `half`.
    fn row(count: usize, half: f64) -> Bvh {
        let place = |i: usize| DVec3::new(3.0 * i as f64, 0.0, 0.0);
        Bvh::build(count, 0..0, |i| (place(i) - half, place(i) + half))
    }

    /// Notes what is in the leaves that it is shown.
    struct Met<'a> {
        bvh: &'a Bvh,
        boxes: Vec<u32>,
    }

    impl Visitor for Met<'_> {
        fn leaf<V: Simd8>(&mut self, _: V, number: usize, _: f32) -> f32 {
            let slots = &self.bvh.order()[number * LEAF_SIZE..(number + 1) * LEAF_SIZE];
            self.boxes.extend(slots.iter().filter(|&&index| index != EMPTY));
            f32::INFINITY
        }

        fn prefetch(&self, _: usize) {}
    }

    /// A walk along a chord.
    struct WalkAlong<'a>(&'a Bvh, &'a Chord);

    impl Simd8Work for WalkAlong<'_> {
        type Output = Vec<u32>;

        fn run<V: Simd8>(self, simd: V) -> Vec<u32> {
            let Self(bvh, chord) = self;
            let mut met = Met { bvh, boxes: Vec::new() };
            bvh.walk(simd, chord, 1.0, &mut met);
            met.boxes.sort_unstable();
            met.boxes
        }
    }

    /// Boxes that walks along `chord` are shown, with the widest vectors and with plain lanes, sorted by index.
    fn met(bvh: &Bvh, chord: &Chord) -> Vec<u32> {
        let (mut met, plain) = (with_simd8(WalkAlong(bvh, chord)), WalkAlong(bvh, chord).run(LaneByLane));
        met.retain(|index| plain.binary_search(index).is_ok());
        met
    }

    #[test]
    fn hierarchies_of_any_size_find_every_box_along_a_line_and_no_other() {
        for count in (0..40).chain([100, 1000]) {
            let bvh = row(count, 1.0);
            assert_eq!(bvh.bounds().is_some(), count > 0);
            assert!(bvh.order().chunks(LEAF_SIZE).all(|leaf| leaf[0] != EMPTY), "{count} boxes");
            let along =
                Chord { start: DVec3::new(-5.0, 0.1, 0.2), end: DVec3::new(1e4, 0.1, 0.2), bow: DVec3::ZERO };
            assert_eq!(met(&bvh, &along), (0..count as u32).collect::<Vec<_>>(), "{count} boxes");
            let beside = Chord {
                start: DVec3::new(-5.0, 1.1, 0.2),
                end: DVec3::new(1e4, 1.1, 0.2),
                bow: DVec3::new(0.0, -0.05, 0.0),
            };
            assert!(count <= FEW || met(&bvh, &beside).is_empty(), "{count} boxes: some are not on the way");
        }
    }

    #[test]
    fn what_is_alone_has_a_leaf_of_its_own() {
        for count in [2, 9, 100] {
            let place = |i: usize| DVec3::new(3.0 * i as f64, 0.0, 0.0);
            let bvh = Bvh::build(count, 1..count / 2 + 1, |i| (place(i) - 1.0, place(i) + 1.0));
            let is_alone = |&index: &u32| (1..count / 2 + 1).contains(&(index as usize));
            for leaf in bvh.order().chunks(LEAF_SIZE) {
                assert!(leaf[1] == EMPTY || !leaf.iter().any(is_alone), "{count} boxes: {leaf:?}");
            }
            assert_eq!(bvh.filled().count(), count);
        }
    }

    #[test]
    fn a_thick_ray_meets_what_its_bow_reaches_on_that_side_only() {
        let bvh = row(99, 1.0);
        let beside = Chord {
            start: DVec3::new(-5.0, 1.1, 0.2),
            end: DVec3::new(1e3, 1.1, 0.2),
            bow: DVec3::new(0.0, -0.11, 0.0),
        };
        assert_eq!(met(&bvh, &beside).len(), 99);
        assert_eq!(met(&bvh, &Chord { bow: -beside.bow, ..beside }).len(), 0);
    }

    #[test]
    fn boxes_in_one_place_are_all_found() {
        let bvh = Bvh::build(5000, 0..0, |_| (DVec3::splat(-1.0), DVec3::splat(1.0)));
        let through = Chord { start: DVec3::splat(-3.0), end: DVec3::splat(3.0), bow: DVec3::ZERO };
        assert_eq!(met(&bvh, &through).len(), 5000);
    }

    /// True if the chord, moved by some part of its bow, meets a box: slab tests in f64.
    fn meets(chord: &Chord, (min, max): (DVec3, DVec3)) -> bool {
        let along = chord.end - chord.start;
        (0..=16).any(|part| {
            let start = chord.start + f64::from(part) / 16.0 * chord.bow;
            let (a, b) = ((min - start) / along, (max - start) / along);
            a.min(b).max_element().max(0.0) <= a.max(b).min_element().min(1.0)
        })
    }

    #[test]
    fn what_a_thick_ray_meets_in_f64_is_never_culled() {
        let mut state = 7u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut point = move |scale: f64| scale * (2.0 * DVec3::new(random(), random(), random()) - 1.0);
        for count in [1, 2, 5, 9, 30, 500] {
            let boxes: Vec<_> = (0..count)
                .map(|i| {
                    let (center, half) = (point(1.0), point(if i % 5 == 0 { 0.8 } else { 0.1 }).abs());
                    (center - half, center + half)
                })
                .collect();
            let bvh = Bvh::build(boxes.len(), 0..0, |i| boxes[i]);
            for i in 0..2000 {
                let chord = Chord { start: point(1.5), end: point(1.5), bow: f64::from(i % 3) * point(0.5) };
                let met = met(&bvh, &chord);
                for (index, &bounds) in (0..).zip(&boxes) {
                    assert!(
                        met.contains(&index) || !meets(&chord, bounds),
                        "{chord:?} misses {bounds:?} of {count}"
                    );
                }
            }
        }
    }
}
