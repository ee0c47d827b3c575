//! Parts of a curved ray's step, for landings on the ray itself.

use glam::DVec3;

use super::{Curved, CurvedFlight, CurvedMove, Lane};
use crate::geodesic::{Phase, Step, Stepper};
use crate::math::columns::{Row, columns};
use crate::spacetime::ConformallyFlat;
use crate::trace::land_on_ray::{Part, Pose, Retrace};

columns! {
    /// A step, of which parts are wanted.
    pub struct Span<R> => SpanBlock {
        /// World position of the start.
        position: DVec3,
        /// Unit vector from the centre to the start.
        radial: DVec3,
        /// Unit vector across it in the orbit's plane.
        along: DVec3,
        /// Impact parameter.
        b: R,
        /// Inverse radius at the start.
        w: R,
        /// dw/dψ at the start.
        v: R,
        /// ½ dn²/dw at the start.
        pull: R,
        /// Length of the whole step in ξ.
        h: R,
    }
}

impl<R: Lane> Span<R> {
    /// Pose after a part of the step.
    #[inline(always)]
    pub fn pose<M: ConformallyFlat>(&self, medium: &M, stepper: &impl Stepper, part: &Part) -> Pose {
        let start = Phase { w: self.w, v: self.v, pull: self.pull };
        let step = Step::new(medium, stepper, self.b, start, R::of(part.s) * self.h);
        let ([x, y], [momentum_x, momentum_y]) = (step.displacement(), step.end_momentum());
        let (w, n) = (step.end.w, step.end.index(self.b));
        let per_n = R::of(1.0) / n;
        let (tangent_x, tangent_y) = (momentum_x * per_n, momentum_y * per_n);
        // |dx/dξ| = n c²/w².
        let speed = self.h * n * step.cos * step.cos / (w * w);
        let w_per_n = w * per_n;
        let curvature = step.end.pull * self.b * (w_per_n * w_per_n * w_per_n);
        let place = |x: R, y: R| x.value() * self.radial + y.value() * self.along;
        Pose {
            position: self.position + place(x, y),
            tangent: place(tangent_x, tangent_y),
            bend: place(-tangent_y, tangent_x),
            curvature: curvature.value(),
            inverse_scale: w.value(),
            speed: speed.value(),
            s: part.s,
        }
    }
}

impl<M: ConformallyFlat, R: Lane> Retrace for Curved<M, R> {
    type Span = Span<R>;

    #[inline(always)]
    fn span(&self, flight: &CurvedFlight<R>, _: &CurvedMove<R>) -> Span<R> {
        let &CurvedFlight { position, radial, along, b, w, v, pull, h, .. } = flight;
        Span { position: position + self.center, radial, along, b, w, v, pull, h }
    }

    #[inline(always)]
    fn part_near(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>, point: DVec3) -> f64 {
        let point = point - self.center;
        let tangent = (flight.b * flight.h).value();
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

    fn pose(&self, span: &Span<R>, part: &Part) -> Pose {
        self.march.pose(span, part)
    }

    fn pose_all(
        &self,
        spans: &[<Span<R> as Row>::Block],
        parts: &[<Part as Row>::Block],
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
