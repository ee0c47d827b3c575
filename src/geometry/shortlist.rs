//! Triangles of which a line may meet one first.

use super::bvh::LEAF_SIZE;
use super::cull::{MayCross, min};

/// Slots of triangles to be tested exactly, in no order.
#[derive(Clone, Copy, Default)]
pub struct Shortlist {
    slots: [u32; 2 * LEAF_SIZE],
    len: usize,
}

impl Shortlist {
    /// Adds the triangles of a leaf that the line may cross: the part of it at which it surely crosses one, infinite if
    /// there is none. The list is not long.
    #[inline(always)]
    pub fn add(&mut self, met: &MayCross, leaf: usize) -> f32 {
        let (mut may, mut first) = (met.may, f32::INFINITY);
        while may != 0 {
            let lane = may.trailing_zeros() as usize % LEAF_SIZE;
            may &= may - 1;
            self.slots[self.len % (2 * LEAF_SIZE)] = (leaf * LEAF_SIZE + lane) as u32;
            self.len += 1;
            first = min(first, if met.surely >> lane & 1 == 1 { met.before[lane] } else { f32::INFINITY });
        }
        first
    }

    /// True if there may be no room for those of another leaf.
    #[inline(always)]
    pub fn is_long(&self) -> bool {
        self.len > LEAF_SIZE
    }

    /// Takes off a triangle.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<u32> {
        self.len = self.len.checked_sub(1)?;
        Some(self.slots[self.len % (2 * LEAF_SIZE)])
    }
}
