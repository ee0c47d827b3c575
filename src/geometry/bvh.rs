//! The bounding volume hierarchy: built by obvhs, walked here. The only file that names obvhs.
//!
//! The walk differs from obvhs's own in one point that curved rays need: a segment is searched along its chord as a
//! *thick* ray, every box widened by that segment's own sagitta. (Inflating the boxes at build time by the largest
//! sagitta allowed makes straight segments pay for the most curved one.) Boxes are narrowed to f32 outwards and the
//! slab test is widened by its own rounding, so that the walk is conservative: what is hit in f64 is never culled.
//!
//! Eight-wide quantised nodes (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs") measure twice as fast here as the binary hierarchy, on short arcs and on whole rays:
//! `cargo bench -- search`.

use glam::{DVec3, UVec2, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::{CwBvhNode, extract_byte64};
use obvhs::ploc::PlocBuilder;
use obvhs::{BvhBuildParams, fast_stack, traverse};
use rayon::prelude::*;

use super::Chord;

/// A hierarchy over boxes given by index.
pub struct Bvh {
    tree: CwBvh,
    depth: usize,
}

/// Directions below this are taken for it: the reciprocal times any coordinate is finite.
const SMALLEST_DIRECTION: f32 = 1e-18;
/// Slab distances are sums of two products of rounded factors: their error beside the larger term, with room to spare.
const SLAB_ERROR: f32 = 4.0 * f32::EPSILON;

/// Up to this many primitives are tested one after the other, without a walk. Measured on the paper's nine spheres.
const FEW: usize = 12;
/// Primitives of a leaf, at most: what a node of obvhs can count.
const MOST_IN_LEAF: u32 = 3;

impl Bvh {
    /// Builds the hierarchy over `count` boxes, on all threads. A box is (min, max), finite, and within f32's range.
    ///
    /// The steps are those of obvhs's `build_cwbvh`, but the boxes are gone before the last one, which needs most memory.
    pub fn build(count: usize, bounds: impl Fn(usize) -> (DVec3, DVec3) + Sync) -> Self {
        if count == 0 {
            return Self { tree: CwBvh::default(), depth: 1 };
        }
        let params = BvhBuildParams::medium_build();
        let boxes: Vec<Aabb> = (0..count).into_par_iter().map(|i| outwards(bounds(i))).collect();
        let indices = (0..count as u32).collect();
        let (distance, precision) = (params.ploc_search_distance, params.sort_precision);
        let mut binary = PlocBuilder::with_capacity(count).build(
            distance,
            &boxes,
            indices,
            precision,
            params.search_depth_threshold,
        );
        drop(boxes);
        ReinsertionOptimizer::default().run(&mut binary, params.reinsertion_batch_ratio, None);
        binary.parents = Vec::new();
        let mut tree = bvh2_to_cwbvh(&binary, MOST_IN_LEAF, true, false);
        tree.nodes.shrink_to_fit();
        let depth = depth(&tree);
        Self { tree, depth }
    }

    /// Box index of each leaf slot.
    pub fn order(&self) -> &[u32] {
        &self.tree.primitive_indices
    }

    /// Bounds of everything, or `None` if there is nothing.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let all = &self.tree.total_aabb;
        (!self.tree.nodes.is_empty()).then(|| (all.min.as_dvec3(), all.max.as_dvec3()))
    }

    /// Heap memory, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<CwBvhNode>() * self.tree.nodes.len() + size_of::<u32>() * self.tree.primitive_indices.len()
    }

    /// Calls `leaf` with the leaf slots whose boxes the thick ray around `chord` meets, roughly front to back; where
    /// there are few, with all.
    ///
    /// `leaf` gives the distance along the chord at which the search may end (infinity: no change).
    #[inline(always)]
    pub fn walk(&self, chord: &Chord, mut leaf: impl FnMut(usize) -> f64) {
        let along = chord.end - chord.start;
        let length = along.length();
        if self.tree.nodes.is_empty() || length == 0.0 {
            return;
        }
        let tree = &self.tree;
        if tree.primitive_indices.len() <= FEW {
            return (0..tree.primitive_indices.len()).for_each(|slot| _ = leaf(slot));
        }
        let mut ray = ThickRay::new(chord, along / length, length);
        fast_stack!(UVec2, (32, 128), self.depth, stack, {
            let mut state = Walk {
                stack,
                current_group: UVec2::new(0, 0x8000_0000),
                primitive_group: UVec2::ZERO,
                oct_inv4: ray.octant,
                primitive_id: 0,
                hitmask: 0,
            };
            let mut node;
            traverse!(tree, node, state, ray.meets(node), {
                ray.shorten(leaf(state.primitive_id as usize));
            });
        })
    }
}

/// State of a walk, by the names that obvhs's `traverse` knows.
struct Walk<S> {
    stack: S,
    current_group: UVec2,
    primitive_group: UVec2,
    oct_inv4: u32,
    primitive_id: u32,
    hitmask: u32,
}

/// Levels of a hierarchy: the most that a walk has to remember.
fn depth(tree: &CwBvh) -> usize {
    let mut deepest = 1;
    let mut pending = vec![(0, 1)];
    while let Some((index, level)) = pending.pop() {
        let Some(node) = tree.nodes.get(index) else { continue };
        deepest = deepest.max(level);
        let inner = (0..8).filter(|&child| !node.is_child_empty(child) && !node.is_leaf(child));
        pending.extend(inner.map(|child| (node.child_node_index(child) as usize, level + 1)));
    }
    deepest
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

/// A chord in f32 with room for its sagitta and for the rounding of its start.
struct ThickRay {
    start: Vec3A,
    inverse: Vec3A,
    /// Distance along the ray by which each pair of slabs is widened.
    wider: Vec3A,
    length: f32,
    /// Signs of the direction, as obvhs orders children.
    octant: u32,
}

impl ThickRay {
    #[inline(always)]
    fn new(chord: &Chord, direction: DVec3, length: f64) -> Self {
        let start = chord.start.as_vec3a();
        let rounding = f32::EPSILON * start.abs().max_element();
        let radius = chord.sagitta as f32 * (1.0 + SLAB_ERROR) + rounding;
        let direction = direction.as_vec3a();
        let tiny = direction.abs().cmplt(Vec3A::splat(SMALLEST_DIRECTION));
        let inverse = Vec3A::select(tiny, Vec3A::splat(SMALLEST_DIRECTION), direction).recip();
        let sign = |component: f32, bits: u32| if component < 0.0 { 0 } else { bits };
        Self {
            start,
            inverse,
            wider: radius * inverse.abs(),
            length: length as f32 * (1.0 + SLAB_ERROR),
            octant: sign(inverse.x, 0x0404_0404)
                | sign(inverse.y, 0x0202_0202)
                | sign(inverse.z, 0x0101_0101),
        }
    }

    /// Mask of the children of `node` that the thick ray meets, as obvhs encodes it.
    #[inline(always)]
    fn meets(&self, node: &CwBvhNode) -> u32 {
        // Planes are at offset + q scale, q in 0..=255: the node's grid is transformed, not each box.
        let scale = node.compute_extent() * self.inverse;
        let offset = (Vec3A::from(node.p) - self.start) * self.inverse;
        let wider = self.wider + SLAB_ERROR * (offset.abs() + 255.0 * scale.abs());
        let (to_near, to_far) = (offset - wider, offset + wider);
        let (mut enter, mut leave) = ([0.0; 8], [self.length; 8]);
        let slabs = [
            (&node.child_min_x, &node.child_max_x),
            (&node.child_min_y, &node.child_max_y),
            (&node.child_min_z, &node.child_max_z),
        ];
        for (axis, (low, high)) in slabs.into_iter().enumerate() {
            let (near, far) = if self.inverse[axis] < 0.0 { (high, low) } else { (low, high) };
            let (scale, to_near, to_far) = (scale[axis], to_near[axis], to_far[axis]);
            for child in 0..8 {
                let (near, far) =
                    (f32::from(near[child]) * scale + to_near, f32::from(far[child]) * scale + to_far);
                enter[child] = if near > enter[child] { near } else { enter[child] };
                leave[child] = if far < leave[child] { far } else { leave[child] };
            }
        }
        let mut met = 0u32;
        for child in 0..8 {
            met |= u32::from(enter[child] <= leave[child]) << child;
        }
        let (child_bits, bit_index) = node.get_child_and_index_bits(self.octant);
        let mut mask = 0;
        while met != 0 {
            let child = met.trailing_zeros() as usize;
            met &= met - 1;
            mask |= extract_byte64(child_bits, child) << extract_byte64(bit_index, child);
        }
        mask
    }

    #[inline(always)]
    fn shorten(&mut self, distance: f64) {
        self.length = self.length.min(distance as f32 * (1.0 + SLAB_ERROR));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `count` boxes in a row along x, of half-width `half`.
    fn row(count: usize, half: f64) -> Bvh {
        let place = |i: usize| DVec3::new(3.0 * i as f64, 0.0, 0.0);
        Bvh::build(count, |i| (place(i) - half, place(i) + half))
    }

    #[test]
    fn hierarchies_of_any_size_find_every_box_along_a_line_and_no_other() {
        for count in (0..40).chain([100, 1000]) {
            let bvh = row(count, 1.0);
            assert_eq!(bvh.bounds().is_some(), count > 0);
            let along =
                Chord { start: DVec3::new(-5.0, 0.1, 0.2), end: DVec3::new(1e4, 0.1, 0.2), sagitta: 0.0 };
            let mut met: Vec<u32> = Vec::new();
            bvh.walk(&along, |slot| {
                met.push(bvh.order()[slot]);
                f64::INFINITY
            });
            met.sort_unstable();
            assert_eq!(met, (0..count as u32).collect::<Vec<_>>(), "{count} boxes");
            let beside =
                Chord { start: DVec3::new(-5.0, 1.1, 0.2), end: DVec3::new(1e4, 1.1, 0.2), sagitta: 0.05 };
            if count > FEW {
                bvh.walk(&beside, |slot| panic!("{count} boxes: slot {slot} is not on the way"));
            }
        }
    }

    #[test]
    fn a_thick_ray_meets_what_its_sagitta_reaches() {
        let bvh = row(9, 1.0);
        let mut met = 0;
        let beside =
            Chord { start: DVec3::new(-5.0, 1.1, 0.2), end: DVec3::new(100.0, 1.1, 0.2), sagitta: 0.11 };
        bvh.walk(&beside, |_| {
            met += 1;
            f64::INFINITY
        });
        assert_eq!(met, 9);
    }

    #[test]
    fn boxes_in_one_place_are_all_found() {
        let bvh = Bvh::build(5000, |_| (DVec3::splat(-1.0), DVec3::splat(1.0)));
        let mut met = 0;
        bvh.walk(&Chord { start: DVec3::splat(-3.0), end: DVec3::splat(3.0), sagitta: 0.0 }, |_| {
            met += 1;
            f64::INFINITY
        });
        assert_eq!(met, 5000);
    }

    /// Whether the chord, thickened, meets a box: the slab test in f64.
    fn meets(chord: &Chord, (min, max): (DVec3, DVec3)) -> bool {
        let along = chord.end - chord.start;
        let (a, b) =
            ((min - chord.sagitta - chord.start) / along, (max + chord.sagitta - chord.start) / along);
        a.min(b).max_element().max(0.0) <= a.max(b).min_element().min(1.0)
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
            let bvh = Bvh::build(boxes.len(), |i| boxes[i]);
            for i in 0..2000 {
                let chord = Chord {
                    start: point(1.5),
                    end: point(1.5),
                    sagitta: point(0.5).x.abs() * (i % 3) as f64,
                };
                let mut met = vec![false; count];
                bvh.walk(&chord, |slot| {
                    met[bvh.order()[slot] as usize] = true;
                    f64::INFINITY
                });
                for (index, &bounds) in boxes.iter().enumerate() {
                    assert!(met[index] || !meets(&chord, bounds), "{chord:?} misses {bounds:?} of {count}");
                }
            }
        }
    }
}
