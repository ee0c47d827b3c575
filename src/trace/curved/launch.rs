//! The start of a curved ray: the plane of its orbit, its constants, and a first step.

use super::flight::{CurvedFlight, Lane};
use super::rays::Curved;
use super::worlds::Worlds;
use crate::geodesic::{Launch, Phase};
use crate::math::kernel::Kernel;
use crate::spacetime::ConformallyFlat;
use crate::trace::flight_status::FlightStatus;
use crate::trace::launch_point::LaunchPoint;

/// Launches rays.
pub struct Launching<'a, M, R, W> {
    curved: &'a Curved<M, R, W>,
    /// Order of the stepper's estimate.
    order: u32,
}

impl<'a, M: ConformallyFlat, R: Lane, W: Worlds<M>> Launching<'a, M, R, W> {
    /// For rays of this transport.
    pub fn of(curved: &'a Curved<M, R, W>) -> Self {
        Self { curved, order: curved.march.order() }
    }
}

impl<M: ConformallyFlat, R: Lane, W: Worlds<M>> Kernel for Launching<'_, M, R, W> {
    type A = LaunchPoint;
    type B = ();
    type Out = CurvedFlight<R>;

    #[inline(always)]
    fn run(&self, start: &LaunchPoint, (): &()) -> CurvedFlight<R> {
        let Self { curved: Curved { medium, worlds, control, .. }, order } = self;
        let position = start.position - worlds.of(start.origin_prim).center;
        let Launch { radial, along, b, w, v, fate } =
            Launch::new(medium, position, start.direction, R::EPSILON);
        let (b, phase) = (R::of(b), Phase::new(medium, R::of(w), R::of(v)));
        let h = control.first_step(medium, *order, b, &phase);
        CurvedFlight {
            position,
            radial,
            along,
            b,
            w: phase.w,
            v: phase.v,
            pull: phase.pull,
            h: self.curved.within(h, b, &phase),
            error: R::of(1.0),
            fate,
            origin_prim: start.origin_prim,
            steps: 0,
            status: FlightStatus::Flies,
        }
    }
}
