//! A tree over many emitters, from which one is chosen about as likely as it lights a point.
//!
//! References: \[C\] Conty Estevez, Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
//! HPG; \[P\] Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., 12.6.3.
//!
//! A cluster is known by a sphere around it, its power and the cone of its normals. From the root on, one of two
//! children is chosen by their importance: power × bound of both cosines / squared distance. As the cosines are bounds
//! over everything in the cluster, what can contribute along a straight line is never left out. A cluster may look as
//! if it could contribute where none of its emitters does; the choice then ends without an emitter.

mod build;
mod cluster;
mod cone;
mod descent;
mod descents;
mod emission;
mod node;
#[cfg(test)]
mod tests;

use glam::DVec3;

use descent::Descent;
pub use descents::Descents;
pub use emission::Emission;
use node::{COSINE_ERROR, Chances, LightTreeNode, Siblings, Subtree};
pub use node::{LitSide, LocalReceiver};

use crate::math::kernel::Kernel;

/// A binary tree of emitters.
#[derive(Default)]
pub struct Tree {
    /// `None` if no emitter has power.
    root: Option<Subtree>,
    /// Everything but the root, which is never compared with anything. Siblings are neighbours: they are read together.
    nodes: Vec<LightTreeNode>,
    /// Of each emitter, the way from the root: the lowest bit is the first turn, 1 is right, and the highest bit set
    /// ends it. 0 for an emitter that is not in the tree.
    polylines: Vec<u64>,
    /// The middle of everything, to which nodes are relative: f32 is then fine enough far from the world's origin too.
    origin: DVec3,
    floor: f64,
}

impl Tree {
    /// Chooses an emitter for light at `x` on a side of a surface (`None`: no surface, or one unknown) by `u` in [0, 1):
    /// the emitter's index, its probability, and `u` rescaled to [0, 1) for reuse.
    ///
    /// `None` if nothing can contribute, or nothing in the cluster that was chosen: zero is then an unbiased estimate.
    /// With a positive floor an emitter is always found if there is one.
    pub fn sample(&self, x: DVec3, side: Option<LitSide>, u: f64) -> Option<(u32, f64, f64)> {
        let receiver = self.receiver(x, side);
        self.descend(u, |first| self.chances(first, &receiver))
    }

    /// What [`Self::sample`] finds by `u`, given the chances of two siblings by the first of them.
    #[inline(always)]
    fn descend(&self, u: f64, chances: impl Fn(u32) -> Chances) -> Option<(u32, f64, f64)> {
        let mut descent = Descent::new(self.root?, u);
        loop {
            match descent.end() {
                Ok(emitter) => return Some(emitter),
                Err(first) => descent = descent.turn(self.pair(first), chances(first))?,
            }
        }
    }

    /// The probability with which `sample` chooses `emitter`, the same to the last bit; 0 if it is none of the tree's.
    pub fn probability(&self, emitter: u32, x: DVec3, side: Option<LitSide>) -> f64 {
        let receiver = self.receiver(x, side);
        let mut polyline = self.polylines.get(emitter as usize).copied().unwrap_or(0);
        let Some(mut subtree) = self.root.filter(|_| polyline != 0) else { return 0.0 };
        let mut probability = 1.0;
        while let Subtree::Pair(first) = subtree {
            let Chances { left, right } = self.chances(first, &receiver);
            if left.is_nan() {
                return 0.0;
            }
            let turn = (polyline & 1) as usize;
            probability *= [left, right][turn];
            subtree = self.nodes[first as usize + turn].subtree;
            polyline >>= 1;
        }
        probability
    }

    /// True if no emitter has power.
    pub fn is_empty(&self) -> bool {
        self.root.is_none()
    }

    /// A receiver at `x`, as the tree looks at it.
    #[inline(always)]
    pub fn receiver(&self, x: DVec3, side: Option<LitSide>) -> LocalReceiver {
        let (normal, grazing) = match side {
            Some(LitSide { normal, grazing }) => (normal, f64::from(grazing).max(COSINE_ERROR)),
            None => (DVec3::ZERO, 1.0),
        };
        LocalReceiver { x: x - self.origin, normal, grazing }
    }

    /// Two siblings.
    #[inline(always)]
    fn pair(&self, first: u32) -> [&LightTreeNode; 2] {
        let first = first as usize;
        [&self.nodes[first], &self.nodes[first + 1]]
    }

    #[inline(always)]
    fn siblings(&self, first: u32) -> Siblings<'_> {
        Siblings { clusters: self.pair(first).map(|node| &node.cluster), floor: self.floor }
    }

    /// Probabilities of two siblings.
    #[inline(always)]
    fn chances(&self, first: u32, receiver: &LocalReceiver) -> Chances {
        self.siblings(first).run(receiver, &())
    }
}
