//! Start of a ray: its constants of motion and its state.

use glam::DVec3;

use super::constants::Constants;
use super::hole::{UnitHole, about_axis};
use super::state::MinoState;
use crate::math::cross_exact;
use crate::spacetime::Fate;

/// A ray at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerrLaunch {
    /// Constants of motion.
    pub constants: Constants,
    /// State.
    pub state: MinoState,
}

impl KerrLaunch {
    /// Fate of the ray if nothing is in its way.
    pub fn fate(&self) -> Fate {
        self.constants.fate(self.state.u, self.state.v)
    }

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
