//! All rays that join two points in empty space around a hole, by how far they wind.
//!
//! Everything scales with the Schwarzschild radius, so one lens of radius 1 serves all.

use glam::DVec3;

use crate::geodesic::{Connection, Lens};
use crate::math::exact;
use crate::spacetime::{ConformallyFlat, Schwarzschild};

/// Two points around a hole at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// r_s; 0 is flat.
    pub schwarzschild_radius: f64,
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
    /// G_xy: solid angle at x over the proper area at y perpendicular to the ray, both of observers at rest. Infinite in
    /// the ring of rays between opposite points.
    pub spread: f64,
    /// G_yx: the same the other way.
    pub reversed_spread: f64,
    /// Frequency that an observer at rest measures at x over that at y.
    pub frequency_ratio: f64,
    /// Radians of the swept angle per radian of direction at one end, the other point kept at its radius: the larger of
    /// both, and at least 1; 1 in flat space.
    pub swing: f64,
}

/// The rays between two points.
#[derive(Clone, Debug, PartialEq)]
pub struct Joints {
    /// In the order of their winding.
    pub found: Vec<Joint>,
    /// How many more there are, which rounding hides.
    pub hidden: usize,
}

/// Why there are no rays between two points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{cause}")]
pub struct Fault {
    /// What is at fault.
    pub input: Input,
    /// What is wrong with it.
    pub cause: String,
    /// What to do about it.
    pub remedy: String,
}

/// Something that describes a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// The Schwarzschild radius.
    SchwarzschildRadius,
    /// The point x.
    X,
    /// The point y.
    Y,
    /// How the points lie to each other.
    Both,
}

/// Shortest and longest length whose powers are numbers.
const LENGTHS: [f64; 2] = [1e-70, 1e70];
/// Sine of an angle, or a distance relative to those from the hole, that is no more than rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// What finds rays between points.
#[derive(Clone, Debug)]
pub struct Joiner {
    hole: Schwarzschild,
    lens: Lens,
}

impl Joiner {
    /// One whose errors are those of rounding; always there, as a hole has a photon sphere.
    pub fn new() -> Option<Self> {
        let hole = Schwarzschild::new(1.0);
        Some(Self { hole, lens: Lens::new(&hole, f64::EPSILON)? })
    }

    /// The rays between the points of `pair` of winding orders up to `max_winding`.
    ///
    /// Points on a line through the hole, to rounding, are joined by the radial ray if they are on the same side of it, and
    /// otherwise by a ring of rays that sweep π, for which one stands; rings that wind farther are left out, and so is all
    /// but the straight ray in flat space.
    ///
    /// # Errors
    /// If a point is not outside the horizon, both are the same, or a number is not finite or beyond what squares can hold.
    pub fn join(&self, pair: &Pair, max_winding: u32) -> Result<Joints, Fault> {
        let Pair { schwarzschild_radius: r_s, x, y } = *pair;
        let [least, most] = LENGTHS;
        let length = |input, what: &str, length: f64, also: &str| {
            if (least..=most).contains(&length) {
                return Ok(length);
            }
            let remedy = format!("give a length above 0, from {least:e} to {most:e}{also}");
            Err(Fault { input, cause: format!("{what} is {length}"), remedy })
        };
        length(Input::Both, "the distance between the points", x.distance(y), "")?;
        let same = x.distance(y) <= ROUNDING * x.length().max(y.length());
        if same {
            let cause = "the points are the same to rounding".to_owned();
            return Err(Fault { input: Input::Both, cause, remedy: "give two points".to_owned() });
        }
        let spin = exact::cross(x, y).length();
        if r_s == 0.0 {
            return Ok(Joints { found: vec![straight(x, y, spin)], hidden: 0 });
        }
        length(Input::SchwarzschildRadius, "the Schwarzschild radius", r_s, ", or 0 for flat space")?;
        for (input, point) in [(Input::X, x), (Input::Y, y)] {
            let (rho, horizon) = (point.length() / r_s, self.hole.horizon());
            if rho <= horizon * (1.0 + ROUNDING) {
                return Err(Fault {
                    input,
                    cause: format!(
                        "the point is at the isotropic radius {}, but the horizon is at {}",
                        rho * r_s,
                        horizon * r_s
                    ),
                    remedy: "give a point outside the horizon; the isotropic radius is not the areal one"
                        .to_owned(),
                });
            }
            length(input, "the distance of the point from the hole, in Schwarzschild radii,", rho, "")?;
        }
        let aligned = spin <= ROUNDING * x.length() * y.length();
        let highest = if aligned { 0 } else { max_winding };
        let found: Vec<Joint> =
            (0..=highest).filter_map(|winding| self.joint(pair, winding, aligned)).collect();
        Ok(Joints { hidden: highest as usize + 1 - found.len(), found })
    }

    /// The ray of one winding order.
    fn joint(&self, pair: &Pair, winding: u32, aligned: bool) -> Option<Joint> {
        let Pair { schwarzschild_radius: r_s, x, y } = *pair;
        let [at_x, at_y] = [x, y].map(|point| self.lens.site(&self.hole, point / r_s));
        let found = self.lens.connect(&at_x, &at_y, winding)?;
        let time = r_s * self.lens.time(&at_x, &at_y, &found);
        let Connection { direction, arrival, swept, b, spread, swing, .. } = found;
        let [w_x, w_y] = [x, y].map(|point| r_s / point.length());
        let lapses = [w_x, w_y].map(|w| self.hole.lapse(w));
        // Proper length over coordinate length is Ψ = n N.
        let stretch = self.hole.index_squared(w_y) * lapses[1] * lapses[1];
        let frequency_ratio = lapses[1] / lapses[0];
        let radial = aligned && x.dot(y) > 0.0;
        let ring = aligned && !radial;
        let spread = if ring { f64::INFINITY } else { spread / stretch / r_s / r_s };
        Some(Joint {
            winding,
            swept: if radial { 0.0 } else { swept },
            b: if radial { 0.0 } else { b * r_s },
            direction,
            arrival,
            time,
            spread,
            reversed_spread: spread * frequency_ratio * frequency_ratio,
            frequency_ratio,
            swing: swing[0].max(swing[1]).max(1.0),
        })
    }
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
