//! The start of a ray around a spinning hole.

use super::flight::SpinningFlight;
use crate::geodesic::kerr::{Constants, KerrLaunch, MinoState, PlacedHole};
use crate::math::kernel::Kernel;
use crate::trace::flight_status::FlightStatus;
use crate::trace::launch_point::LaunchPoint;

/// Launches rays.
pub struct SpinningLaunches<'a>(pub &'a PlacedHole);

impl Kernel for SpinningLaunches<'_> {
    type A = LaunchPoint;
    type B = ();
    type Out = SpinningFlight;

    #[inline(always)]
    fn run(&self, start: &LaunchPoint, (): &()) -> SpinningFlight {
        let place = self.0;
        let position = start.position - place.center;
        let x = place.inwards(position * (1.0 / place.mass));
        let launch = KerrLaunch::at_rest(&place.hole, x, place.inwards(start.direction));
        let KerrLaunch { constants, state: MinoState { u, v, n, m } } = launch;
        let Constants { l, k, j2, k2, kappa, barrier } = constants;
        SpinningFlight {
            position,
            u,
            v,
            n,
            m,
            l,
            k,
            j2,
            k2,
            kappa,
            barrier,
            longest: f64::INFINITY,
            origin_prim: start.origin_prim,
            steps: 0,
            status: FlightStatus::Flies,
        }
    }
}
