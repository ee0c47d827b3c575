//! Rays that join two points in empty space around a spinning hole, as far as they are found.
//!
//! Points are in the chart of tables: ingoing Cartesian Kerr–Schild coordinates, the spin along z.

use std::f64::consts::PI;

use glam::DVec3;

use super::connections::{Joints, PointPair};
use super::free::spinning::spinning_hole;
use super::input_error::{Input, InputError};
use crate::geodesic::kerr::{KerrConnection, KerrConnector, KerrPlace, UnitHole};

/// A ray from x to y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpinningJoint {
    /// Unit direction at x, and of travel at y, in the frames at rest.
    pub directions: [DVec3; 2],
    /// Covariant momenta at x and y.
    pub momenta: [DVec3; 2],
    /// Kerr–Schild time from x to y, in the unit of length.
    pub time: f64,
    /// G_xy: solid angle at x over the proper area at y perpendicular to the ray, both of observers at rest.
    pub spread: f64,
    /// G_yx: that of the same ray followed back.
    pub reversed_spread: f64,
    /// Frequency that an observer at rest measures at x over that at y.
    pub frequency_ratio: f64,
    /// Angle through which the direction from the hole to the ray turns, radians.
    pub swept: f64,
    /// Largest change of the place at y across the ray, relative to |y|, per radian at x; at least 1.
    pub sens: f64,
}

/// Columns of the points of a pair.
const X: [&str; 3] = ["x0", "x1", "x2"];
const Y: [&str; 3] = ["y0", "y1", "y2"];
/// Error of directions, radians: rounding.
const TOLERANCE: f64 = 1e-13;
/// Azimuths around the hole from which rays are looked for.
const AZIMUTHS: u32 = 32;
/// Highest winding whose rays are looked for.
const HIGHEST: u32 = 1;
/// Distance of points that are one, relative to the radius.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The rays between the points of `pair` that turn by less than `max_winding` + 1 half turns about the hole, of two at
/// most, in the order of arrival.
///
/// # Errors
/// If the hole has no size or no horizon, a point is where nothing is at rest, or both are the same.
pub fn join(pair: &PointPair, max_winding: u32) -> Result<Joints<SpinningJoint>, InputError> {
    let kerr_newman = spinning_hole(&pair.spacetime)?;
    let mass = kerr_newman.mass();
    let hole = UnitHole::new(kerr_newman.spin(), kerr_newman.charge());
    let [x, y] = [pair.x, pair.y].map(|point| point / mass);
    for (columns, point) in [(&X, x), (&Y, y)] {
        let (r, n) = hole.spheroidal(point);
        if !(r * hole.horizon > 1.0 && hole.potential(r, n.z) < 1.0 && point.length_squared() < f64::INFINITY)
        {
            return Err(InputError {
                input: Input::Columns(columns),
                cause: "nothing is at rest at the point: it is in the ergosphere, or too far".to_owned(),
                remedy: "give a point outside the ergosphere".to_owned(),
            });
        }
    }
    if x.distance(y) <= ROUNDING * x.length().max(y.length()) {
        return Err(InputError {
            input: Input::Both,
            cause: "the points are the same to rounding".to_owned(),
            remedy: "give two points".to_owned(),
        });
    }
    let (from, to) = (KerrPlace::new(&hole, x), KerrPlace::new(&hole, y));
    let connector = KerrConnector { hole: &hole, from: &from, to: &to, tolerance: TOLERANCE };
    let lapse = |place: &KerrPlace| (1.0 - hole.potential(place.r, place.n.z)).sqrt();
    let frequency_ratio = lapse(&to) / lapse(&from);
    let joint = |ray: &KerrConnection| {
        let (time, swept) = ray.time_and_swept(&hole, &from);
        let spread = ray.geometry_factor / (mass * mass);
        SpinningJoint {
            directions: [ray.direction, ray.arrival],
            momenta: ray.momenta,
            time: mass * time,
            spread,
            reversed_spread: spread * frequency_ratio * frequency_ratio,
            frequency_ratio,
            swept,
            sens: ray.swing.max(1.0),
        }
    };
    let widest = PI * f64::from(max_winding.min(HIGHEST) + 1);
    let rays = connector.all(AZIMUTHS);
    let mut found: Vec<SpinningJoint> = rays.iter().map(joint).filter(|joint| joint.swept < widest).collect();
    found.sort_by(|one, other| one.time.total_cmp(&other.time));
    Ok(Joints { found, hidden: 0 })
}
