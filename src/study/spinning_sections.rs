//! Sections of a spinning hole by a plane through its centre: horizon, ergosphere, photon orbits; and ways out of the
//! picture of its rays, for a fan.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::geodesic::kerr::{KerrLaunch, SeriesControl, UnitHole, dense_displacement, follow_by};
use crate::spacetime::{KerrNewman, Placement, RestFrame};

/// Points of a section.
const CORNERS: u32 = 256;
/// Pieces of a step along a way out.
const PIECES: u32 = 24;
/// Largest radius of the surfaces around a hole, in units of its mass: of photon orbits it is 4.
const LARGEST: f64 = 8.0;
/// Coefficients of the series that follow a way out, and their tolerance, radians.
const POWERS: usize = 10;
const PRECISION: f64 = 1e-7;

/// A spinning hole in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpinningHole {
    pub(super) placement: Placement,
    pub(super) hole: KerrNewman,
}

impl SpinningHole {
    /// Section of the horizon by the plane of the world directions `axes`, relative to the centre.
    pub(super) fn horizon(&self, axes: [DVec3; 2]) -> Vec<[f64; 2]> {
        let horizon = self.hole.horizon();
        self.section(axes, |x| self.hole.radius(x) < horizon)
    }

    /// Section of the ergosphere.
    pub(super) fn ergosphere(&self, axes: [DVec3; 2]) -> Vec<[f64; 2]> {
        self.section(axes, |x| self.hole.drags(x))
    }

    /// Sections of the spheroids between which photons can orbit.
    pub(super) fn photon_orbits(&self, axes: [DVec3; 2]) -> Vec<Vec<[f64; 2]>> {
        let section = |r: f64| self.section(axes, |x| self.hole.radius(x) < r);
        self.hole.photon_orbits().map(section).to_vec()
    }

    /// The outline of what is `inside`, a star-shaped body.
    fn section(&self, [right, up]: [DVec3; 2], inside: impl Fn(DVec3) -> bool) -> Vec<[f64; 2]> {
        let rotation = self.placement.rotation();
        let point = |index: u32| {
            let (sin, cos) = libm::sincos(TAU * f64::from(index) / f64::from(CORNERS));
            let direction = rotation * (cos * right + sin * up);
            let (mut low, mut high) = (0.0, LARGEST * self.hole.mass());
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if inside(middle * direction) { low = middle } else { high = middle }
            }
            [low * cos, low * sin]
        };
        (0..=CORNERS).map(point).collect()
    }

    /// World points of the ray that leaves `start` outwards along the chart's tangent `heading`, up to the radius `reach`.
    pub(super) fn way_out(&self, start: DVec3, heading: DVec3, reach: f64) -> Vec<DVec3> {
        let Self { placement, hole } = self;
        let (unit, mass, rotation) = (UnitHole::reversed(hole), hole.mass(), placement.rotation());
        let seen = RestFrame::spinning(*placement, *hole).direction(start, heading);
        let launch = KerrLaunch::at_rest(&unit, placement.local(start) / mass, rotation * seen);
        let control = SeriesControl::new(POWERS, PRECISION);
        let mut points = Vec::new();
        follow_by::<POWERS>(&unit, &launch, &control, mass / reach, |series, h| {
            let from = unit.position(series.start.u, series.start.n);
            points.extend((1..=PIECES).map(|piece| {
                let part = h * f64::from(piece) / f64::from(PIECES);
                let x = from + dense_displacement(&unit, series, part);
                placement.center + mass * (rotation.transpose() * x)
            }));
        });
        points
    }
}
