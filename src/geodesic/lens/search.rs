//! The search for the ray that sweeps a given angle.

use std::f64::consts::PI;

use super::map::{Lens, Site};
use super::track::{StraightLine, Track, oriented, straight};
use crate::math::half_turn;
use crate::math::kernel::widest;

/// |s| below which both places are taken to be next to the photon sphere, relative errors of this size included: 1/B,
/// which is largest there, no longer tells them apart.
const ON_PHOTON_SPHERE: f64 = 5e-6;
/// Largest |ln(m − 1)|: of a radial ray, and of one that winds until rounding hides it.
const LARGEST: f64 = 128.0;
/// Relative rounding of a swept angle.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Bound on the estimated error of a root that is not evaluated, relative to the tolerance.
const SLOPE_SAFETY: f64 = 0.1;
/// Part of [`most_swept`] up to which guesses are taken as they are.
pub(super) const NEAR_MOST: f64 = 0.98;
/// Most iterations of a root.
const MOST_ITERATIONS: u32 = 60;

impl Lens {
    /// The ray from `x` to `y` that sweeps an angle, whose half has the tangent `half`.
    pub(super) fn track(&self, x: &Site, y: &Site, (swept, half): (f64, f64)) -> Option<Track> {
        widest(Tracking { lens: self, x, y, swept, half })
    }

    #[inline(always)]
    fn find_track(&self, x: &Site, y: &Site, (swept, half): (f64, f64)) -> Option<Track> {
        if x.s.abs().max(y.s.abs()) < ON_PHOTON_SPHERE && !x.is_at_other_depth(y) {
            return Some(self.circling(x, y, swept));
        }
        if x.is_beyond(y) {
            // ln(m − 1), of which ln(e^φ − 1) is nearly a linear function.
            let wanted = size(swept);
            return root(
                (-LARGEST, LARGEST, -wanted),
                self.enough,
                &Across { lens: self, x, y, swept, wanted },
            );
        }
        let reversed = y.q > x.q;
        let (near, far) = if reversed { (y, x) } else { (x, y) };
        let most = most_swept(near, far);
        let guess = if swept < 0.9 * most { self.guess(near, far, swept, half) } else { swept };
        // Of a wide lens the bending is not weak at all.
        let guess = if guess > 0.0 { guess } else { 0.5 * swept };
        let guess = if guess < NEAR_MOST * most { guess } else { most * (1.0 - 0.5 * libm::exp(-swept)) };
        root((0.0, most, guess), self.enough, &SameSideRays { lens: self, near, far, swept })
            .map(|track| oriented(track, reversed))
    }

    /// The straight angle of a weakly bent ray that sweeps an angle whose half has the tangent `half`: κ is 1 + c q to
    /// first order, and q adds up along the line to the sum of both ends' times that tangent.
    #[inline(always)]
    pub(super) fn guess(&self, near: &Site, far: &Site, swept: f64, half: f64) -> f64 {
        let bend = self.weak * self.critical * (near.q + far.q);
        let first = bend * half;
        // The tangent at the first guess, by its derivatives.
        let slope = 0.5 * (1.0 + half * half);
        let less = half - first * slope * (1.0 - 0.5 * first * half);
        let slope = 0.5 * (1.0 + less * less);
        swept - first - (bend * less - first) / (1.0 + bend * slope)
    }
}

/// The search for a track, for the widest vectors that the machine has.
struct Tracking<'a> {
    lens: &'a Lens,
    x: &'a Site,
    y: &'a Site,
    swept: f64,
    half: f64,
}

impl pulp::NullaryFnOnce for Tracking<'_> {
    type Output = Option<Track>;

    #[inline(always)]
    fn call(self) -> Option<Track> {
        self.lens.find_track(self.x, self.y, (self.swept, self.half))
    }
}

/// The rays between two places, by one number.
trait Family {
    /// The ray at a place, how far that is beyond the wanted one by Newton's method, and how much too far the ray
    /// sweeps.
    fn at(&self, place: f64) -> Option<(Track, f64, f64)>;

    /// The wanted ray at a place, given how the swept angle grows there; `None` if only an integral tells.
    fn at_root(&self, place: f64, slope: f64) -> Option<Track>;
}

/// Rays between two places on both sides of the photon sphere, or in or beyond a cylindrical throat, by ln(m − 1).
struct Across<'a> {
    lens: &'a Lens,
    x: &'a Site,
    y: &'a Site,
    swept: f64,
    /// [`size`] of it.
    wanted: f64,
}

/// Nearly a linear function of ln(m − 1): ln(e^φ − 1).
fn size(swept: f64) -> f64 {
    swept + libm::log(-libm::expm1(-swept))
}

impl Family for Across<'_> {
    #[inline(always)]
    fn at(&self, t: f64) -> Option<(Track, f64, f64)> {
        let above = libm::exp(t);
        let track = self.lens.through(self.x, self.y, above)?;
        // dφ/dt = dφ/db db/dm dm/dt, b = b_c/m.
        let slope = track.rate / (track.start[0] * track.end[0]).abs();
        let slope = -slope * self.lens.critical * above / (1.0 + above).powi(2);
        let shift = (size(track.swept) - self.wanted) * -libm::expm1(-track.swept) / slope;
        Some((track, shift, self.swept - track.swept))
    }

    #[inline(always)]
    fn at_root(&self, _: f64, _: f64) -> Option<Track> {
        None
    }
}

/// Rays between two places on one side of the photon sphere, by the angle that they sweep as straight lines.
struct SameSideRays<'a> {
    lens: &'a Lens,
    near: &'a Site,
    far: &'a Site,
    swept: f64,
}

impl Family for SameSideRays<'_> {
    #[inline(always)]
    fn at(&self, gamma: f64) -> Option<(Track, f64, f64)> {
        let track = self.lens.beside(self.near, self.far, gamma)?;
        let slope = track.rate / track.distance;
        // Towards the critical ray e^−φ is linear in γ.
        let excess = track.swept - self.swept;
        let shift =
            if excess.abs() < 0.5 { excess * (1.0 + 0.5 * excess) } else { libm::expm1(excess).min(1e3) };
        Some((track, shift / slope, excess))
    }

    #[inline(always)]
    fn at_root(&self, gamma: f64, slope: f64) -> Option<Track> {
        let StraightLine { b, leaving, arriving, distance, .. } = straight(self.near, self.far, gamma);
        let side = self.near.s.signum();
        let [start, end] = [leaving, arriving].map(|[cos, sin]| [side * cos, sin]);
        Some(Track { swept: self.swept, b, start, end, rate: slope * distance, distance })
    }
}

/// The ray that sweeps as much as is wanted, between two bounds of its number and from a guess.
///
/// If two places before tell the slope well enough, the last is not integrated.
#[inline(always)]
fn root((mut low, mut high, guess): (f64, f64, f64), enough: f64, rays: &impl Family) -> Option<Track> {
    let mut at = guess.clamp(low, high);
    let mut best = None;
    // The place before, and the slope of the swept angle there.
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..MOST_ITERATIONS {
        let Some((track, shift, excess)) = rays.at(at) else {
            // Too close to the critical ray for a number.
            high = at;
            at = 0.5 * (low + high);
            continue;
        };
        best = Some(track);
        if excess > 0.0 {
            high = at;
        } else {
            low = at;
        }
        let is_met = excess.abs() <= met(enough, track.swept) || shift.abs() <= f64::EPSILON * at.abs();
        if is_met || high - low <= f64::EPSILON * high.abs() {
            break;
        }
        let next = at - shift;
        let is_inside = next > low && next < high;
        let slope = track.rate / track.distance;
        if let (Some((place, earlier)), true) = (before, is_inside) {
            // The slope varies by `bend` from place to place: Newton's next error, and what is left of the slope's
            // beyond the straight line through both.
            let change = (slope - earlier) / (at - place);
            let bend = (change / slope).abs();
            let left = (bend * shift).abs() * ((next - place) * bend).abs().max((shift / at).abs());
            if left < SLOPE_SAFETY * enough {
                let found = rays.at_root(next, slope + change * (next - at));
                if found.is_some() {
                    return found;
                }
            }
        }
        before = Some((at, slope));
        at = if is_inside { next } else { 0.5 * (low + high) };
    }
    best
}

/// The angle that the critical ray between two places on one side of the photon sphere sweeps as a straight line, the most
/// that any does.
#[inline(always)]
pub(super) fn most_swept(near: &Site, far: &Site) -> f64 {
    // Where b reaches b_c beyond the point next to the photon sphere: cos θ = −√(1 − (b_c q)²) at both ends.
    let critical = |site: &Site| {
        let s2 = site.s * site.s;
        [1.0 - s2, (s2 * (2.0 - s2)).sqrt()]
    };
    let ([near_sin, near_cos], [far_sin, far_cos]) = (critical(near), critical(far));
    PI - half_turn::angle(near_sin * far_cos + near_cos * far_sin, near_cos * far_cos - near_sin * far_sin)
}

/// Error of a swept angle that ends a search to this relative error.
#[inline(always)]
pub(super) fn met(enough: f64, swept: f64) -> f64 {
    (enough * swept.min(1.0)).max(ROUNDING * swept)
}
