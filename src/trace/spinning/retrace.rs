//! Parts of steps around a spinning hole, for landings on the ray itself.

use glam::DVec3;

use super::flight::{SpinningFlight, SpinningMove};
use super::rays::Spinning;
use super::span::SpinningSpan;
use crate::math::columns::Row;
use crate::trace::land_on_ray::{PartialStep, Pose, Retrace};

impl Retrace for Spinning {
    type Span = SpinningSpan;

    #[inline(always)]
    fn span(&self, flight: &SpinningFlight, step: &SpinningMove, point: DVec3) -> SpinningSpan {
        let &SpinningFlight { position, u, v, n, m, l, k, j2, k2, kappa, .. } = flight;
        let position = position + self.place.center;
        let way = point - position;
        SpinningSpan { position, way, u, v, n, m, l, k, j2, k2, kappa, h: step.h }
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

    fn pose_beside(&self, span: &SpinningSpan, part: &PartialStep) -> Pose {
        self.march.pose_beside(span, part)
    }

    fn pose_beside_all(
        &self,
        spans: &[<SpinningSpan as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    ) {
        self.march.pose_beside_all(spans, parts, poses);
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn segment_tolerance(&self) -> f64 {
        self.arc_tolerance
    }
}
