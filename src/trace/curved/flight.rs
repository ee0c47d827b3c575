//! A curved ray in flight, and one step of it.

use glam::DVec3;

use crate::geodesic::Phase;
use crate::geometry::PrimitiveId;
use crate::math::columns::{Field, LANES, columns, plain_field};
use crate::math::real::Real;
use crate::spacetime::Fate;
use crate::trace::flight_status::FlightStatus;

/// A number that columns can hold.
pub trait Lane: Real + Field<Block<LANES>: Send> {}
impl<R: Real + Field<Block<LANES>: Send>> Lane for R {}

plain_field!(Fate);

columns! {
    /// A curved ray.
    pub struct CurvedFlight<R> => CurvedFlightBlock {
        /// Position, relative to the spacetime's centre.
        position: DVec3,
        /// Unit vector from the centre to the position.
        radial: DVec3,
        /// Unit vector across it in the orbit's plane, in the sense of motion.
        along: DVec3,
        /// Impact parameter.
        b: R,
        /// Inverse radius.
        w: R,
        /// dw/dψ.
        v: R,
        /// ½ dn²/dw.
        pull: R,
        /// Length in ξ to try next.
        h: R,
        /// Relative error of the step before.
        error: R,
        /// Fate of the ray if nothing is in its way.
        fate: Fate,
        /// Primitive that the position lies on, until the first step is taken.
        origin_prim: PrimitiveId,
        /// Steps so far, rejected ones included.
        steps: u32,
        /// State after the last of them.
        status: FlightStatus,
    }
}

columns! {
    /// One step of a curved ray; places from its start, along the radius there and across it.
    pub struct CurvedMove<R> => CurvedMoveBlock {
        /// Inverse radius at the end.
        w: R,
        /// dw/dψ at the end.
        v: R,
        /// Length in ξ.
        h: R,
        /// ½ dn²/dw at the end.
        pull: R,
        /// End, outwards.
        end_x: R,
        /// End, across.
        end_y: R,
        /// Middle control point of the arc, outwards.
        middle_x: R,
        /// Middle control point of the arc, across.
        middle_y: R,
        /// Its weight.
        weight: R,
        /// Length in ξ to try next.
        next_h: R,
        /// Relative error.
        error: R,
        /// True if the arc is so near the ray that a hit on the arc is where the ray has it.
        is_close: bool,
        /// True if the step is good enough to be taken.
        accepted: bool,
    }
}

impl<R: Lane> CurvedFlight<R> {
    /// Phase of the ray on its orbit.
    #[inline(always)]
    pub fn phase(&self) -> Phase<R> {
        Phase { w: self.w, v: self.v, pull: self.pull }
    }

    /// Unit direction of travel.
    pub fn direction(&self) -> DVec3 {
        self.place(-self.v, self.b * self.w).normalize()
    }

    /// A vector in the orbit's plane, from components along the radius and across it.
    #[inline(always)]
    pub fn place(&self, outwards: R, across: R) -> DVec3 {
        outwards.value() * self.radial + across.value() * self.along
    }
}
