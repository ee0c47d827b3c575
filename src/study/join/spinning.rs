//! Rays that join two points in empty space around a spinning hole, as far as they are found.
//!
//! Points are in the chart of tables: ingoing Cartesian Kerr–Schild coordinates, the spin along z.

use std::f64::consts::PI;

use glam::DVec3;

use super::super::free::spinning::spinning_hole;
use super::super::input_error::{Input, InputError};
use super::super::table::number_cell;
use super::form::{JoinForm, Joints, PointPair, X, Y};
use super::lens_cache::LensCache;
use crate::geodesic::kerr::{KerrConnection, KerrConnector, KerrPlace, UnitHole};

/// Form of the tables.
pub(super) static FORM: JoinForm = JoinForm {
    optional: &[],
    results: &[
        "image",
        "images",
        "dx0",
        "dx1",
        "dx2",
        "px0",
        "px1",
        "px2",
        "dy0",
        "dy1",
        "dy2",
        "py0",
        "py1",
        "py2",
        "t",
        "G_xy",
        "G_yx",
        "nu_x_over_nu_y",
        "swept",
        "sens",
    ],
    join,
};

/// A ray from x to y.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SpinningJoint {
    /// Unit direction at x, and of travel at y, in the frames at rest.
    directions: [DVec3; 2],
    /// Covariant momenta at x and y.
    momenta: [DVec3; 2],
    /// Kerr–Schild time from x to y, in the unit of length.
    time: f64,
    /// G_xy: solid angle at x over the proper area at y perpendicular to the ray, both of observers at rest.
    spread: f64,
    /// G_yx: that of the same ray followed back.
    reversed_spread: f64,
    /// Frequency that an observer at rest measures at x over that at y.
    frequency_ratio: f64,
    /// Angle through which the direction from the hole to the ray turns, radians.
    swept: f64,
    /// Largest change of the place at y across the ray, relative to |y|, per radian at x; at least 1.
    sens: f64,
}

/// Error of directions, radians: rounding.
const TOLERANCE: f64 = 1e-13;
/// Azimuths around the hole from which rays are looked for.
const AZIMUTHS: u32 = 32;
/// Highest winding whose rays are looked for.
const HIGHEST: u32 = 1;

/// The rays between the points of `pair` that turn by less than `max_winding` + 1 half turns about the hole, of two at
/// most, in the order of arrival.
///
/// # Errors
/// If the hole has no size or no horizon, a point is where nothing is at rest, or both are the same.
fn join(_: &LensCache, pair: &PointPair, max_winding: u32) -> Result<Joints, InputError> {
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
    pair.check_apart()?;
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
    let images = found.len();
    let found = found.iter().zip(1..).map(|(joint, image)| joint.cells(image, images)).collect();
    Ok(Joints { found, hidden: 0 })
}

impl SpinningJoint {
    /// Cells of the ray that arrives as the `image`th of all `images`.
    fn cells(&self, image: usize, images: usize) -> Vec<String> {
        let Self { directions: [dx, dy], momenta: [px, py], .. } = self;
        let mut cells = vec![image.to_string(), images.to_string()];
        let vectors = [dx, px, dy, py].map(|vector| vector.to_array());
        cells.extend(vectors.into_iter().flatten().map(number_cell));
        let Self { time, spread, reversed_spread, frequency_ratio, swept, sens, .. } = *self;
        cells.extend([time, spread, reversed_spread, frequency_ratio, swept, sens].map(number_cell));
        cells
    }
}
