//! Committing a step that met nothing: from its end to the start of the next.

use super::flight::{CurvedFlight, CurvedMove, Lane};
use super::rays::Curved;
use super::worlds::Worlds;
use crate::geodesic::Phase;
use crate::math::kernel::Kernel;
use crate::spacetime::{ConformallyFlat, Fate};
use crate::trace::flight_status::FlightStatus;

/// Most steps of one ray: two orders of magnitude above what rays with several windings take.
const MAX_STEPS: u32 = 10_000;

/// Commits the steps of rays that met nothing: to the end of a step that is good enough, or else to a shorter step.
pub struct Committing<'a, M, R, W>(pub &'a Curved<M, R, W>);

impl<M: ConformallyFlat, R: Lane, W: Worlds<M>> Kernel for Committing<'_, M, R, W> {
    type A = CurvedFlight<R>;
    type B = CurvedMove<R>;
    type Out = CurvedFlight<R>;

    #[inline(always)]
    fn run(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> CurvedFlight<R> {
        // In f64, so that the vectors stay orthonormal.
        let tangent = (flight.b * step.h).value();
        let taken = step.accepted;
        let tangent = if taken { tangent } else { 0.0 };
        let cos = 1.0 / (1.0 + tangent * tangent).sqrt();
        let sin = tangent * cos;
        let pick = |end: R, start: R| if taken { end } else { start };
        let phase = Phase {
            w: pick(step.w, flight.w),
            v: pick(step.v, flight.v),
            pull: pick(step.pull, flight.pull),
        };
        let zero = R::of(0.0);
        let way = flight.place(pick(step.end_x, zero), pick(step.end_y, zero));
        let next_h = pick(self.0.within(step.next_h, flight.b, &phase), step.next_h);
        CurvedFlight {
            position: flight.position + way,
            radial: cos * flight.radial + sin * flight.along,
            along: cos * flight.along - sin * flight.radial,
            w: phase.w,
            v: phase.v,
            pull: phase.pull,
            h: next_h,
            error: pick(step.error, flight.error),
            origin_prim: if taken { flight.origin_prim.none_beside() } else { flight.origin_prim },
            steps: flight.steps + 1,
            status: self.status(flight, taken, &phase, next_h),
            ..*flight
        }
    }
}

impl<M: ConformallyFlat, R: Lane, W: Worlds<M>> Committing<'_, M, R, W> {
    #[inline(always)]
    fn status(&self, flight: &CurvedFlight<R>, taken: bool, phase: &Phase<R>, next_h: R) -> FlightStatus {
        // The next step must be finite and not vanish; a state lost for good is reported.
        let moves = next_h.value() > f64::from(f32::MIN_POSITIVE);
        let (chart, w, v) = (&self.0.chart, phase.w.value(), phase.v.value());
        let is_left = taken & (chart.is_left(flight.fate, w, v) | chart.is_passed_by(flight.b.value(), w));
        let gone = if flight.fate == Fate::Escapes { FlightStatus::Leaves } else { FlightStatus::Falls };
        let status = if is_left { gone } else { FlightStatus::Flies };
        let status = if taken | moves { status } else { FlightStatus::NonFinite };
        if flight.steps < MAX_STEPS { status } else { FlightStatus::StepLimit }
    }
}
