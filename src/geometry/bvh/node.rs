//! A node with eight children, whose boxes lie side by side.

use obvhs::aabb::Aabb;

use crate::math::columns::LANES;

/// Slots of a leaf.
pub const LEAF_SIZE: usize = LANES;
/// Marks an empty slot, never the first of its leaf.
pub const EMPTY: u32 = u32::MAX;

/// Children of a node, at most.
pub const WIDTH: usize = LANES;
/// Marks the number of a leaf.
pub const LEAF: u32 = 1 << 31;

/// A node. Vectors of its planes lie within cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct BvhNode {
    /// Lower and upper planes of the children's boxes by axis; of no child, those of a box that nothing meets.
    pub planes: [[[f32; WIDTH]; 2]; 3],
    /// Numbers of the children, marked as a [`LEAF`] if they are one.
    pub children: [u32; WIDTH],
}

impl Default for BvhNode {
    fn default() -> Self {
        Self { planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], children: [0; WIDTH] }
    }
}

impl BvhNode {
    /// A node over boxes: those of `inner` children, which are numbered from `first_inner` on, then those of leaves,
    /// which are numbered from `first_leaf` on.
    pub fn new(boxes: &[Aabb], inner: usize, first_inner: u32, first_leaf: u32) -> Self {
        let mut node = Self::default();
        let numbers = (first_inner..).take(inner).chain((first_leaf..).map(|number| LEAF | number));
        for (child, (bounds, number)) in boxes.iter().zip(numbers).enumerate() {
            node.children[child] = number;
            for axis in 0..3 {
                node.planes[axis][0][child] = bounds.min[axis];
                node.planes[axis][1][child] = bounds.max[axis];
            }
        }
        node
    }
}
