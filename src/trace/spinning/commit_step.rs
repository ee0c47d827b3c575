//! Committing a step that met nothing: from its end to the start of the next.

use super::flight::{SpinningFlight, SpinningMove};
use super::rays::Spinning;
use crate::geometry::PrimitiveId;
use crate::math::kernel::Kernel;
use crate::spacetime::Fate;
use crate::trace::flight_status::FlightStatus;

/// Most steps of one ray. Only rays that wind about the nearly stable circular ones of a nearly extremal hole take
/// thousands.
const MAX_STEPS: u32 = 100_000;

/// Commits the steps of rays that met nothing: to the end of a step that is good enough, or else to a shorter step.
pub struct SpinningCommits<'a>(pub &'a Spinning);

impl Kernel for SpinningCommits<'_> {
    type A = SpinningFlight;
    type B = SpinningMove;
    type Out = SpinningFlight;

    #[inline(always)]
    fn run(&self, flight: &SpinningFlight, step: &SpinningMove) -> SpinningFlight {
        let taken = step.accepted;
        let next = SpinningFlight {
            position: flight.position + step.end,
            u: step.u,
            v: step.v,
            n: step.n,
            m: step.m,
            origin_prim: PrimitiveId::NONE,
            ..*flight
        };
        let chart = &self.0.chart;
        let fate = flight.constants().fate(step.u, step.v);
        let gone = if fate == Fate::Escapes { FlightStatus::Leaves } else { FlightStatus::Falls };
        let is_left = taken & chart.is_left(fate, step.u, step.v);
        let status = if is_left { gone } else { FlightStatus::Flies };
        // The next step must be finite and not vanish; a state lost for good is reported.
        let moves = (step.longest > f64::from(f32::MIN_POSITIVE)) & (step.h < f64::INFINITY);
        let status = if taken | moves { status } else { FlightStatus::NonFinite };
        let status = if flight.steps < MAX_STEPS { status } else { FlightStatus::StepLimit };
        let committed = if taken { next } else { *flight };
        SpinningFlight { longest: step.longest, steps: flight.steps + 1, status, ..committed }
    }
}
