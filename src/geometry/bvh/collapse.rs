//! From a binary hierarchy to one with eight children a node and a block of primitives a leaf.
//!
//! From the top: the child of largest area is replaced by its own two until there are eight. What holds no more than a
//! block is a leaf, unless its halves are smaller and there is room for both, or it holds what is dear to look into.

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

use super::node::{BvhNode, EMPTY, LEAF_SIZE, WIDTH};

/// Nodes, and the primitive of each leaf slot.
#[derive(Default)]
pub struct Wide {
    pub nodes: Vec<BvhNode>,
    pub order: Vec<u32>,
    /// Levels of nodes.
    pub depth: usize,
}

/// A node of the binary hierarchy, to become a child.
#[derive(Clone, Copy)]
struct Child {
    index: u32,
    area: f32,
    /// True if it fits a leaf.
    is_small: bool,
}

/// Halves of a small child must have this part of its area together, or less, to be worth two leaves.
const WORTH: f32 = 0.9;

impl Wide {
    /// Collapses `binary`, whose leaves hold one primitive each; there are more than fit one leaf. Those that are
    /// `alone` have a leaf each.
    pub fn collapse(binary: &Bvh2, alone: impl Fn(u32) -> bool) -> Self {
        let binary = &BinaryTree { binary, alone };
        let mut wide = Self { nodes: vec![BvhNode::default()], ..Self::default() };
        let mut pending = vec![(0usize, 0u32, 1usize)];
        while let Some((at, from, level)) = pending.pop() {
            wide.depth = wide.depth.max(level);
            let mut children = binary.open(from);
            children.sort_by_key(|child| child.is_small);
            let inner = children.iter().filter(|child| !child.is_small).count();
            let first_inner = wide.nodes.len();
            let boxes: Vec<_> = children.iter().map(|c| *binary.node(c.index).aabb()).collect();
            let first_leaf = wide.order.len() / LEAF_SIZE;
            wide.nodes[at] = BvhNode::new(&boxes, inner, first_inner as u32, first_leaf as u32);
            wide.nodes.resize(first_inner + inner, BvhNode::default());
            let inner_children = children[..inner].iter().enumerate().rev();
            pending.extend(inner_children.map(|(i, child)| (first_inner + i, child.index, level + 1)));
            let leaves = children[inner..].iter().filter_map(|leaf| binary.primitives(leaf.index));
            wide.order.extend(leaves.flatten());
        }
        wide.nodes.shrink_to_fit();
        wide.order.shrink_to_fit();
        wide
    }
}

/// A binary hierarchy, and which primitives have a leaf each.
struct BinaryTree<'a, F> {
    binary: &'a Bvh2,
    alone: F,
}

impl<F: Fn(u32) -> bool> BinaryTree<'_, F> {
    fn node(&self, index: u32) -> &Bvh2Node {
        &self.binary.nodes[index as usize]
    }

    /// Children of the wide node that starts at a binary one.
    fn open(&self, from: u32) -> Vec<Child> {
        let mut children = self.halves(from).to_vec();
        while children.len() < WIDTH {
            let largest = |a: &&(usize, Child), b: &&(usize, Child)| a.1.area.total_cmp(&b.1.area);
            let open: Vec<(usize, Child)> = children.iter().copied().enumerate().collect();
            let large = open.iter().filter(|(_, child)| !child.is_small).max_by(largest);
            let small = || {
                let is_worth = |child: &Child| {
                    !self.node(child.index).is_leaf()
                        && self.halves(child.index).iter().map(|half| half.area).sum::<f32>()
                            < WORTH * child.area
                };
                open.iter().filter(|(_, child)| is_worth(child)).max_by(largest)
            };
            let Some(&(at, child)) = large.or_else(small) else { break };
            let [one, other] = self.halves(child.index);
            children[at] = one;
            children.push(other);
        }
        children
    }

    fn halves(&self, index: u32) -> [Child; 2] {
        let first = self.node(index).first_index;
        [first, first + 1].map(|index| Child {
            index,
            area: self.node(index).aabb().half_area(),
            is_small: self.primitives(index).is_some(),
        })
    }

    /// The primitives below a node; `None` if they don't fit a leaf.
    fn primitives(&self, index: u32) -> Option<[u32; LEAF_SIZE]> {
        let (mut found, mut count) = ([EMPTY; LEAF_SIZE], 0);
        let (mut pending, mut open) = ([index; LEAF_SIZE], 1);
        while open > 0 {
            open -= 1;
            let node = self.node(pending[open]);
            if node.is_leaf() {
                found[count] = self.binary.primitive_indices[node.first_index as usize];
                count += 1;
            } else if count + open + 2 <= LEAF_SIZE {
                pending[open] = node.first_index + 1;
                pending[open + 1] = node.first_index;
                open += 2;
            } else {
                return None;
            }
        }
        let is_shared = count > 1 && found[..count].iter().any(|&primitive| (self.alone)(primitive));
        (!is_shared).then_some(found)
    }
}
