//! Committing a step that met nothing: from its end to the start of the next.

use super::flight::{FieldFlight, FieldMove};
use super::rays::FieldTransport;
use crate::geometry::PrimitiveId;
use crate::math::kernel::Kernel;
use crate::trace::flight_status::FlightStatus;

/// Most steps of one ray: two orders of magnitude above what rays with several windings take.
const MAX_STEPS: u32 = 10_000;

/// Commits the steps of rays that met nothing: to the end of a step that is good enough, or else to a shorter step.
pub struct FieldCommits<'a>(pub &'a FieldTransport);

impl Kernel for FieldCommits<'_> {
    type A = FieldFlight;
    type B = FieldMove;
    type Out = FieldFlight;

    #[inline(always)]
    fn run(&self, flight: &FieldFlight, step: &FieldMove) -> FieldFlight {
        let taken = step.accepted;
        let next = FieldFlight {
            position: step.position,
            momentum: step.momentum,
            force: step.force,
            lean: step.lean,
            room: step.room,
            error: step.error,
            origin_prim: PrimitiveId::NONE,
            ..*flight
        };
        let steps = flight.steps + 1;
        let leaves = self.0.control.leaves(step.position, step.momentum);
        // The next step must be finite and not vanish; a state lost for good is reported.
        let moves = step.next_h > f64::from(f32::MIN_POSITIVE);
        let status = if step.falls { FlightStatus::Falls } else { FlightStatus::Flies };
        let status = if leaves { FlightStatus::Leaves } else { status };
        let status = if taken { status } else { FlightStatus::Flies };
        let status = if moves { status } else { FlightStatus::NonFinite };
        let status = if steps <= MAX_STEPS { status } else { FlightStatus::StepLimit };
        let committed = if taken { next } else { *flight };
        FieldFlight { h: step.next_h, steps, status, ..committed }
    }
}
