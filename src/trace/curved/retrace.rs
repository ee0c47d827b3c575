//! Parts of curved rays' steps, for landings on the ray itself.

use glam::DVec3;

use super::flight::{CurvedFlight, CurvedMove, Lane};
use super::rays::Curved;
use super::span::Span;
use super::worlds::Worlds;
use crate::math::columns::Row;
use crate::spacetime::ConformallyFlat;
use crate::trace::land_on_ray::{PartialStep, Pose, Retrace};

impl<M, R, W> Retrace for Curved<M, R, W>
where
    M: ConformallyFlat,
    R: Lane,
    W: Worlds<M> + 'static,
{
    type Span = Span<R>;

    #[inline(always)]
    fn span(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>, _: DVec3) -> Span<R> {
        let &CurvedFlight { position, radial, along, b, w, v, pull, origin_prim, .. } = flight;
        Span {
            position: position + self.worlds.of(origin_prim).center,
            radial,
            along,
            b,
            w,
            v,
            pull,
            h: step.h,
        }
    }

    #[inline(always)]
    fn part_near(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>, point: DVec3) -> f64 {
        let point = point - self.worlds.of(flight.origin_prim).center;
        let tangent = (flight.b * step.h).value();
        let s = if tangent > 1e-3 {
            point.dot(flight.along) / (point.dot(flight.radial) * tangent)
        } else {
            let (way, whole) = (point - flight.position, flight.place(step.end_x, step.end_y));
            let (x, end_x) = (way.dot(flight.radial), step.end_x.value());
            if end_x.abs() > 0.1 * whole.length() {
                // Nearly along the radius w is linear in ξ.
                x / end_x / ((step.w / flight.w).value() * (1.0 + x * flight.w.value()))
            } else {
                way.dot(whole) / whole.length_squared()
            }
        };
        if s.is_finite() { s.clamp(0.0, 1.0) } else { 1.0 }
    }

    fn pose(&self, span: &Span<R>, part: &PartialStep) -> Pose {
        self.march.pose(span, part)
    }

    fn pose_all(
        &self,
        spans: &[<Span<R> as Row>::Block],
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
