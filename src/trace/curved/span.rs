//! A curved ray's step, of which parts are wanted.

use glam::DVec3;

use super::flight::Lane;
use crate::geodesic::{OrbitStepper, Phase};
use crate::math::columns::columns;
use crate::spacetime::ConformallyFlat;
use crate::trace::land_on_ray::{PartialStep, Pose};

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
    pub fn pose<M: ConformallyFlat>(
        &self,
        medium: &M,
        stepper: &impl OrbitStepper,
        part: &PartialStep,
    ) -> Pose {
        let start = Phase { w: self.w, v: self.v, pull: self.pull };
        let step = stepper.part(medium, self.b, start, R::of(part.s) * self.h);
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
