//! A chord in f32 with room for its bow, against the boxes of a node.

use glam::Vec3A;

use super::super::Chord;
use super::super::cull::min;
use super::node::{BvhNode, WIDTH};
use crate::math::simd8::Simd8;

/// Components of the chord below this, beside the largest, are taken for it: the reciprocal times any coordinate is
/// finite.
const SMALLEST_COMPONENT: f32 = 1e-18;
/// Slab distances are sums of a product of rounded factors and a rounded offset: their error beside the offset and
/// beside themselves, with room to spare.
const SLAB_ERROR: f32 = 4.0 * f32::EPSILON;
/// Ends of slabs are moved away by their error, and by that of the beginnings that they are compared with.
const FARTHER: f32 = 1.0 + 4.0 * SLAB_ERROR;

/// A chord with room for its bow and for the rounding of its start; distances are parts of the chord.
#[derive(Clone, Copy, Default)]
pub struct ThickRay {
    /// By axis, 1 where lower planes are farther than upper ones.
    near: [usize; 3],
    /// Slabs begin, for some part of the segment, at plane × inverse + begin,
    inverse: [f32; 3],
    begin: [f32; 3],
    /// and end at plane × end_inverse + end.
    end_inverse: [f32; 3],
    end: [f32; 3],
    until: f32,
}

impl ThickRay {
    /// The ray along `chord`.
    #[inline(always)]
    pub fn new(chord: &Chord) -> Self {
        let (start, bow) = (chord.start.as_vec3a(), chord.bow.as_vec3a());
        let along = (chord.end - chord.start).as_vec3a();
        let rounding = f32::EPSILON * start.abs().max_element() + SLAB_ERROR * (start.abs() + bow.abs());
        let smallest = Vec3A::splat(SMALLEST_COMPONENT * along.abs().max_element());
        let inverse = Vec3A::select(along.abs().cmplt(smallest), smallest, along).recip();
        let (offset, shift, rounding) = (-start * inverse, bow * inverse, rounding * inverse.abs());
        let begin = offset - (shift.max(Vec3A::ZERO) + rounding);
        let end = FARTHER * (offset + ((-shift).max(Vec3A::ZERO) + rounding));
        Self {
            near: [inverse.x, inverse.y, inverse.z].map(|inverse| usize::from(inverse < 0.0)),
            inverse: inverse.to_array(),
            begin: begin.to_array(),
            end_inverse: (FARTHER * inverse).to_array(),
            end: end.to_array(),
            until: f32::INFINITY,
        }
    }

    /// Children of `node` that the ray meets, a bit each, and the parts of the chord at which it enters them.
    #[inline(always)]
    pub fn meets<V: Simd8>(&self, simd: V, node: &BvhNode) -> (u32, [f32; WIDTH]) {
        let begin = |axis: usize| {
            let planes = simd.load(&node.planes[axis][self.near[axis] & 1]);
            simd.mul_add(planes, simd.splat(self.inverse[axis]), simd.splat(self.begin[axis]))
        };
        let end = |axis: usize| {
            let planes = simd.load(&node.planes[axis][self.near[axis] & 1 ^ 1]);
            simd.mul_add(planes, simd.splat(self.end_inverse[axis]), simd.splat(self.end[axis]))
        };
        let enter = simd.max(simd.max(begin(0), begin(1)), simd.max(begin(2), simd.splat(0.0)));
        let last = simd.min(simd.min(end(0), end(1)), simd.min(end(2), simd.splat(self.until)));
        (simd.le(enter, last), simd.store(enter))
    }

    /// Part of the chord that matters.
    #[inline(always)]
    pub fn until(&self) -> f32 {
        self.until
    }

    /// True if a node entered at this part of the chord must be searched.
    #[inline(always)]
    pub fn reaches(&self, part: f32) -> bool {
        part <= self.until
    }

    /// Ends the search at a part of the chord.
    #[inline(always)]
    pub fn shorten(&mut self, part: f32) {
        self.until = min(FARTHER * part, self.until);
    }
}
