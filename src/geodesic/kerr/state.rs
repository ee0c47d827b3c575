//! State of a ray in Mino time, and what it means in the chart.

use glam::DVec3;

use super::constants::Constants;
use super::hole::{UnitHole, about_axis};
use super::photon::KerrPhoton;

/// State of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MinoState {
    /// Inverse radius.
    pub u: f64,
    /// du/dλ: positive where the ray falls.
    pub v: f64,
    /// Unit vector N.
    pub n: DVec3,
    /// dN/dλ without the winding about z.
    pub m: DVec3,
}

impl MinoState {
    /// G of the winding; each form is regular where it is used, to the horizon and through it.
    #[inline(always)]
    pub fn winding(&self, hole: &UnitHole, constants: &Constants) -> f64 {
        let (u, v) = (self.u, self.v);
        let u2 = u * u;
        let p = 1.0 + hole.a * (hole.a - constants.l) * u2;
        let d = 1.0 - 2.0 * u + (hole.a * hole.a + hole.e2) * u2;
        let falls = v > 0.0;
        let (numerator, denominator) = if falls { (constants.k * u2, p + v) } else { (p - v, d) };
        numerator / denominator
    }

    /// Covariant momentum p_i in the chart.
    pub fn momentum(&self, hole: &UnitHole, constants: &Constants) -> DVec3 {
        let Self { u, n, .. } = *self;
        let g = self.winding(hole, constants);
        let (r, a) = (1.0 / u, hole.a);
        let m = self.m + a * (g - 1.0) * about_axis(n);
        (g - 1.0) * n + (r * m - a * n.z * m.cross(n)) / (r * r + a * a * n.z * n.z)
    }

    /// The photon in the chart, at time 0.
    pub fn photon(&self, hole: &UnitHole, constants: &Constants) -> KerrPhoton {
        KerrPhoton { x: hole.position(self.u, self.n), p: self.momentum(hole, constants), t: 0.0 }
    }

    /// First derivative of the position in the chart with respect to the parameter of [`Self::motion`].
    #[inline(always)]
    pub fn velocity(&self, hole: &UnitHole, constants: &Constants) -> DVec3 {
        self.velocity_winding(hole, self.winding(hole, constants))
    }

    /// [`Self::velocity`], given [`Self::winding`].
    #[inline(always)]
    pub fn velocity_winding(&self, hole: &UnitHole, g: f64) -> DVec3 {
        let Self { u, v, n, m } = *self;
        let tilt = m + hole.a * (g - 1.0) * about_axis(n);
        -v * n + u * tilt + (hole.a * u * u) * about_axis(tilt)
    }

    /// First and second derivatives of the position in the chart with respect to a parameter s with dλ = u² ds, in which
    /// both stay finite far away; the second up to a multiple of the first, which does not bend the ray.
    #[inline(always)]
    pub fn motion(&self, hole: &UnitHole, constants: &Constants) -> [DVec3; 2] {
        let Self { u, v, n, m } = *self;
        let (a, Constants { l, k, j2, k2, kappa, .. }) = (hole.a, *constants);
        let (u2, a2) = (u * u, a * a);
        let charged = a2 + hole.e2;
        let pull = u * (-k2 + u * (3.0 * k - 2.0 * kappa * u));
        // G and dG/dλ.
        let p = 1.0 + a * (a - l) * u2;
        let p_rate = 2.0 * a * (a - l) * u * v;
        let d = 1.0 - 2.0 * u + charged * u2;
        let falls = v > 0.0;
        let (numerator, denominator) = if falls { (k * u2, p + v) } else { (p - v, d) };
        let per = 1.0 / denominator;
        let g = numerator * per;
        let falling = 2.0 * k * u * v - g * (p_rate + pull);
        let rising = p_rate - pull + 2.0 * g * v * (1.0 - charged * u);
        let g_rate = (if falls { falling } else { rising }) * per;
        let (w, w_rate) = (a * (g - 1.0), a * g_rate);
        let around = about_axis(n);
        let tilt = m + w * around;
        let bend = -(j2 + 2.0 * a2 * n.z * n.z) * n + DVec3::new(0.0, 0.0, a2 * n.z);
        let out = DVec3::new(n.x, n.y, 0.0);
        let turn = bend + w_rate * around + 2.0 * w * about_axis(m) - w * w * out;
        // r′ = −v/u², r″ = −u″/u² + 2v²/u³.
        let velocity = -v * n + u * tilt + (a * u2) * about_axis(tilt);
        let r_turn = 2.0 * v * v / u - pull;
        let turning = r_turn * n - 2.0 * v * tilt + u * turn + (a * u2) * about_axis(turn);
        [velocity, u2 * turning]
    }
}
