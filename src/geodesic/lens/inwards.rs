//! Rays on their way inwards, from far away to a sphere outside of the photon sphere, in closed form.
//!
//! As [`WeakBending`](super::WeakBending), with fewer powers, since the sphere keeps away from the photon sphere, and up to
//! a larger m, where rays do not turn:
//!
//! ```text
//! φ = γ + Σ c_k m^k J_k,   k m^k J_k = m [−cos θ u^(k−1)] + (k − 1) m² m^(k−2) J_(k−2),   u = m sin θ = b_c/B.
//! ```

use super::map::bisect;
use super::weak::{WeakBending, angle, each, turned};
use crate::math::chebyshev::Chebyshev;
use crate::spacetime::ConformallyFlat;

/// Rays on their way inwards to a sphere.
#[derive(Clone, Debug)]
pub struct InwardBending {
    /// b_c.
    critical: f64,
    /// 1/B of the sphere.
    q: f64,
    /// c_k, from k = 1 on.
    terms: [f64; TERMS],
}

/// Terms of the polynomial.
const TERMS: usize = 8;
/// Terms that it is made from.
const FIT: usize = 24;
/// Largest m: the recurrence magnifies rounding by m to the number of terms.
const STEEPEST: f64 = 6.0;

impl InwardBending {
    /// Rays to the sphere of inverse isotropic radius `w` to a relative `tolerance`; `None` if that is too near to the photon
    /// sphere, or if there is none.
    pub fn new<M: ConformallyFlat>(medium: &M, w: f64, tolerance: f64) -> Option<Self> {
        let (critical, q) = (medium.critical_impact_parameter(), w / medium.index(w));
        let reach = critical * q;
        if !(reach > 0.0 && WeakBending::reaches(reach)) {
            return None;
        }
        let stretch = |share: f64| {
            let w = bisect(0.0, w, |w| critical * w / medium.index(w) < share);
            1.0 / (1.0 - w * medium.pull(w) / medium.index_squared(w))
        };
        let whole = Chebyshev::fit(FIT, (0.0, reach), |share| (stretch(share) - 1.0) / share);
        let powers = whole.trimmed(tolerance).powers();
        let mut terms = [0.0; TERMS];
        terms.get_mut(..powers.len())?.copy_from_slice(&powers);
        Some(Self { critical, q, terms })
    }

    /// Cosine and sine of the angle that a ray of impact parameter `b` sweeps on its way inwards to the sphere, from a place
    /// of 1/B = `far` and with this cosine of the angle between ray and radius, and the cosine of that on the sphere; and
    /// true if they are known: if the ray is not too steep, and comes there.
    #[inline(always)]
    pub fn swept(&self, b: f64, far: f64, leaving: f64) -> ([f64; 2], f64, bool) {
        let (m, sine) = (self.critical / b, b * self.q);
        let arriving = (1.0 - sine * sine).sqrt();
        // Of the straight line.
        let across = sine * leaving - b * far * arriving;
        let along = leaving * arriving + sine * (b * far);
        let is_known = (m <= STEEPEST) & (sine < 1.0) & (leaving > 0.0) & (across > 0.0);
        let m2 = m * m;
        let (mut far_power, mut near_power) = (m * leaving, m * arriving);
        let (far, near) = (self.critical * far, self.critical * self.q);
        // k m^k J_k of the last k, and of the one before.
        let (mut last, mut before) = (0.0, 0.0);
        let mut half = 0.0;
        let mut add = |i: usize| {
            let k = (i + 1) as f64;
            let ends = far_power - near_power;
            let integral = match i {
                0 => ends,
                1 => ends + angle(along, across) * m2,
                _ => ends + before * (m2 * ((k - 1.0) / (k - 2.0))),
            };
            (before, last) = (last, integral);
            half += self.terms[i] * (0.5 / k) * integral;
            (far_power, near_power) = (far_power * far, near_power * near);
        };
        each!(add below TERMS: 0 1 2 3 4 5 6 7);
        (turned([along, across], half), arriving, is_known)
    }
}
