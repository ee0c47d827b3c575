//! Rays that join two points among several holes at rest, as far as they are found; the holes are in the rows.

use std::f64::consts::PI;

use glam::DVec3;

use super::super::hole_columns::{HOLES, holes};
use super::super::input_error::{Input, InputError};
use super::super::lengths::Lengths;
use super::super::table::number_cell;
use super::form::{JoinForm, Joints, PointPair, X, Y};
use super::lens_cache::LensCache;
use super::shadow_edge::beside_shadows;
use super::windings::winding;
use crate::geodesic::{
    Dop853, FieldConnection, FieldControl, FieldEnd, FieldRays, FieldTarget, JoinLimits, alone,
    elapsed_in_field, follow_field,
};
use crate::light::FieldAim;
use crate::scene::Precision;
use crate::spacetime::SeveralHoles;

/// Form of the tables.
pub(super) static FORM: JoinForm = JoinForm {
    optional: &HOLES,
    results: &[
        "image",
        "images",
        "dx0",
        "dx1",
        "dx2",
        "dy0",
        "dy1",
        "dy2",
        "t",
        "G_xy",
        "G_yx",
        "nu_x_over_nu_y",
        "sens",
    ],
    join,
};

/// A ray from x to y.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FieldJoint {
    /// Unit direction at x, and of travel at y.
    directions: [DVec3; 2],
    /// Coordinate time, in the unit of length.
    time: f64,
    /// G_xy: solid angle at x over the proper area at y perpendicular to the ray, both of observers at rest.
    spread: f64,
    /// G_yx: that of the same ray followed back.
    reversed_spread: f64,
    /// Frequency that an observer at rest measures at x over that at y.
    frequency_ratio: f64,
    /// Largest change of the place at y across the ray, relative to |y − x|, per radian at x; at least 1.
    sens: f64,
}

/// Error of directions, radians.
const TOLERANCE: f64 = 1e-12;
/// Error of directions of rays that are looked for, and by how much they may miss their point, relative to the distance.
const ROUGH: f64 = 1e-6;
/// Distance by which a ray may miss its point, relative to that of the points.
const ENOUGH: f64 = 1e-12;
/// Correction of a direction, radians, that is taken without another look: what it leaves is its square.
const LINEAR: f64 = 1e-10;
/// Corrections of a direction at most.
const CORRECTIONS: u32 = 20;
/// Directions over the sphere from which rays are looked for, beside those that holes suggest.
const DIRECTIONS: u32 = 100;
/// Radius of the sphere at whose edge a ray is timed, relative to the distance of its points.
const TIMED: f64 = 1e-5;

/// The rays between the points of `pair` that wind about single holes by winding numbers up to `max_winding`, and others that
/// are met with, in the order of arrival.
///
/// # Errors
/// If there is no hole, a point is upon one, or both are the same.
fn join(_: &LensCache, pair: &PointPair, max_winding: u32) -> Result<Joints, InputError> {
    let lengths = Lengths::of(Precision::F64);
    let holes = holes(&pair.optional, &lengths)?;
    for hole in &holes {
        for (columns, point) in [(&X, pair.x), (&Y, pair.y)] {
            let what = "the distance of the point from a hole";
            lengths.check(Input::Columns(columns), what, point.distance(hole.center))?;
        }
    }
    lengths.check(Input::Both, "the distance between the points", pair.x.distance(pair.y))?;
    pair.check_apart()?;
    let field = SeveralHoles::new(&holes);
    let [rough, control] =
        [ROUGH, TOLERANCE].map(|tolerance| FieldControl::new(&field, 0.0, tolerance, f64::INFINITY));
    let limits = |part: f64, linear: f64| JoinLimits {
        enough: part * pair.x.distance(pair.y),
        linear,
        corrections: CORRECTIONS,
    };
    let (x, target) = (pair.x, FieldTarget::Place(pair.y));
    let aim = FieldAim::new(field.clone(), max_winding);
    let beside = beside_shadows(&field, &rough, x, max_winding);
    let guesses = aim.guesses(x, target).chain((0..DIRECTIONS).map(evenly)).chain(beside);
    let images = aim.images(&rough, (x, target), guesses, limits(ROUGH, 0.0));
    let winding = winding(&aim, &rough, [x, pair.y], max_winding);
    let directions = images.iter().map(|image| image.direction).chain(winding);
    let images = aim.images(&control, (x, target), directions, limits(ENOUGH, LINEAR));
    let mut found: Vec<FieldJoint> =
        images.iter().filter_map(|image| joint(&field, &control, pair, image)).collect();
    found.sort_by(|one, other| one.time.total_cmp(&other.time));
    let images = found.len();
    let found = found.iter().zip(1..).map(|(joint, image)| joint.cells(image, images)).collect();
    Ok(Joints { found, hidden: 0 })
}

/// Unit vector with this place among [`DIRECTIONS`] that lie evenly over the sphere, on a spiral.
fn evenly(place: u32) -> DVec3 {
    let golden = PI * (3.0 - 5f64.sqrt());
    let z = 1.0 - (2.0 * f64::from(place) + 1.0) / f64::from(DIRECTIONS);
    let (sin, cos) = libm::sincos(golden * f64::from(place));
    let rho = (1.0 - z * z).sqrt();
    DVec3::new(rho * cos, rho * sin, z)
}

/// The ray of a connection; `None` if it does not end where it should.
fn joint(
    field: &SeveralHoles,
    control: &FieldControl,
    &PointPair { x, y, .. }: &PointPair,
    image: &FieldConnection,
) -> Option<FieldJoint> {
    let [potential_x, potential_y] = [x, y].map(|point| field.potential(point));
    let frequency_ratio = potential_x / potential_y;
    let spread = image.geometry_factor() / (potential_y * potential_y);
    let [a, b] = image.turns;
    // Singular values of the change of direction with the place: the smaller one's inverse is the largest change of place.
    let (trace, product) = (a.length_squared() + b.length_squared(), a.cross(b).length_squared());
    let smaller = 2.0 * product / (trace + (trace * trace - 4.0 * product).max(0.0).sqrt());
    let (time, arrival) = timed(field, control, (x, y), image)?;
    Some(FieldJoint {
        directions: [image.direction, arrival],
        time,
        spread,
        reversed_spread: spread * frequency_ratio * frequency_ratio,
        frequency_ratio,
        sens: (1.0 / smaller.sqrt() / x.distance(y)).max(1.0),
    })
}

/// Coordinate time from x to y along a connection, and its unit direction there: to where it leaves a small sphere that ends
/// at y.
fn timed(
    field: &SeveralHoles,
    control: &FieldControl,
    (x, y): (DVec3, DVec3),
    image: &FieldConnection,
) -> Option<(f64, DVec3)> {
    let radius = TIMED * x.distance(y);
    let sphere = (y - radius * image.arrival, radius);
    let start = FieldRays::new(field, &alone(x), &alone(image.direction));
    let mut time = 0.0;
    let journey = follow_field(field, &Dop853, control, start, sphere, |start, step, h| {
        time += elapsed_in_field(field, start, step, h);
    });
    match journey.end {
        FieldEnd::Crosses(at, arrival) => {
            Some((time + field.potential(y).powi(2) * (y - at).dot(arrival), arrival))
        }
        FieldEnd::Falls(_) | FieldEnd::Misses | FieldEnd::StepLimit | FieldEnd::NonFinite => None,
    }
}

impl FieldJoint {
    /// Cells of the ray that arrives as the `image`th of all `images`.
    fn cells(&self, image: usize, images: usize) -> Vec<String> {
        let mut cells = vec![image.to_string(), images.to_string()];
        cells.extend(
            self.directions.map(|direction| direction.to_array()).into_iter().flatten().map(number_cell),
        );
        let Self { time, spread, reversed_spread, frequency_ratio, sens, .. } = *self;
        cells.extend([time, spread, reversed_spread, frequency_ratio, sens].map(number_cell));
        cells
    }
}
