//! Parts of steps in a field, for landings on the ray itself.

use glam::DVec3;

use super::flight::{FieldFlight, FieldMove};
use super::rays::FieldTransport;
use super::span::FieldSpan;
use crate::math::columns::Row;
use crate::trace::land_on_ray::{PartialStep, Pose, Retrace};

impl Retrace for FieldTransport {
    type Span = FieldSpan;

    #[inline(always)]
    fn span(&self, flight: &FieldFlight, _: &FieldMove, _: DVec3) -> FieldSpan {
        flight.span()
    }

    #[inline(always)]
    fn part_near(&self, flight: &FieldFlight, step: &FieldMove, point: DVec3) -> f64 {
        // In projective coordinates, in which the ray is nearly straight and of nearly constant speed.
        let projective = |way: DVec3| way / (1.0 + flight.lean.dot(way));
        let (way, whole) = (projective(point - flight.position), projective(step.chord));
        let s = way.dot(whole) / whole.length_squared();
        if s.is_finite() { s.clamp(0.0, 1.0) } else { 1.0 }
    }

    fn pose(&self, span: &FieldSpan, part: &PartialStep) -> Pose {
        self.march.pose(span, part)
    }

    fn pose_all(
        &self,
        spans: &[<FieldSpan as Row>::Block],
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
