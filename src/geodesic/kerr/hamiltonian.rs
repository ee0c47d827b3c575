//! Photons followed by their Hamiltonian with DOP853: the independent check of the series.

use super::hole::UnitHole;
use super::photon::KerrPhoton;
use crate::spacetime::Fate;

/// End of a photon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PhotonEnd {
    /// It crosses the spheroid outwards in this state.
    Crosses(KerrPhoton),
    /// It falls through the horizon before.
    Falls,
    /// It leaves to infinity without ever crossing the spheroid outwards.
    Misses,
    /// It took more steps than allowed.
    StepLimit,
    /// Its state is no longer finite.
    NonFinite,
}

/// A photon, followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotonJourney {
    /// End of the photon.
    pub end: PhotonEnd,
    /// Radius of the point nearest to the hole, if the photon passes one.
    pub periastron: Option<f64>,
    /// Steps tried.
    pub steps: u32,
}

/// Most steps tried.
const MAX_STEPS: u32 = 1_000_000;
/// Bounds on how a step may grow or shrink from one to the next, and a factor that keeps most from being rejected.
const GROWTH: (f64, f64) = (0.2, 5.0);
const SAFETY: f64 = 0.9;
/// Smallest tolerance: below, steps would be judged by their rounding.
const LEAST_TOLERANCE: f64 = 100.0 * f64::EPSILON;

/// Radius beyond which no photon that moves outwards turns back, whatever the spin and the charge.
const OUTERMOST_ORBIT: f64 = 4.0;
/// Distance from the spheroid, relative to its radius, at which a start counts as on it.
const ON_SPHERE: f64 = 4.0 * f64::EPSILON;

/// Follows a photon until it crosses the spheroid of radius `r_out` outwards, falls, or is lost. With a known `fate` a
/// photon that will fall is not followed inwards, and one that gets another is followed again, more accurately.
pub fn follow_photon(
    hole: &UnitHole,
    photon: KerrPhoton,
    fate: Option<Fate>,
    tolerance: f64,
    r_out: f64,
) -> PhotonJourney {
    let mut tolerance = tolerance;
    loop {
        let journey = follow_once(hole, photon, fate, tolerance, r_out);
        let contradicts = match journey.end {
            PhotonEnd::Falls => fate == Some(Fate::Escapes),
            PhotonEnd::Crosses(_) => fate == Some(Fate::Falls) && r_out > OUTERMOST_ORBIT,
            PhotonEnd::Misses | PhotonEnd::StepLimit | PhotonEnd::NonFinite => false,
        };
        if !contradicts || tolerance <= LEAST_TOLERANCE {
            return journey;
        }
        tolerance *= 1e-2;
    }
}

/// [`follow_photon`] with one tolerance.
fn follow_once(
    hole: &UnitHole,
    mut photon: KerrPhoton,
    fate: Option<Fate>,
    tolerance: f64,
    r_out: f64,
) -> PhotonJourney {
    let tolerance = tolerance.max(LEAST_TOLERANCE);
    let horizon = 1.0 / hole.horizon;
    let end = |end: PhotonEnd, journey: PhotonJourney| PhotonJourney { end, ..journey };
    let mut h = f64::INFINITY;
    let mut journey = PhotonJourney { end: PhotonEnd::StepLimit, periastron: None, steps: 0 };
    while journey.steps < MAX_STEPS {
        let (r, _) = hole.spheroidal(photon.x);
        let rise = photon.rise(hole);
        if (rise < 0.0 && fate == Some(Fate::Falls)) || r <= horizon {
            return end(PhotonEnd::Falls, journey);
        }
        if rise >= 0.0 && r > r_out * (1.0 + ON_SPHERE) {
            match fate {
                Some(Fate::Falls) => return end(PhotonEnd::Falls, journey),
                Some(Fate::Escapes) => return end(PhotonEnd::Misses, journey),
                None if r > OUTERMOST_ORBIT => return end(PhotonEnd::Misses, journey),
                None => {}
            }
        }
        journey.steps += 1;
        // No step leaps over the hole.
        h = h.min(0.5 * r / photon.slope(hole).x.length());
        let (next, error) = photon.step(hole, h);
        let least = r.min(hole.spheroidal(next.x).0);
        let size = error.x.length() / least + error.p.length() / photon.p.length();
        let relative = size / tolerance;
        let factor = if relative > 0.0 { SAFETY * libm::pow(relative, -1.0 / 6.0) } else { GROWTH.1 };
        let next_h = h * factor.clamp(GROWTH.0, GROWTH.1);
        if relative > 1.0 || relative.is_nan() {
            h = if relative.is_finite() { next_h } else { GROWTH.0 * h };
            if h < f64::MIN_POSITIVE || h.is_nan() {
                return end(PhotonEnd::NonFinite, journey);
            }
            continue;
        }
        // Up to a turning point first: the spheroid may be crossed on either side of it. From there it is only left.
        let next_rise = next.rise(hole);
        let turns = rise != 0.0 && (rise < 0.0) != (next_rise < 0.0);
        let way = if turns { root(h, (rise, next_rise), |h| photon.step(hole, h).0.rise(hole)) } else { h };
        let next = if turns { photon.step(hole, way).0 } else { next };
        if turns && rise < 0.0 {
            journey.periastron = Some(hole.spheroidal(next.x).0);
        }
        let above = |photon: &KerrPhoton| hole.spheroidal(photon.x).0 - r_out;
        let (before, after) = (above(&photon), above(&next));
        if rise >= 0.0 && before <= ON_SPHERE * r_out && after > 0.0 {
            let exit = root(way, (before, after), |h| above(&photon.step(hole, h).0));
            return end(PhotonEnd::Crosses(photon.step(hole, exit).0), journey);
        }
        photon = next;
        h = next_h;
    }
    journey
}

/// The root of a function between 0 and `h`, where its values are known: false position (Illinois). The function has
/// the sign there that it has at `h`, or is 0.
fn root(h: f64, (mut below, mut above): (f64, f64), at: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, h);
    for _ in 0..100 {
        let chord = (low * above - high * below) / (above - below);
        let middle = if chord > low && chord < high { chord } else { 0.5 * (low + high) };
        let value = at(middle);
        if value == 0.0 {
            return middle;
        }
        if (value > 0.0) == (above > 0.0) {
            (high, above, below) = (middle, value, 0.5 * below);
        } else {
            (low, below, above) = (middle, value, 0.5 * above);
        }
        if high - low <= 2.0 * f64::EPSILON * h {
            break;
        }
    }
    high
}
