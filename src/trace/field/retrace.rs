//! Parts of steps in a field, for landings on the ray itself.

use glam::DVec3;

use super::Field;
use super::flight::{FieldFlight, FieldMove};
use crate::geodesic::{FieldRays, set_lane};
use crate::math::columns::{LANES, Row, columns};
use crate::trace::land_on_ray::{PartialStep, Pose, Retrace};

columns! {
    /// A step, of which parts are wanted.
    pub struct FieldSpan => FieldSpanBlock {
        /// World position of the start.
        position: DVec3,
        /// Momentum there.
        momentum: DVec3,
        /// ½∇n² there.
        force: DVec3,
        /// β there.
        lean: DVec3,
        /// Length over which the index changes there.
        room: f64,
        /// Length of the whole step in τ.
        h: f64,
    }
}

impl FieldSpan {
    /// Starts of a block of steps, and their lengths.
    #[inline(always)]
    pub fn rays(block: &<Self as Row>::Block) -> (FieldRays<LANES>, [f64; LANES]) {
        gather(|l| Self::get(block, l))
    }

    /// The start by itself, and the length.
    #[inline(always)]
    pub fn ray(&self) -> (FieldRays<1>, [f64; 1]) {
        gather(|_| *self)
    }
}

/// Starts of steps, and their lengths.
#[inline(always)]
pub fn gather<const L: usize>(span: impl Fn(usize) -> FieldSpan) -> (FieldRays<L>, [f64; L]) {
    let none = [[0.0; L]; 3];
    // How far the next step may reach has been seen to before.
    let mut rays = FieldRays { x: none, p: none, force: none, lean: none, room: [0.0; L], reach: [0.0; L] };
    let mut lengths = [0.0; L];
    for (l, length) in lengths.iter_mut().enumerate() {
        let FieldSpan { position, momentum, force, lean, room, h } = span(l);
        set_lane(&mut rays.x, l, position);
        set_lane(&mut rays.p, l, momentum);
        set_lane(&mut rays.force, l, force);
        set_lane(&mut rays.lean, l, lean);
        (rays.room[l], *length) = (room, h);
    }
    (rays, lengths)
}

impl Retrace for Field {
    type Span = FieldSpan;

    #[inline(always)]
    fn span(&self, flight: &FieldFlight, _: &FieldMove) -> FieldSpan {
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
