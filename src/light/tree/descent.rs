//! Descent from the root of a light tree to one emitter.

use super::node::{Chances, LightTreeNode, Subtree};
use crate::math::rescale::rescale;

/// A descent under way.
#[derive(Clone, Copy)]
pub struct Descent {
    subtree: Subtree,
    probability: f64,
    /// In [0, 1).
    u: f64,
}

impl Descent {
    /// One from a subtree, by a number in [0, 1).
    #[inline(always)]
    pub fn new(subtree: Subtree, u: f64) -> Self {
        Self { subtree, probability: 1.0, u }
    }

    /// The emitter that it has come to, its probability, and the number for use again; else the first of the pair below.
    #[inline(always)]
    pub fn end(&self) -> Result<(u32, f64, f64), u32> {
        match self.subtree {
            Subtree::Emitter(emitter) => Ok((emitter, self.probability, self.u)),
            Subtree::Pair(first) => Err(first),
        }
    }

    /// Goes on to one of the pair below; `None` if neither can contribute.
    #[inline(always)]
    pub fn turn(&self, pair: [&LightTreeNode; 2], Chances { left, right }: Chances) -> Option<Self> {
        if left.is_nan() {
            return None;
        }
        let goes_right = self.u >= left;
        let (below, chance) = if goes_right { (left, 1.0 - left) } else { (0.0, left) };
        Some(Self {
            subtree: pair[usize::from(goes_right)].subtree,
            probability: self.probability * if goes_right { right } else { left },
            u: rescale(self.u, below, chance),
        })
    }
}
