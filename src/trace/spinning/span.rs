//! A step around a spinning hole, of which parts are wanted.

use glam::DVec3;

use super::Spinning;
use super::flight::{SpinningFlight, SpinningMove};
use crate::geodesic::kerr::{Constants, MinoState};
use crate::math::columns::{Row, columns};
use crate::trace::land_on_ray::{PartialStep, Pose, Retrace};

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

impl Retrace for Spinning {
    type Span = SpinningSpan;

    #[inline(always)]
    fn span(&self, flight: &SpinningFlight, step: &SpinningMove) -> SpinningSpan {
        let &SpinningFlight { position, u, v, n, m, l, k, j2, k2, kappa, .. } = flight;
        SpinningSpan { position: position + self.place.center, u, v, n, m, l, k, j2, k2, kappa, h: step.h }
    }

    #[inline(always)]
    fn part_near(&self, flight: &SpinningFlight, step: &SpinningMove, point: DVec3) -> f64 {
        // Along the chord the way goes as λ/(u₀u), with u nearly linear in λ.
        let way = point - self.place.center - flight.position;
        let share = way.dot(step.end) / step.end.length_squared();
        let part = share * flight.u / (step.u + share * (flight.u - step.u));
        if part.is_finite() { part.clamp(0.0, 1.0) } else { 1.0 }
    }

    fn pose(&self, span: &SpinningSpan, part: &PartialStep) -> Pose {
        self.march.pose(span, part)
    }

    fn pose_all(
        &self,
        spans: &[<SpinningSpan as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    ) {
        self.march.pose_all(spans, parts, poses);
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn segment_tolerance(&self) -> f64 {
        self.arc_tolerance
    }
}
