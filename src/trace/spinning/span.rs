//! A step around a spinning hole, of which parts are wanted.

use glam::DVec3;

use crate::geodesic::kerr::{Constants, MinoState};
use crate::math::columns::columns;

columns! {
    /// A step, of which parts are wanted.
    pub struct SpinningSpan => SpinningSpanBlock {
        /// World position of the start.
        position: DVec3,
        /// Inverse radius at the start.
        u: f64,
        /// du/dλ at the start.
        v: f64,
        /// N at the start.
        n: DVec3,
        /// dN/dλ at the start.
        m: DVec3,
        /// Angular momentum L.
        l: f64,
        /// Carter's K.
        k: f64,
        /// J².
        j2: f64,
        /// k².
        k2: f64,
        /// κ.
        kappa: f64,
        /// The way from the start to a point beside the step, along the world's axes.
        way: DVec3,
        /// Length of the whole step in λ.
        h: f64,
    }
}

impl SpinningSpan {
    /// State at the start.
    #[inline(always)]
    pub fn state(&self) -> MinoState {
        MinoState { u: self.u, v: self.v, n: self.n, m: self.m }
    }

    /// Constants of motion; the barrier is of no concern within a step.
    #[inline(always)]
    pub fn constants(&self) -> Constants {
        let &Self { l, k, j2, k2, kappa, .. } = self;
        Constants { l, k, j2, k2, kappa, barrier: f64::INFINITY }
    }
}
