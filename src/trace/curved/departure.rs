//! Rays on their way to infinity, where nothing is in it.

use super::flight::{CurvedFlight, Lane};
use crate::geodesic::Phase;
use crate::math::columns::columns;
use crate::trace::flight_status::FlightStatus;

/// Most steps to infinity, before a ray is followed there by itself.
pub const MOST_STEPS: usize = 64;

columns! {
    /// A ray on its way to infinity.
    pub struct Departure<R> => DepartureBlock {
        /// Impact parameter.
        b: R,
        /// Inverse radius.
        w: R,
        /// dw/dψ.
        v: R,
        /// ½ dn²/dw.
        pull: R,
        /// Sine of the angle swept since it left.
        sin: f64,
        /// Its cosine.
        cos: f64,
        /// `Flies` on the way, `Leaves` at infinity, else the ray is to be followed by itself.
        status: FlightStatus,
    }
}

impl<R: Lane> Departure<R> {
    /// The start of the way.
    pub fn of(flight: &CurvedFlight<R>) -> Self {
        let &CurvedFlight { b, w, v, pull, .. } = flight;
        Self { b, w, v, pull, sin: 0.0, cos: 1.0, status: FlightStatus::Flies }
    }

    /// Phase of the ray on its orbit.
    #[inline(always)]
    pub fn phase(&self) -> Phase<R> {
        Phase { w: self.w, v: self.v, pull: self.pull }
    }
}
