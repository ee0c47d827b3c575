//! Start of a ray: its constants of motion, and the fate that they decide.

use glam::DVec3;

use super::hole::{UnitHole, about_axis};
use super::state::MinoState;
use crate::math::cross_exact;
use crate::spacetime::Fate;

/// Constants of motion of a ray of energy 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Constants {
    /// Angular momentum about the axis.
    pub l: f64,
    /// Carter's K = (L − a)² + Q ≥ 0.
    pub k: f64,
    /// J² = |N′|² − a²μ².
    pub j2: f64,
    /// k² = J² − a², negative for vortical rays.
    pub k2: f64,
    /// κ = a²Q + e²K.
    pub kappa: f64,
    /// Inverse radius at which U is least and negative, which no ray crosses; infinite if there is none.
    pub barrier: f64,
}

/// A ray at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerrLaunch {
    /// Constants of motion.
    pub constants: Constants,
    /// State.
    pub state: MinoState,
}

/// Least value of U at the barrier, of either sign, in roundings of its terms: closer, rounding would decide where the
/// ray turns.
const CLOSEST: f64 = 64.0 * f64::EPSILON;

impl Constants {
    /// U = u′².
    #[inline(always)]
    pub fn rate_squared(&self, u: f64) -> f64 {
        let u2 = u * u;
        1.0 + u2 * (-self.k2 + u * (2.0 * self.k - self.kappa * u))
    }

    /// dU/du.
    #[inline(always)]
    pub fn rate_slope(&self, u: f64) -> f64 {
        2.0 * u * (-self.k2 + u * (3.0 * self.k - 2.0 * self.kappa * u))
    }

    /// Fate of a ray in this state if nothing is in its way.
    #[inline(always)]
    pub fn fate(&self, state: &MinoState) -> Fate {
        let falls = if self.barrier < f64::INFINITY { state.u > self.barrier } else { state.v > 0.0 };
        if falls { Fate::Falls } else { Fate::Escapes }
    }

    /// Moves rays that rounding could take across the least value of U off it, and finds the barrier.
    #[inline(always)]
    fn settle(&mut self, hole: &UnitHole) {
        let discriminant = 9.0 * self.k * self.k - 8.0 * self.kappa * self.k2;
        let least = 2.0 * self.k2 / (3.0 * self.k + discriminant.max(0.0).sqrt());
        let is_least = (self.k2 > 0.0) & (discriminant >= 0.0) & (least < hole.horizon);
        let height = self.rate_squared(least);
        let stops = is_least & (height < 0.0);
        let is_near = is_least & (height.abs() < CLOSEST);
        let wanted = if stops { -CLOSEST } else { CLOSEST };
        let shift = if is_near { (height - wanted) / (least * least) } else { 0.0 };
        self.k2 += shift;
        self.j2 += shift;
        self.barrier = if stops { least } else { f64::INFINITY };
    }
}

impl KerrLaunch {
    /// A ray from `x` in the unit direction `d` of an observer at rest there, outside the ergosphere.
    ///
    /// The impact parameter is good to the last digits even for a ray from far away that is aimed at the hole.
    #[inline(always)]
    pub fn at_rest(hole: &UnitHole, x: DVec3, d: DVec3) -> Self {
        let (r, n) = hole.spheroidal(x);
        let potential = hole.potential(r, n.z);
        // The lapse of the frame at rest: p = (d + (F/s + (1/s − 1) N·d) N)/s.
        let s = (1.0 - potential).sqrt();
        let per_s = 1.0 / s;
        let p = per_s * (d + (potential * per_s + (per_s - 1.0) * n.dot(d)) * n);
        // What is along N drops out of N × p.
        let moment = per_s * (cross_exact::cross(x, d) - hole.a * about_axis(n).cross(d));
        Self::new(hole, (r, n), p, moment)
    }

    /// Unit direction in which an observer at rest at spheroidal radius `r` and unit vector `n` sees a photon of
    /// covariant momentum `p`, null with p_t = −1, travel: the inverse of [`Self::at_rest`].
    pub fn direction_at_rest(hole: &UnitHole, (r, n): (f64, DVec3), p: DVec3) -> DVec3 {
        let potential = hole.potential(r, n.z);
        let s = (1.0 - potential).sqrt();
        let along = s * s * n.dot(p) - potential;
        (s * p - (potential / s + (1.0 / s - 1.0) * along) * n).normalize()
    }

    /// A photon at `x` of covariant momentum `p`, null with p_t = −1.
    pub fn with_momentum(hole: &UnitHole, x: DVec3, p: DVec3) -> Self {
        let (r, n) = hole.spheroidal(x);
        let moment = cross_exact::cross(x, p) - hole.a * about_axis(n).cross(p);
        Self::new(hole, (r, n), p, moment)
    }

    /// From r N × p.
    #[inline(always)]
    fn new(hole: &UnitHole, (r, n): (f64, DVec3), p: DVec3, moment: DVec3) -> Self {
        let a = hole.a;
        let outwards = n.dot(p);
        // N × N′ = N × (rp + a p×ẑ).
        let spin = moment + a * (n.z * p - DVec3::new(0.0, 0.0, outwards));
        let m = spin.cross(n);
        let l = spin.z;
        let across = m - a * about_axis(n);
        let j2 = m.length_squared() - a * a * n.z * n.z;
        let k = across.length_squared();
        let q = j2 - l * l;
        let (k2, kappa) = (j2 - a * a, a * a * q + hole.e2 * k);
        let mut constants = Constants { l, k, j2, k2, kappa, barrier: f64::INFINITY };
        constants.settle(hole);
        let u = 1.0 / r;
        let delta = r * r - 2.0 * r + a * a + hole.e2;
        let r_rate = delta * outwards - (2.0 * r - hole.e2) + a * l;
        let v = -u * u * r_rate;
        Self { constants, state: MinoState { u, v, n, m } }
    }
}
