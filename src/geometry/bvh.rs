//! The bounding volume hierarchy: built by obvhs, walked here. The only file that names obvhs.
//!
//! The walk differs from obvhs's own in one point that curved rays need: a segment is searched along its chord as a
//! *thick* ray, every box widened by that segment's own sagitta. (Inflating the boxes at build time by the largest
//! sagitta allowed would make every short or straight segment pay for the longest one.) Boxes are narrowed to f32
//! outwards and the slab test is widened by its own rounding, so that the walk is conservative: what is hit in f64 is
//! never culled.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::faststack::FastStack;
use obvhs::{BvhBuildParams, fast_stack};

use super::Chord;

/// A hierarchy over boxes given by index.
pub struct Bvh {
    tree: Bvh2,
}

/// Slab distances are products of a rounded difference and a rounded reciprocal: 3 half ulps, doubled for safety.
const SLAB_ERROR: f32 = 6.0 * f32::EPSILON;
/// Directions below this are taken for it; its reciprocal is finite.
const SMALLEST_DIRECTION: f32 = 1e-30;

impl Bvh {
    /// Builds the hierarchy, on all threads. Boxes are (min, max), finite, and within f32's range.
    pub fn build(boxes: impl Iterator<Item = (DVec3, DVec3)>) -> Self {
        let boxes: Vec<Aabb> = boxes.map(|(min, max)| outwards(min, max)).collect();
        let tree = match boxes.is_empty() {
            true => Bvh2::default(),
            false => build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default()),
        };
        Self { tree }
    }

    /// Box index of each leaf slot.
    pub fn order(&self) -> &[u32] {
        &self.tree.primitive_indices
    }

    /// Bounds of everything, or `None` if there is nothing.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let root = self.tree.nodes.first()?.aabb();
        Some((root.min.as_dvec3(), root.max.as_dvec3()))
    }

    /// Heap memory, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Bvh2Node>() * self.tree.nodes.len() + size_of::<u32>() * self.tree.primitive_indices.len()
    }

    /// Calls `leaf` with the leaf slots whose boxes the thick ray around `chord` meets, roughly front to back.
    ///
    /// `leaf` gives the distance along the chord at which the search may end (infinity: no change).
    #[inline(always)]
    pub fn walk(&self, chord: &Chord, mut leaf: impl FnMut(usize) -> f64) {
        let along = chord.end - chord.start;
        let length = along.length();
        if self.tree.nodes.is_empty() || length == 0.0 {
            return;
        }
        let mut ray = ThickRay::new(chord, along / length, length);
        let mut visit = |node: &Bvh2Node, ray: &mut ThickRay| {
            for slot in node.first_index..node.first_index + node.prim_count {
                ray.shorten(leaf(slot as usize));
            }
        };
        let nodes = &self.tree.nodes[..];
        let root = &nodes[0];
        if ray.enters(root.aabb()) > ray.length {
            return;
        }
        if root.is_leaf() {
            return visit(root, &mut ray);
        }
        fast_stack!(u32, (96, 192), self.tree.max_depth, stack, {
            let mut pair = root.first_index as usize;
            loop {
                let (mut near, mut far) = (&nodes[pair], &nodes[pair + 1]);
                let (mut to_near, mut to_far) = (ray.enters(near.aabb()), ray.enters(far.aabb()));
                if to_far < to_near {
                    std::mem::swap(&mut near, &mut far);
                    std::mem::swap(&mut to_near, &mut to_far);
                }
                let mut next = None;
                if to_near <= ray.length {
                    match near.is_leaf() {
                        true => visit(near, &mut ray),
                        false => next = Some(near.first_index),
                    }
                }
                if to_far <= ray.length {
                    match (far.is_leaf(), next) {
                        (true, _) => visit(far, &mut ray),
                        (false, None) => next = Some(far.first_index),
                        (false, Some(_)) => stack.push(far.first_index),
                    }
                }
                match next.or_else(|| stack.pop()) {
                    Some(index) => pair = index as usize,
                    None => return,
                }
            }
        })
    }
}

/// The smallest f32 box that holds an f64 box.
fn outwards(min: DVec3, max: DVec3) -> Aabb {
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
    inverse: Vec3A,
    /// Start minus and plus the radius: widening every box is moving the start.
    start_minus: Vec3A,
    start_plus: Vec3A,
    length: f32,
}

impl ThickRay {
    #[inline(always)]
    fn new(chord: &Chord, direction: DVec3, length: f64) -> Self {
        let start = chord.start.as_vec3a();
        let rounding = f32::EPSILON * start.abs().max_element();
        let radius = Vec3A::splat(chord.sagitta as f32 * (1.0 + 4.0 * f32::EPSILON) + rounding);
        let direction = direction.as_vec3a();
        let tiny = direction.abs().cmplt(Vec3A::splat(SMALLEST_DIRECTION));
        let direction = Vec3A::select(tiny, Vec3A::splat(SMALLEST_DIRECTION), direction);
        Self {
            inverse: direction.recip(),
            start_minus: start - radius,
            start_plus: start + radius,
            length: length as f32 * (1.0 + SLAB_ERROR),
        }
    }

    /// Distance at which the thick ray enters a box, infinite if it misses.
    #[inline(always)]
    fn enters(&self, aabb: &Aabb) -> f32 {
        let towards = (aabb.min - self.start_plus) * self.inverse;
        let away = (aabb.max - self.start_minus) * self.inverse;
        let (low, high) = (towards.min(away), towards.max(away));
        let enter = low.max_element().max(0.0) * (1.0 - SLAB_ERROR);
        let leave = high.min_element() * (1.0 + SLAB_ERROR);
        if enter <= leave { enter } else { f32::INFINITY }
    }

    #[inline(always)]
    fn shorten(&mut self, distance: f64) {
        self.length = self.length.min(distance as f32 * (1.0 + SLAB_ERROR));
    }
}
