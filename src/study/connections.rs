//! All rays that join two points in empty space around a centre, by how far they wind.
//!
//! Everything scales with the spacetime's length, so one lens serves all pairs whose spacetimes differ in nothing else.

use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;

use super::input_error::{Input, InputError};
use crate::geodesic::{Connection, Lens};
use crate::math::cross_exact;
use crate::spacetime::{ConformallyFlat, Metric, Range, SpacetimeKind};

/// Two points around a centre at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct PointPair {
    /// Spacetime around the origin.
    pub spacetime: SpacetimeKind,
    /// One point, isotropic coordinates.
    pub x: DVec3,
    /// The other.
    pub y: DVec3,
}

/// A ray from x to y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// It sweeps g, the angle between the points (0), 2π − g (1), 2π + g (2), and so on.
    pub winding: u32,
    /// Angle swept about the hole, radians.
    pub swept: f64,
    /// Impact parameter L/E, a length.
    pub b: f64,
    /// Unit direction at x.
    pub direction: DVec3,
    /// Unit direction of travel at y.
    pub arrival: DVec3,
    /// Coordinate time, in the unit of length.
    pub time: f64,
    /// G_xy: solid angle at x over the proper area at y perpendicular to the ray, both of observers at rest. Infinite
    /// in the ring of rays between opposite points.
    pub spread: f64,
    /// G_yx: the same the other way.
    pub reversed_spread: f64,
    /// Frequency that an observer at rest measures at x over that at y.
    pub frequency_ratio: f64,
    /// Radians of the swept angle per radian of direction at one end, the other point kept at its radius: the larger of
    /// both, and at least 1; 1 in flat space.
    pub swing: f64,
}

/// The rays between two points: of a form that its family of spacetimes has.
#[derive(Clone, Debug, PartialEq)]
pub struct Joints<J> {
    /// In the order of their winding, or of their arrival.
    pub found: Vec<J>,
    /// Number of further rays, which rounding hides.
    pub hidden: usize,
}

/// Columns of the points of a pair.
const X: [&str; 3] = ["x0", "x1", "x2"];
const Y: [&str; 3] = ["y0", "y1", "y2"];
/// Shortest and longest length whose powers are numbers.
const LENGTHS: [f64; 2] = [1e-70, 1e70];
/// Sine of an angle, or a distance relative to those from the hole, that is no more than rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Finds rays between points; keeps the lens of the last spacetime.
#[derive(Debug, Default)]
pub struct Joiner(Mutex<Option<(Metric, Arc<Lens>)>>);

impl Joiner {
    /// The lens of a spacetime in its own unit; `None` if it has no photon sphere.
    fn lens(&self, metric: Metric) -> Option<Arc<Lens>> {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match last.as_ref().filter(|(of, _)| *of == metric) {
            Some((_, lens)) => Some(lens.clone()),
            None => {
                let lens = Arc::new(Lens::new(&metric, f64::EPSILON)?);
                *last = Some((metric, lens.clone()));
                Some(lens)
            }
        }
    }

    /// The rays between the points of `pair` of winding orders up to `max_winding`.
    ///
    /// Points on a line through the hole, to rounding, are joined by the radial ray if they are on the same side of it,
    /// and otherwise by a ring of rays that sweep π, for which one stands; rings that wind farther are left out, and so
    /// is all but the straight ray in flat space.
    ///
    /// # Errors
    /// If a point is not outside the horizon, both are the same, or a number is not finite or beyond what squares can
    /// hold.
    pub fn join(&self, pair: &PointPair, max_winding: u32) -> Result<Joints<Joint>, InputError> {
        let &PointPair { ref spacetime, x, y } = pair;
        let [least, most] = LENGTHS;
        let length = |input, what: &str, length: f64, also: &str| {
            if (least..=most).contains(&length) {
                return Ok(());
            }
            let remedy = format!("give a length above 0, from {least:e} to {most:e}{also}");
            Err(InputError { input, cause: format!("{what} is {length}"), remedy })
        };
        length(Input::Both, "the distance between the points", x.distance(y), "")?;
        let same = x.distance(y) <= ROUNDING * x.length().max(y.length());
        if same {
            let cause = "the points are the same to rounding".to_owned();
            return Err(InputError { input: Input::Both, cause, remedy: "give two points".to_owned() });
        }
        let spin = cross_exact::cross(x, y).length();
        for (parameter, value) in spacetime.parameters() {
            let input = Input::Parameter(parameter.column);
            if let Some((cause, remedy)) = parameter.out_of_bounds(value) {
                return Err(InputError { input, cause, remedy });
            }
            if parameter.range == Range::Length {
                length(input, parameter.noun, value, ", or 0 for flat space")?;
            }
        }
        let Some((metric, unit)) = spacetime.in_units() else {
            if !spacetime.is_flat() {
                let cause =
                    format!("rays between points in a {} are not looked for", spacetime.entry().title);
                let remedy = "give another --spacetime".to_owned();
                return Err(InputError { input: Input::Both, cause, remedy });
            }
            return Ok(Joints { found: vec![straight(x, y, spin)], hidden: 0 });
        };
        let Some(lens) = self.lens(metric) else {
            let cause = format!("a spacetime of kind {} has no photon sphere", spacetime.entry().name);
            let remedy = "give another --spacetime".to_owned();
            return Err(InputError { input: Input::Both, cause, remedy });
        };
        for (input, point) in [(Input::Columns(&X), x), (Input::Columns(&Y), y)] {
            let (rho, horizon) = (point.length() / unit, metric.horizon());
            if rho <= horizon * (1.0 + ROUNDING) {
                return Err(InputError {
                    input,
                    cause: format!(
                        "the point is at the isotropic radius {}, but the horizon is at {}",
                        rho * unit,
                        horizon * unit
                    ),
                    remedy: "give a point outside the horizon; the isotropic radius is not the areal one"
                        .to_owned(),
                });
            }
            length(
                input,
                "the distance of the point from the centre, in units of the spacetime's length,",
                rho,
                "",
            )?;
        }
        let aligned = spin <= ROUNDING * x.length() * y.length();
        let highest = if aligned { 0 } else { max_winding };
        let found: Vec<Joint> = (0..=highest)
            .filter_map(|winding| joint((x, y), (&metric, unit), &lens, winding, aligned))
            .collect();
        Ok(Joints { hidden: highest as usize + 1 - found.len(), found })
    }
}

/// The ray of one winding order between points around a spacetime, given in its `unit`.
fn joint(
    (x, y): (DVec3, DVec3),
    (metric, unit): (&Metric, f64),
    lens: &Lens,
    winding: u32,
    aligned: bool,
) -> Option<Joint> {
    let [at_x, at_y] = [x, y].map(|point| lens.site(metric, point / unit));
    let found = lens.connect(&at_x, &at_y, winding)?;
    let time = unit * lens.time(&at_x, &at_y, &found);
    let Connection { direction, arrival, swept, b, geometry_factor: spread, swing, .. } = found;
    let [w_x, w_y] = [x, y].map(|point| unit / point.length());
    let lapses = [w_x, w_y].map(|w| metric.lapse(w));
    // Proper length over coordinate length is Ψ = n N.
    let stretch = metric.index_squared(w_y) * lapses[1] * lapses[1];
    let frequency_ratio = lapses[1] / lapses[0];
    let radial = aligned && x.dot(y) > 0.0;
    let ring = aligned && !radial;
    let spread = if ring { f64::INFINITY } else { spread / stretch / unit / unit };
    Some(Joint {
        winding,
        swept: if radial { 0.0 } else { swept },
        b: if radial { 0.0 } else { b * unit },
        direction,
        arrival,
        time,
        spread,
        reversed_spread: spread * frequency_ratio * frequency_ratio,
        frequency_ratio,
        swing: swing[0].max(swing[1]).max(1.0),
    })
}
/// The ray between two points of flat space, given |x × y|.
fn straight(x: DVec3, y: DVec3, spin: f64) -> Joint {
    let distance = x.distance(y);
    let direction = (y - x) / distance;
    let spread = 1.0 / (distance * distance);
    Joint {
        winding: 0,
        swept: libm::atan2(spin, x.dot(y)),
        b: spin / distance,
        direction,
        arrival: direction,
        time: distance,
        spread,
        reversed_spread: spread,
        frequency_ratio: 1.0,
        swing: 1.0,
    }
}
