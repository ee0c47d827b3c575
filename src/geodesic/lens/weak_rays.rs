//! Rays that are bent weakly, many side by side.
//!
//! The search of [`Lens::connect`] in straight-line code: two trials from the guess of weak bending on, the second by Newton's
//! method, and cubic interpolation between them. What is not found for certain is searched for alone.

use glam::DVec3;

use super::connection::{direction_at, geometry_factor, swept_by};
use super::map::{Lens, Site};
use super::search::{NEAR_MOST, met, most_swept};
use super::track::{StraightLine, Track, oriented, straight};
use super::weak::WeakBending;
use crate::math::columns::{LANES, Row, columns};
use crate::math::half_turn;
use crate::math::kernel::{Kernel, map};

columns! {
    /// A ray from one place to another.
    #[derive(PartialEq)]
    pub struct LensRay => LensRayBlock {
        /// Unit direction at the first.
        direction: DVec3,
        /// Unit direction of travel at the second.
        arrival: DVec3,
        /// [`Connection::geometry_factor`](super::connection::Connection::geometry_factor).
        geometry_factor: f64,
    }
}

columns! {
    /// How a ray winds.
    pub struct Winding => WindingBlock {
        /// Its winding number.
        number: u32,
    }
}

/// Kernel that finds rays; NaN where they must be searched for.
pub(super) struct WeakRays<'a> {
    pub(super) lens: &'a Lens,
    pub(super) bending: &'a WeakBending,
}

/// A ray by the angle that it sweeps as a straight line.
#[derive(Clone, Copy)]
pub(super) struct LineTrial {
    gamma: f64,
    /// The angle that it sweeps, and the derivative.
    pub(super) swept: f64,
    pub(super) slope: f64,
    /// True if that is known.
    pub(super) is_known: bool,
}

/// Error of the interpolated slope, beside the part of it that comes from the cubic term.
const SAFETY: f64 = 0.1;

impl Lens {
    /// The rays that join pairs of places with their winding numbers, as [`Self::connect`] finds them: calls `each` for every
    /// pair.
    pub fn join_all(&self, pairs: &[(Site, Site, u32)], mut each: impl FnMut(usize, Option<LensRay>)) {
        let search = |&(x, y, winding): &(Site, Site, u32)| {
            let found = self.connect(&x, &y, winding)?;
            let (direction, arrival) = (found.direction, found.arrival);
            Some(LensRay { direction, arrival, geometry_factor: found.geometry_factor })
        };
        let Some(bending) = &self.bending else {
            return pairs.iter().enumerate().for_each(|(place, pair)| each(place, search(pair)));
        };
        for (number, pairs) in pairs.chunks(LANES).enumerate() {
            let (mut sites, mut windings) =
                (<(Site, Site) as Row>::Block::default(), WindingBlock::default());
            for (lane, &(x, y, number)) in pairs.iter().enumerate() {
                <(Site, Site)>::set(&mut sites, lane, (x, y));
                Winding::set(&mut windings, lane, Winding { number });
            }
            let mut rays = LensRayBlock::default();
            map(&WeakRays { lens: self, bending }, &[sites], &[windings], std::slice::from_mut(&mut rays));
            for (lane, pair) in pairs.iter().enumerate() {
                let ray = LensRay::get(&rays, lane);
                let is_found = ray.geometry_factor > 0.0;
                each(number * LANES + lane, if is_found { Some(ray) } else { search(pair) });
            }
        }
    }
}

impl Kernel for WeakRays<'_> {
    type A = (Site, Site);
    type B = Winding;
    type Out = LensRay;

    #[inline(always)]
    fn run(&self, (x, y): &(Site, Site), &Winding { number }: &Winding) -> LensRay {
        let spin = x.radial.cross(y.radial);
        let (sin, cos) = (spin.length(), x.radial.dot(y.radial));
        let (swept, is_odd) = swept_by(half_turn::angle(sin, cos), number);
        let is_reversed = y.q > x.q;
        let near = if is_reversed { *y } else { *x };
        let far = if is_reversed { *x } else { *y };
        let most = most_swept(&near, &far);
        let guess = self.lens.guess(&near, &far, swept, sin / (1.0 + cos));
        let guess = if (guess > 0.0) & (guess < NEAR_MOST * most) { guess } else { NEAR_MOST * most };
        let first = self.at(&near, &far, guess);
        let second = self.at(&near, &far, first.gamma - first.shift(swept));
        let (gamma, slope, is_good) = self.root(swept, &first, &second);
        let StraightLine { b, leaving: start, arriving: end, distance, .. } = straight(&near, &far, gamma);
        let track = oriented(Track { swept, b, start, end, rate: slope * distance, distance }, is_reversed);
        let axis = spin / if is_odd { -sin } else { sin };
        let is_outside = (x.s > 0.0) & (y.s > 0.0) & (x.depth == y.depth);
        let is_found = is_good & is_outside & (gamma > 0.0) & (gamma < most) & (track.rate > 0.0);
        let factor = geometry_factor(x, y, &track, sin);
        LensRay {
            direction: direction_at(x, axis, track.start),
            arrival: direction_at(y, axis, track.end),
            geometry_factor: if is_found { factor } else { f64::NAN },
        }
    }
}

impl LineTrial {
    /// How far it is beyond the ray that sweeps an angle, by Newton's method.
    #[inline(always)]
    fn shift(&self, swept: f64) -> f64 {
        let excess = self.swept - swept;
        excess * (1.0 + 0.5 * excess) / self.slope
    }
}

impl WeakRays<'_> {
    /// The ray between two places on one side of the photon sphere whose straight line sweeps the angle `gamma`.
    #[inline(always)]
    pub(super) fn at(&self, near: &Site, far: &Site, gamma: f64) -> LineTrial {
        let line = straight(near, far, gamma);
        let StraightLine { b, leaving, arriving, .. } = line;
        let [change, turn] = line.changes(near, far);
        let (critical, change) = (self.lens.critical, change / b);
        let m = critical / b;
        let shares = [critical * near.q, critical * far.q];
        let bend = self.bending.bend(shares, [leaving[0], arriving[0]], gamma, m);
        let (turning, turning_slope) = bend.by_angle((gamma, turn), change);
        let (passing, passing_slope) = self.bending.pass((shares[0], critical * (near.q - far.q)), m);
        let turns = m <= 1.0;
        let passes = (m > 1.0) & WeakBending::reaches(shares[0]);
        LineTrial {
            gamma,
            swept: if turns { turning } else { passing },
            slope: if turns { turning_slope } else { -passing_slope * m * change },
            is_known: passes | WeakBending::tells(shares[0], leaving[0], gamma, m),
        }
    }

    /// The ray that sweeps an angle, from two trials, by cubic interpolation of gamma by that: the angle of its straight line and
    /// the slope there, and true if they are good.
    #[inline(always)]
    fn root(&self, swept: f64, first: &LineTrial, second: &LineTrial) -> (f64, f64, bool) {
        let (excess, step) = (second.swept - swept, second.swept - first.swept);
        // In steps from the second on.
        let at = -excess / step;
        let (rise, start, end) = (second.gamma - first.gamma, step / first.slope, step / second.slope);
        let (square, cube) = (start + 2.0 * end - 3.0 * rise, start + end - 2.0 * rise);
        let next = second.gamma + at * (end + at * (square + at * cube));
        let slope = step / (end + at * (2.0 * square + 3.0 * at * cube));
        let is_met = excess.abs() <= met(self.lens.enough, second.swept);
        let left = SAFETY * (at.abs() * (cube.abs() + at.abs() * square.abs()) / end.abs());
        let is_good = (is_met | (left < self.lens.enough)) & first.is_known & second.is_known;
        if is_met { (second.gamma, second.slope, is_good) } else { (next, slope, is_good) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::offsets_from;
    use super::*;
    use crate::spacetime::Schwarzschild;

    #[test]
    fn rays_found_side_by_side_are_those_that_an_exact_search_finds() {
        let hole = Schwarzschild::new(1.0);
        let mut offset = offsets_from(hole);
        let exact = Lens::new(&hole, 1e-13).expect("a photon sphere");
        for tolerance in [1e-5, 1e-6] {
            let lens = Lens::new(&hole, tolerance).expect("a photon sphere");
            let mut place = || lens.site(&hole, offset());
            let pairs: Vec<_> = (0..20_000).map(|i| (place(), place(), u32::from(i % 8 == 0))).collect();
            let mut joined = Vec::new();
            lens.join_all(&pairs, |_, ray| joined.push(ray.expect("a ray")));
            let mut side_by_side = 0;
            for ((x, y, winding), ray) in pairs.iter().zip(&joined) {
                let [alone, exact] = [&lens, &exact].map(|lens| lens.connect(x, y, *winding).expect("a ray"));
                if ray.direction == alone.direction && ray.geometry_factor == alone.geometry_factor {
                    continue;
                }
                side_by_side += 1;
                let factor = (ray.geometry_factor / exact.geometry_factor - 1.0).abs();
                let directions = [(ray.direction, exact.direction), (ray.arrival, exact.arrival)]
                    .map(|(a, b)| a.distance(b));
                let is_good = factor < 10.0 * tolerance && directions.iter().all(|&off| off < tolerance);
                assert!(is_good, "{x:?} to {y:?}, {winding}: {ray:?}, exactly {exact:?}");
            }
            assert!(3 * side_by_side > pairs.len(), "{side_by_side} at {tolerance}");
        }
    }
}
