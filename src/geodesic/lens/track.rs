//! A ray from one place to another in the plane of its orbit, by one number.

use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2};

use super::map::{Lens, NEAR_PHOTON_SPHERE, Site};
use super::weak::WeakBending;
use crate::math::sin_cos_turns;

/// A ray from one place to another in the plane of its orbit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    /// Angle swept.
    pub(super) swept: f64,
    /// Impact parameter.
    pub(super) b: f64,
    /// Cosine and sine of the angle between the radius and the direction of travel, at the start.
    pub(super) start: [f64; 2],
    /// Cosine and sine of that angle at the end.
    pub(super) end: [f64; 2],
    /// R.
    pub(super) rate: f64,
    /// D; 0 between places on both sides of the photon sphere.
    pub(super) distance: f64,
}

impl Lens {
    /// The ray between two places on the same side of the photon sphere that sweeps the angle `gamma` as a straight
    /// line; from `near`, with the larger q, to `far`.
    #[inline(always)]
    pub(super) fn beside(&self, near: &Site, far: &Site, gamma: f64) -> Option<Track> {
        let (side, fit) = if near.s < 0.0 { (-1.0, &self.inside) } else { (1.0, &self.outside) };
        let line = straight(near, far, gamma);
        let StraightLine { b, leaving, arriving, distance: d, .. } = line;
        let [db, turn] = line.changes(near, far);
        let m = self.critical / b;
        let weak = self.bending.as_ref().filter(|_| side > 0.0);
        let shares = [self.critical * near.q, self.critical * far.q];
        let cosines = [leaving[0], arriving[0]];
        let (swept, slope) =
            if let Some(weak) = weak.filter(|_| WeakBending::tells(shares[0], leaving[0], gamma, m)) {
                weak.bend(shares, cosines, gamma, m).by_angle((gamma, turn), db / b)
            } else if let Some(weak) = weak.filter(|_| m > 1.0 && WeakBending::reaches(shares[0])) {
                let gap = self.critical * (near.q - far.q);
                let (swept, slope) = weak.pass((shares[0], gap), m);
                (swept, -slope * m / b * db)
            } else if m > 1.0 {
                // Far away s is 1 to rounding.
                let sum = (near.s + far.s).abs();
                let gap = if sum > 2.0 * NEAR_PHOTON_SPHERE {
                    self.critical * (near.q - far.q) / sum
                } else {
                    (near.s - far.s).abs()
                };
                let (swept, slope) = self.monotone(fit, near.s, far.s, gap, m - 1.0);
                (swept, -slope * m / b * db)
            } else {
                let [end, start] = [leaving, arriving].map(|[cos, sin]| -cos / (1.0 + sin));
                let (swept, by_b) = self.turning(fit, (start, end, gamma), b, side);
                let [at_near, at_far] = [near, far].map(|site| fit.at(site.s)[0] / site.s.abs());
                (swept, at_near * (1.0 + turn) - at_far * turn + by_b * db)
            };
        let outwards = |[cos, sin]: [f64; 2]| [side * cos, sin];
        let (start, end) = (outwards(leaving), outwards(arriving));
        let track = Track { swept, b, start, end, rate: slope * d, distance: d };
        (swept.is_finite() && track.rate > 0.0).then_some(track)
    }

    /// φ and dφ/dm of a ray with m − 1 = `above` > 0 between two places that it passes the photon sphere between, or a part
    /// of a cylindrical throat.
    #[inline(always)]
    fn passing(&self, x: &Site, y: &Site, above: f64) -> (f64, f64) {
        if let Some(fit) = &self.through {
            return self.monotone(fit, x.s, y.s, (x.s - y.s).abs(), above);
        }
        let (low, high) = (x.s.min(y.s), x.s.max(y.s));
        let m = 1.0 + above;
        let inverse = 1.0 / (above * (m + 1.0));
        let within = (x.depth - y.depth).abs() * inverse.sqrt();
        let parts = [(&self.inside, low, high.min(0.0)), (&self.outside, low.max(0.0), high)];
        let parts = parts.into_iter().filter(|(_, from, to)| from < to);
        parts.fold((within, -m * inverse * within), |(swept, slope), (fit, from, to)| {
            let (part, change) = self.monotone(fit, from, to, to - from, above);
            (swept + part, slope + change)
        })
    }

    /// The ray with m − 1 = `above` > 0 between two places that [`Site::is_beyond`] tells apart.
    #[inline(always)]
    pub(super) fn through(&self, x: &Site, y: &Site, above: f64) -> Option<Track> {
        let (swept, slope) = self.passing(x, y, above);
        let m = 1.0 + above;
        let b = self.critical / m;
        let way = if (y.depth, y.s) > (x.depth, x.s) { 1.0 } else { -1.0 };
        // 1 − (b/B)², without cancellation.
        let [start, end] = [x, y].map(|site| {
            let s2 = site.s * site.s;
            [way * ((above + s2) * (m + 1.0 - s2)).sqrt() / m, b * site.q]
        });
        let rate = (start[0] * end[0] * slope * m / b).abs();
        (above > 0.0 && swept.is_finite() && rate > 0.0).then_some(Track {
            swept,
            b,
            start,
            end,
            rate,
            distance: 0.0,
        })
    }

    /// The ray between two places next to the photon sphere that sweeps an angle. There s is a sum of e^λφ and e^−λφ.
    pub(super) fn circling(&self, x: &Site, y: &Site, swept: f64) -> Track {
        let growth = FRAC_1_SQRT_2 / self.outside.at(0.0)[0];
        let (sinh, cosh) = (libm::sinh(growth * swept), libm::cosh(growth * swept));
        // ds/d(λφ), whose square is m − 1 + s².
        let rates = [(y.s - x.s * cosh) / sinh, (y.s * cosh - x.s) / sinh];
        let above = rates[0] * rates[0] - x.s * x.s;
        let m = 1.0 + above;
        let b = self.critical / m;
        let vector = |site: &Site, rate: f64| {
            let cos = (rate * (m + 1.0 - site.s * site.s).sqrt() / m).clamp(-1.0, 1.0);
            [cos, (1.0 - cos * cos).sqrt()]
        };
        let (start, end) = (vector(x, rates[0]), vector(y, rates[1]));
        let distance = x.q * (end[0] - start[0]).abs();
        Track { swept, b, start, end, rate: x.q * sinh / growth, distance }
    }
}

/// A straight line between two places.
#[derive(Clone, Copy, Debug)]
pub(super) struct StraightLine {
    /// Impact parameter.
    pub(super) b: f64,
    /// Cosine and sine of the angle to the radius at the start.
    pub(super) leaving: [f64; 2],
    /// Cosine and sine of it at the end.
    pub(super) arriving: [f64; 2],
    /// q_x q_y times its length: the third side of the triangle of inverse radii.
    pub(super) distance: f64,
    /// Sine of the angle that it sweeps.
    sin: f64,
    /// Cosine of it.
    cos: f64,
}

impl StraightLine {
    /// Changes with the angle that it sweeps: of the impact parameter, and of the angle to the radius at its end.
    #[inline(always)]
    pub(super) fn changes(&self, near: &Site, far: &Site) -> [f64; 2] {
        let Self { distance: d, sin, cos, .. } = *self;
        let b = (cos * d * d - near.q * far.q * sin * sin) / (d * d * d);
        [b, far.q * (near.q * cos - far.q) / (d * d)]
    }
}

/// The straight line between two places that are seen under the angle `gamma`.
#[inline(always)]
pub(super) fn straight(near: &Site, far: &Site, gamma: f64) -> StraightLine {
    let (half_sin, half_cos) = sin_cos_turns::sin_cos(gamma * (0.25 * FRAC_1_PI));
    let (sin, versine) = (2.0 * half_sin * half_cos, 2.0 * half_sin * half_sin);
    let cos = 1.0 - versine;
    let distance = ((near.q - far.q).powi(2) + 2.0 * near.q * far.q * versine).sqrt();
    let per_distance = 1.0 / distance;
    StraightLine {
        b: sin * per_distance,
        leaving: [(near.q * cos - far.q) * per_distance, near.q * sin * per_distance],
        arriving: [(near.q - far.q * cos) * per_distance, far.q * sin * per_distance],
        distance,
        sin,
        cos,
    }
}

/// The track, or the same run backwards.
#[inline(always)]
pub(super) fn oriented(track: Track, reversed: bool) -> Track {
    if !reversed {
        return track;
    }
    let [start, end] = [track.end, track.start].map(|[cos, sin]| [-cos, sin]);
    Track { start, end, ..track }
}
