//! A ray in a field of refraction, and one step of it.

use glam::DVec3;

use super::span::FieldSpan;
use crate::geometry::PrimitiveId;
use crate::math::columns::columns;
use crate::trace::flight_status::FlightStatus;

columns! {
    /// A ray in a field.
    pub struct FieldFlight => FieldFlightBlock {
        /// World position.
        position: DVec3,
        /// Momentum, as long as the index.
        momentum: DVec3,
        /// ½∇n².
        force: DVec3,
        /// β of projective coordinates about the position.
        lean: DVec3,
        /// Length over which the index changes.
        room: f64,
        /// Length in τ to try next.
        h: f64,
        /// Relative error of the step before.
        error: f64,
        /// Primitive that the position lies on, until the first step is taken.
        origin_prim: PrimitiveId,
        /// Steps so far, rejected ones included.
        steps: u32,
        /// State after the last of them.
        status: FlightStatus,
    }
}

columns! {
    /// One step of a ray in a field; places from its start.
    pub struct FieldMove => FieldMoveBlock {
        /// World position at the end.
        position: DVec3,
        /// Momentum at the end.
        momentum: DVec3,
        /// ½∇n² at the end.
        force: DVec3,
        /// β of projective coordinates about the end.
        lean: DVec3,
        /// Length over which the index changes at the end.
        room: f64,
        /// Middle control point of the arc.
        middle: DVec3,
        /// End of the arc.
        chord: DVec3,
        /// Weight of the middle control point.
        weight: f64,
        /// Length in τ to try next.
        next_h: f64,
        /// Relative error.
        error: f64,
        /// True if the arc is so near the ray that a hit on the arc is where the ray has it.
        is_close: bool,
        /// True if the step is good enough to be taken.
        accepted: bool,
        /// True if a hole has captured the ray at its end.
        falls: bool,
    }
}

impl FieldFlight {
    /// The step that it is to take.
    #[inline(always)]
    pub fn span(&self) -> FieldSpan {
        let &Self { position, momentum, force, lean, room, h, .. } = self;
        FieldSpan { position, momentum, force, lean, room, h }
    }
}
