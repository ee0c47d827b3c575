//! A node with eight children, whose boxes are on a grid of the node's own.
//!
//! After Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", §3:
//! 72 bytes, within two cache lines. Children are numbered: inner ones first, then leaves.

use glam::Vec3A;
use obvhs::aabb::Aabb;

use crate::math::columns::LANES;

/// Slots of a leaf.
pub const LEAF_SIZE: usize = LANES;
/// Marks an empty slot, never the first of its leaf.
pub const EMPTY: u32 = u32::MAX;

/// Children of a node, at most.
pub const WIDTH: usize = 8;
/// Marks the number of a leaf.
pub const LEAF: u32 = 1 << 31;
/// Grid lines of a node along an axis, less one.
pub const CELLS: f32 = 255.0;

/// A node. Planes of child boxes are at origin + q 2^(exponent − 127).
#[derive(Clone, Copy, Debug, Default)]
pub struct BvhNode {
    /// Lower planes by axis and child.
    pub low: [[u8; WIDTH]; 3],
    /// Upper planes by axis and child.
    pub high: [[u8; WIDTH]; 3],
    origin: [f32; 3],
    exponents: [u8; 3],
    inner: u8,
    children: u8,
    first_inner: u32,
    first_leaf: u32,
}

impl BvhNode {
    /// A node over boxes: those of `inner` children, which are numbered from `first_inner` on, then those of leaves,
    /// which are numbered from `first_leaf` on.
    pub fn new(boxes: &[Aabb], inner: usize, first_inner: u32, first_leaf: u32) -> Self {
        let all = boxes.iter().fold(Aabb::empty(), |all, next| all.union(next));
        let mut node = Self {
            origin: all.min.to_array(),
            inner: inner as u8,
            children: boxes.len() as u8,
            first_inner,
            first_leaf,
            ..Self::default()
        };
        for axis in 0..3 {
            let origin = f64::from(all.min[axis]);
            let cell = (f64::from(all.max[axis]) - origin) / f64::from(CELLS);
            let exponent = (libm::log2(cell).ceil() + 127.0).clamp(1.0, 254.0);
            node.exponents[axis] = exponent as u8;
            let scale = libm::exp2(exponent - 127.0);
            for (child, bounds) in boxes.iter().enumerate() {
                let line = |at: f32| (f64::from(at) - origin) / scale;
                node.low[axis][child] = line(bounds.min[axis]).floor() as u8;
                node.high[axis][child] = line(bounds.max[axis]).ceil() as u8;
            }
        }
        node
    }

    /// Origin of the grid.
    #[inline(always)]
    pub fn origin(&self) -> Vec3A {
        Vec3A::from(self.origin)
    }

    /// Size of its cells.
    #[inline(always)]
    pub fn scale(&self) -> Vec3A {
        let [x, y, z] = self.exponents.map(|exponent| f32::from_bits(u32::from(exponent) << 23));
        Vec3A::new(x, y, z)
    }

    /// Mask of the children that there are, one byte a child.
    #[inline(always)]
    pub fn mask(&self) -> u64 {
        u64::MAX >> (u64::BITS - u8::BITS * u32::from(self.children))
    }

    /// Number of a child, marked as a [`LEAF`] if it is one.
    #[inline(always)]
    pub fn child(&self, child: u32) -> u32 {
        let inner = u32::from(self.inner);
        if child < inner { self.first_inner + child } else { LEAF | (self.first_leaf + child - inner) }
    }
}
