//! A chord in f32 with room for its bow, against the boxes of a node.

use glam::Vec3A;

use super::super::Chord;
use super::super::cull::{max, min};
use super::node::{BvhNode, CELLS, WIDTH};

/// Components of the chord below this, beside the largest, are taken for it: the reciprocal times any coordinate is
/// finite.
const SMALLEST_COMPONENT: f32 = 1e-18;
/// Slab distances are sums of two products of rounded factors: their error beside the larger term, with room to spare.
const SLAB_ERROR: f32 = 4.0 * f32::EPSILON;

/// A chord with room for its bow and for the rounding of its start; distances are parts of the chord.
#[derive(Clone, Copy, Default)]
pub struct ThickRay {
    start: Vec3A,
    inverse: Vec3A,
    /// By how much slabs are nearer, and farther, for some part of the segment.
    nearer: Vec3A,
    farther: Vec3A,
    until: f32,
}

impl ThickRay {
    /// The ray along `chord`.
    #[inline(always)]
    pub fn new(chord: &Chord) -> Self {
        let (start, bow) = (chord.start.as_vec3a(), chord.bow.as_vec3a());
        let along = (chord.end - chord.start).as_vec3a();
        let rounding = f32::EPSILON * start.abs().max_element() + SLAB_ERROR * bow.abs();
        let smallest = Vec3A::splat(SMALLEST_COMPONENT * along.abs().max_element());
        let inverse = Vec3A::select(along.abs().cmplt(smallest), smallest, along).recip();
        let (shift, rounding) = (bow * inverse, rounding * inverse.abs());
        Self {
            start,
            inverse,
            nearer: shift.max(Vec3A::ZERO) + rounding,
            farther: (-shift).max(Vec3A::ZERO) + rounding,
            until: f32::INFINITY,
        }
    }

    /// Children of `node` that the ray meets, one byte a child, and the parts of the chord at which it enters them.
    #[inline(always)]
    pub fn meets(&self, node: &BvhNode) -> (u64, [f32; WIDTH]) {
        // The node's grid is transformed, not each box.
        let scale = node.scale() * self.inverse;
        let offset = (node.origin() - self.start) * self.inverse;
        let rounding = SLAB_ERROR * (offset.abs() + CELLS * scale.abs());
        let (to_near, to_far) = (offset - self.nearer - rounding, offset + self.farther + rounding);
        let planes = |axis: usize| {
            let (low, high) = (&node.low[axis], &node.high[axis]);
            if self.inverse[axis] < 0.0 { (high, low) } else { (low, high) }
        };
        let [(near_x, far_x), (near_y, far_y), (near_z, far_z)] = [planes(0), planes(1), planes(2)];
        let (mut enter, mut met) = ([0.0; WIDTH], [0u8; WIDTH]);
        for child in 0..WIDTH {
            let near =
                |planes: &[u8; WIDTH], axis: usize| f32::from(planes[child]) * scale[axis] + to_near[axis];
            let far =
                |planes: &[u8; WIDTH], axis: usize| f32::from(planes[child]) * scale[axis] + to_far[axis];
            let last = min(min(far(far_x, 0), far(far_y, 1)), min(far(far_z, 2), self.until));
            enter[child] = max(max(near(near_x, 0), near(near_y, 1)), max(near(near_z, 2), 0.0));
            met[child] = u8::from(enter[child] <= last);
        }
        (u64::from_le_bytes(met) & node.mask(), enter)
    }

    /// True if a node entered at this part of the chord must be searched.
    #[inline(always)]
    pub fn reaches(&self, part: f32) -> bool {
        part <= self.until
    }

    /// Ends the search at a part of the chord.
    #[inline(always)]
    pub fn shorten(&mut self, part: f64) {
        self.until = self.until.min(part as f32 * (1.0 + SLAB_ERROR));
    }
}
