//! Table of the orbits that join two places around a spinning hole, to first order in the spin: by the radii of both
//! and the angle between them.
//!
//! What depends on the plane of the orbit, its tilt and how far from the equator it starts, is expanded: a few planes are
//! solved for each entry. Entries hold what is left of two closed forms that are good where the places are close to each
//! other or far from the hole, so that they change little from one to the next:
//!
//! - In isotropic coordinates, rays from the radius ρ at the angle β to falling that are bent weakly leave at the angle
//!   β + (2/ρ) tan(s/2), in units of the mass, if they sweep s: this is exact to first order in the mass. Behind the
//!   hole it is the larger root of Einstein's lens equation that is finite.
//! - Of the winding about the axis, what belongs to the chart: a ∫ du/D.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use glam::DVec3;

use super::aim::{KerrPlace, PlaneGuess, solve, turned};
use super::hole::UnitHole;

/// Table of orbits around a hole.
pub struct OrbitTable {
    hole: UnitHole,
    /// Least radius, units of the mass, less [`SHIFT`].
    least: f64,
    /// Entries by the angle, by the radius of the start and that of the end; solved when they are first asked for.
    columns: Vec<OnceLock<Box<Column>>>,
}

/// A place as the table knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TablePlace {
    /// The place.
    pub place: KerrPlace,
    /// What belongs to the chart in the winding about the axis, radians.
    pub chart_turn: f64,
    /// Number of its radius in the table.
    node: f64,
    /// Isotropic radius.
    rho: f64,
}

/// A ray in the plane of its start and its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneRay {
    /// Unit tangent of N's great circle at the start.
    pub tangent: DVec3,
    /// Angle along it to the end, radians.
    pub angle: f64,
    /// Angle from falling radially at which it starts, radians: the parameter of [`OrbitPlane::orbit`].
    ///
    /// [`OrbitPlane::orbit`]: crate::geodesic::kerr::OrbitPlane::orbit
    pub alpha: f64,
    /// Winding about the axis on the way, radians.
    pub turn: f64,
}

/// Coefficients of α, then of the winding, less the closed forms: constant, of the tilt, of its square, and of the
/// square of the start's N_z.
type Entry = [f32; 8];

/// Entries of two radii, by the angle.
type Column = [Entry; ANGLES];

/// Radii.
const RADII: usize = 32;
/// Angles from 0 to a whole turn.
const ANGLES: usize = 57;
/// Least radius relative to that of the largest ergosphere.
const LEAST: f64 = 1.1;
/// Largest radius, units of the mass: beyond, the closed forms are as good.
const MOST: f64 = 1e4;
/// Radii less this one are spaced evenly in their logarithm.
const SHIFT: f64 = 1.0;

impl OrbitTable {
    /// The table of `hole`.
    pub fn new(hole: &UnitHole) -> Self {
        let least = LEAST * (1.0 + (1.0 - hole.e2).max(0.0).sqrt()) - SHIFT;
        Self { hole: *hole, least, columns: (0..RADII * RADII).map(|_| OnceLock::new()).collect() }
    }

    /// The hole.
    pub fn hole(&self) -> &UnitHole {
        &self.hole
    }

    /// A place; `None` if it is too close to the hole.
    pub fn place(&self, place: KerrPlace) -> Option<TablePlace> {
        (place.r >= SHIFT + self.least).then(|| self.beyond(place))
    }

    /// A place that is not too close.
    fn beyond(&self, place: KerrPlace) -> TablePlace {
        let Self { hole, least, .. } = self;
        let r = place.r;
        let node = libm::log((r - SHIFT) / least) / self.spacing();
        let square = hole.a * hole.a + hole.e2;
        let rho = 0.5 * (r - 1.0 + (r * (r - 2.0) + square).max(0.0).sqrt());
        // ∫ du/D with D = (1 − (1 + s)u)(1 − (1 − s)u).
        let s = (1.0 - square).max(0.0).sqrt();
        let part = 1.0 / (r - 1.0);
        let integral = if s > 1e-6 { libm::atanh(s * part) / s } else { part };
        TablePlace { place, chart_turn: -hole.a * integral, node, rho }
    }

    /// The ray from a place to another with this winding number about the centre, if it winds about the axis by `turn`,
    /// radians.
    pub fn ray_to(&self, from: &TablePlace, to: &TablePlace, winding: u32, turn: f64) -> PlaneRay {
        let n = turned(to.place.n, -turn);
        let (tangent, angle) = from.place.towards(n, winding);
        let cell = |node: f64, count: usize| {
            let index = (node as usize).min(count - 2);
            (index, (node - index as f64).min(1.0) as f32)
        };
        let (i, x) = cell(from.node, RADII);
        let (j, y) = cell(to.node, RADII);
        let (k, z) = cell(angle * ((ANGLES - 1) as f64 / TAU), ANGLES);
        let mut sum = [0.0f32; 8];
        for (i, x) in [(i, 1.0 - x), (i + 1, x)] {
            for (j, y) in [(j, 1.0 - y), (j + 1, y)] {
                let column = self.column(i, j);
                let [first, second] = [&column[k], &column[k + 1]];
                let (a, b) = (x * y * (1.0 - z), x * y * z);
                for c in 0..8 {
                    sum[c] += a * first[c] + b * second[c];
                }
            }
        }
        let [a0, a1, a2, a3, t0, t1, t2, t3] = sum.map(f64::from);
        let tilt = from.place.n.cross(tangent).z;
        let mu2 = from.place.n.z * from.place.n.z;
        let sum = |c: [f64; 4]| c[0] + tilt * (c[1] + tilt * c[2]) + mu2 * c[3];
        let alpha = bent(from.rho, to.rho, (tangent.dot(n), from.place.n.dot(n))) + sum([a0, a1, a2, a3]);
        let turn = to.chart_turn - from.chart_turn + sum([t0, t1, t2, t3]);
        PlaneRay { tangent, angle, alpha, turn }
    }

    /// Unit direction, in the frame at rest, in which a ray leaves along a half-plane.
    pub fn direction(&self, from: &TablePlace, tangent: DVec3, alpha: f64) -> Option<DVec3> {
        let plane = from.place.plane(&self.hole, tangent)?;
        let direction = from.place.direction(&self.hole, &plane, alpha);
        direction.is_finite().then_some(direction)
    }

    fn column(&self, from: usize, to: usize) -> &Column {
        let place = |node: usize| {
            let r = SHIFT + self.least * libm::exp(self.spacing() * node as f64);
            self.beyond(KerrPlace { r, n: DVec3::X })
        };
        self.columns[from * RADII + to].get_or_init(|| Box::new(column(&self.hole, &place(from), &place(to))))
    }

    fn spacing(&self) -> f64 {
        libm::log(MOST / self.least) / (RADII - 1) as f64
    }
}

/// The angle from falling radially at which a ray leaves the isotropic radius `from` that sweeps an angle on its way to
/// `to`, if it is bent weakly; sine and cosine of the angle are given.
fn bent(from: f64, to: f64, (sin, cos): (f64, f64)) -> f64 {
    let sin = if sin == 0.0 { f64::MIN_POSITIVE } else { sin };
    let straight = libm::atan2(sin, from / to - cos);
    let square = straight * (1.0 - cos) / sin * 2.0 / from;
    0.5 * (straight + (straight * straight + 4.0 * square).max(0.0).sqrt())
}

/// Entries of two radii.
fn column(hole: &UnitHole, from: &TablePlace, to: &TablePlace) -> Column {
    // Start and tangent: along the equator both ways, from it to a pole, and from a pole.
    let planes = [(DVec3::X, DVec3::Y), (DVec3::X, DVec3::NEG_Y), (DVec3::X, DVec3::Z), (DVec3::Z, DVec3::X)];
    let [with, against, over, pole] = planes.map(|(n, tangent)| rests(hole, [from, to], n, tangent));
    std::array::from_fn(|k| {
        let [with, against, over, pole] = [with[k], against[k], over[k], pole[k]];
        let sum = |i: usize| {
            let (mean, half) = (0.5 * (with[i] + against[i]), 0.5 * (with[i] - against[i]));
            [over[i], half, mean - over[i], pole[i] - over[i]]
        };
        let ([a, b, c, d], [e, f, g, h]) = (sum(0), sum(1));
        [a, b, c, d, e, f, g, h].map(|value| value as f32)
    })
}

/// α and winding about the axis, less the closed forms, of the rays in a half-plane by the angle that they sweep; not a
/// number where none is found.
fn rests(hole: &UnitHole, [from, to]: [&TablePlace; 2], n: DVec3, tangent: DVec3) -> [[f64; 2]; ANGLES] {
    let radii = (1.0 / from.place.r, 1.0 / to.place.r);
    let Some(plane) = KerrPlace { n, ..from.place }.plane(hole, tangent) else {
        return [[f64::NAN; 2]; ANGLES];
    };
    // Nothing is bent on a way that sweeps nothing.
    let mut rests = [[0.0; 2]; ANGLES];
    let mut by_alpha = f64::NAN;
    for k in 1..ANGLES {
        let angle = TAU * k as f64 / (ANGLES - 1) as f64;
        let closed = bent(from.rho, to.rho, libm::sincos(angle));
        // Rests before, extrapolated.
        let guess =
            (k > 2).then(|| PlaneGuess { alpha: closed + 2.0 * rests[k - 1][0] - rests[k - 2][0], by_alpha });
        let found = solve(hole, &plane, radii, angle, guess.filter(|guess| guess.alpha.is_finite()));
        rests[k] = found.as_ref().map_or([f64::NAN; 2], |found| {
            [found.alpha - closed, found.turn - (to.chart_turn - from.chart_turn)]
        });
        by_alpha = found.map_or(f64::NAN, |found| found.by_alpha);
    }
    rests
}
