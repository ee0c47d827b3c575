//! All rays that join two points around a centre, by how far they wind; through a wormhole, too, whose far side is within the
//! throat of the near one's chart.

use glam::DVec3;

use super::super::free::other_chart;
use super::super::input_error::{Input, InputError};
use super::super::lengths::{Lengths, check_together};
use super::super::table::number_cell;
use super::form::{JoinForm, Joints, PointPair, ROUNDING, X, Y};
use super::lens_cache::LensCache;
use crate::geodesic::{Connection, Lens, Site};
use crate::math::cross_exact;
use crate::scene::Precision;
use crate::spacetime::{
    ConformallyFlat, IndexField, KerrNewman, Mouths, Placement, SpacetimeKind, SpacetimeVisitor,
};

/// Form of the tables.
pub(super) static FORM: JoinForm = JoinForm {
    optional: &[],
    results: &[
        "winding",
        "Phi",
        "b",
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
        "swing",
    ],
    join,
};

/// A ray from x to y.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CentralJoint {
    /// It sweeps g, the angle between the points (0), 2π − g (1), 2π + g (2), and so on.
    winding: u32,
    /// Angle swept about the centre, radians.
    swept: f64,
    /// Impact parameter L/E, a length.
    b: f64,
    /// Unit direction at x.
    direction: DVec3,
    /// Unit direction of travel at y.
    arrival: DVec3,
    /// Coordinate time, in the unit of length.
    time: f64,
    /// G_xy: solid angle at x over the proper area at y perpendicular to the ray, both of observers at rest. Infinite
    /// in the ring of rays between opposite points.
    spread: f64,
    /// G_yx: the same the other way.
    reversed_spread: f64,
    /// Frequency that an observer at rest measures at x over that at y.
    frequency_ratio: f64,
    /// Radians of the swept angle per radian of direction at one end, the other point kept at its radius: the larger of
    /// both, and at least 1; 1 in flat space.
    swing: f64,
}

/// The rays between the points of `pair` of winding orders up to `max_winding`.
///
/// Points on a line through the centre, to rounding, are joined by the radial ray if they are on the same side of it,
/// and otherwise by a ring of rays that sweep π, for which one stands; rings that wind farther are left out, and so
/// is all but the straight ray in flat space.
///
/// # Errors
/// If a point is not outside the horizon, both are the same, or a number is not finite or beyond what squares can
/// hold.
fn join(lenses: &LensCache, pair: &PointPair, max_winding: u32) -> Result<Joints, InputError> {
    let &PointPair { ref spacetime, x, y, .. } = pair;
    let lengths = Lengths::of(Precision::F64);
    lengths.check(Input::Both, "the distance between the points", x.distance(y))?;
    pair.check_apart()?;
    lengths.check_parameters(spacetime)?;
    check_together(spacetime, Input::Spacetime)?;
    let spin = cross_exact::cross(x, y).length();
    let Some((kind, unit)) = spacetime.in_units() else {
        return Ok(Joints { found: vec![straight(x, y, spin).cells()], hidden: 0 });
    };
    let aligned = spin <= ROUNDING * x.length() * y.length();
    kind.visit(Joining { kind: &kind, unit, pair, lengths, lenses, max_winding, aligned })
}

/// The ray between two points of flat space, given |x × y|.
fn straight(x: DVec3, y: DVec3, spin: f64) -> CentralJoint {
    let distance = x.distance(y);
    let direction = (y - x) / distance;
    let spread = 1.0 / (distance * distance);
    CentralJoint {
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

/// The rays between two points around a centre.
struct Joining<'a> {
    /// The spacetime in its own unit.
    kind: &'a SpacetimeKind,
    unit: f64,
    pair: &'a PointPair,
    lengths: Lengths,
    lenses: &'a LensCache,
    max_winding: u32,
    /// True of points on a line through the centre.
    aligned: bool,
}

impl Joining<'_> {
    fn around<M: ConformallyFlat>(&self, medium: &M) -> Result<Joints, InputError> {
        let PointPair { x, y, .. } = self.pair;
        let Some(lens) = self.lenses.of(self.kind, medium) else {
            let cause = format!("a spacetime of kind {} has no photon sphere", self.kind.entry().name);
            let remedy = "give another --spacetime".to_owned();
            return Err(InputError { input: Input::Spacetime, cause, remedy });
        };
        for (input, point) in [(Input::Columns(&X), x), (Input::Columns(&Y), y)] {
            self.check_outside(input, point.length(), medium.horizon())?;
        }
        let highest = if self.aligned { 0 } else { self.max_winding };
        let found: Vec<Vec<String>> = (0..=highest)
            .filter_map(|winding| self.joint(medium, &lens, winding))
            .map(|joint| joint.cells())
            .collect();
        Ok(Joints { hidden: highest as usize + 1 - found.len(), found })
    }

    /// Refuses a point that is not outside the horizon, or too far.
    fn check_outside(&self, input: Input, radius: f64, horizon: f64) -> Result<(), InputError> {
        let rho = radius / self.unit;
        if horizon > 0.0 && rho <= horizon * (1.0 + ROUNDING) {
            return Err(InputError {
                input,
                cause: format!(
                    "the point is at the isotropic radius {}, but the horizon is at {}",
                    rho * self.unit,
                    horizon * self.unit
                ),
                remedy: "give a point outside the horizon; the isotropic radius is not the areal one"
                    .to_owned(),
            });
        }
        let what = "the distance of the point from the centre, in units of the spacetime's length,";
        self.lengths.check(input, what, rho)
    }

    /// The ray of one winding order.
    fn joint<M: ConformallyFlat>(&self, medium: &M, lens: &Lens, winding: u32) -> Option<CentralJoint> {
        let (unit, ends) = (self.unit, [self.pair.x, self.pair.y]);
        let [(at_x, _), (at_y, w)] = ends.map(|point| site(medium, lens, point / unit));
        let found = lens.connect(&at_x, &at_y, winding)?;
        let time = unit * lens.time(&at_x, &at_y, &found);
        let Connection { direction, arrival, swept, b, geometry_factor: spread, swing, .. } = found;
        let lapses = ends.map(|point| medium.lapse(unit / point.length()));
        // Proper length over coordinate length is Ψ = n N.
        let stretch = medium.index_squared(w) * lapses[1] * lapses[1];
        let frequency_ratio = lapses[1] / lapses[0];
        let radial = self.aligned && ends[0].dot(ends[1]) > 0.0;
        let ring = self.aligned && !radial;
        let spread = if ring { f64::INFINITY } else { spread / stretch / unit / unit };
        Some(CentralJoint {
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
}

/// The place of a point, and its inverse radius in the chart of its own side of a throat, which is where areas are told.
fn site<M: ConformallyFlat>(medium: &M, lens: &Lens, point: DVec3) -> (Site, f64) {
    let (radius, throat) = (point.length(), medium.throat());
    if radius >= throat {
        return (lens.site(medium, point), 1.0 / radius);
    }
    let radial = point / radius;
    let beyond = throat * throat / radius;
    (lens.site(medium, beyond * radial).beyond_throat(radial), 1.0 / beyond)
}

impl SpacetimeVisitor for Joining<'_> {
    type Output = Result<Joints, InputError>;

    fn flat(self) -> Self::Output {
        Err(other_chart("isotropic"))
    }

    fn spherical<M: ConformallyFlat>(self, _: DVec3, medium: M) -> Self::Output {
        self.around(&medium)
    }

    fn wormhole<M: ConformallyFlat>(self, _: Mouths, medium: M) -> Self::Output {
        self.around(&medium)
    }

    fn indexed<F: IndexField>(self, _: &F) -> Self::Output {
        Err(other_chart("isotropic"))
    }

    fn spinning(self, _: Placement, _: KerrNewman) -> Self::Output {
        Err(other_chart("isotropic"))
    }
}

impl CentralJoint {
    fn cells(&self) -> Vec<String> {
        let Self { direction: dx, arrival: dy, .. } = self;
        let mut cells = vec![self.winding.to_string()];
        cells.extend([self.swept, self.b].map(number_cell));
        cells.extend([dx, dy].map(|direction| direction.to_array()).into_iter().flatten().map(number_cell));
        let Self { time, spread, reversed_spread, frequency_ratio, swing, .. } = *self;
        cells.extend([time, spread, reversed_spread, frequency_ratio, swing].map(number_cell));
        cells
    }
}
