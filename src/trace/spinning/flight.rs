//! A ray around a spinning hole, and one step of it.

use glam::DVec3;

use crate::geodesic::kerr::{Constants, MinoState};
use crate::geometry::PrimitiveId;
use crate::math::columns::columns;
use crate::trace::flight_status::FlightStatus;

columns! {
    /// A ray; its state and constants are those of [`crate::geodesic::kerr`].
    pub struct SpinningFlight => SpinningFlightBlock {
        /// Position, relative to the hole, along the world's axes.
        position: DVec3,
        /// Inverse radius.
        u: f64,
        /// du/dλ.
        v: f64,
        /// Unit vector N.
        n: DVec3,
        /// dN/dλ.
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
        /// Inverse radius of the barrier.
        barrier: f64,
        /// Longest step in λ to try next.
        longest: f64,
        /// Primitive that the position lies on, until the first step is taken.
        origin_prim: PrimitiveId,
        /// Steps so far, rejected ones included.
        steps: u32,
        /// State after the last of them.
        status: FlightStatus,
    }
}

columns! {
    /// One step of a ray; places from its start, along the world's axes.
    pub struct SpinningMove => SpinningMoveBlock {
        /// Length in λ.
        h: f64,
        /// Inverse radius at the end.
        u: f64,
        /// du/dλ at the end.
        v: f64,
        /// N at the end.
        n: DVec3,
        /// dN/dλ at the end.
        m: DVec3,
        /// End.
        end: DVec3,
        /// Middle control point of the arc.
        middle: DVec3,
        /// Its weight.
        weight: f64,
        /// Longest step in λ to try next.
        longest: f64,
        /// True if the arc is so near the ray that a hit on the arc is where the ray has it.
        is_close: bool,
        /// True if the step is good enough to be taken.
        accepted: bool,
    }
}

impl SpinningFlight {
    /// State of the ray.
    #[inline(always)]
    pub fn state(&self) -> MinoState {
        MinoState { u: self.u, v: self.v, n: self.n, m: self.m }
    }

    /// Constants of motion.
    #[inline(always)]
    pub fn constants(&self) -> Constants {
        let &Self { l, k, j2, k2, kappa, barrier, .. } = self;
        Constants { l, k, j2, k2, kappa, barrier }
    }
}
