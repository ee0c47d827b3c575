//! Crossing the throat of a wormhole: a step that passes it ends there, and the ray goes on in the chart of the other side.

use super::flight::{CurvedFlight, CurvedMove, Lane};
use super::rays::Curved;
use super::worlds::{Throat, Worlds};
use crate::geometry::PrimitiveId;
use crate::spacetime::{ConformallyFlat, Fate};
use crate::trace::flight_status::FlightStatus;

/// True if a ray's step passes the throat.
#[inline(always)]
fn passes<R: Lane>(radius: f64, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> bool {
    step.accepted & (flight.fate == Fate::Falls) & (step.w.value() * radius >= 1.0)
}

impl<M: ConformallyFlat, R: Lane, W: Worlds<M>> Curved<M, R, W> {
    /// The ray on the other side of the throat, if its step passes that: nothing is met within.
    #[inline(always)]
    pub(super) fn crossing(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> Option<CurvedFlight<R>> {
        let throat = self.worlds.throat()?;
        passes(throat.radius, flight, step).then(|| self.beyond(throat, flight, step))
    }

    /// The part of a ray's step before the throat: all of it, unless the step passes that.
    #[inline(always)]
    pub(super) fn before_throat(
        &self,
        flight: &CurvedFlight<R>,
        step: &CurvedMove<R>,
    ) -> (CurvedFlight<R>, CurvedMove<R>) {
        match self.worlds.throat() {
            Some(Throat { radius, .. }) if passes(radius, flight, step) => {
                let (h, _) = self.march.until(flight, R::of(1.0 / radius));
                let part = CurvedFlight { h, ..*flight };
                (part, CurvedMove { accepted: true, ..self.march.advance(&part) })
            }
            _ => (*flight, *step),
        }
    }

    #[inline(never)]
    fn beyond(
        &self,
        Throat { mouths, radius }: Throat<'_>,
        flight: &CurvedFlight<R>,
        step: &CurvedMove<R>,
    ) -> CurvedFlight<R> {
        let (h, phase) = self.march.until(flight, R::of(1.0 / radius));
        let phase = phase.beyond_throat();
        // In f64, so that the vectors stay orthonormal.
        let tangent = (flight.b * h).value();
        let cos = 1.0 / (1.0 + tangent * tangent).sqrt();
        let sin = tangent * cos;
        let side = flight.origin_prim.side();
        let radial = -mouths.turned(side, cos * flight.radial + sin * flight.along);
        let along = -mouths.turned(side, cos * flight.along - sin * flight.radial);
        CurvedFlight {
            position: radius * radial,
            radial,
            along,
            w: phase.w,
            v: phase.v,
            pull: phase.pull,
            h: self.within(step.next_h, flight.b, &phase),
            error: step.error,
            fate: Fate::Escapes,
            origin_prim: PrimitiveId::none_on(side.other()),
            steps: flight.steps + 1,
            status: FlightStatus::Flies,
            ..*flight
        }
    }
}
