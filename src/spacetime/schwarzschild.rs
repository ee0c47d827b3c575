//! Schwarzschild's spacetime in isotropic coordinates.
//!
//! ds² = −((1−u)/(1+u))² dt² + (1+u)⁴ dx², u = r_s/4ρ \[J, eq. 2\]; index n = (1+u)³/(1−u).
//!
//! References: \[J\] Jackson, Normann, Hatledal 2025, "The Warped Universe". \[D\] Darwin 1959, Proc. R. Soc. A 249,
//! 180.

use glam::DVec3;

use super::conformally_flat::ConformallyFlat;
use super::named::Named;
use super::parameter::{Parameter, SCHWARZSCHILD_RADIUS};
use super::static_hole::StaticHole;
use crate::math::real::Real;

/// A hole of Schwarzschild radius `r_s` at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schwarzschild {
    /// r_s / 4, the isotropic radius of the horizon.
    horizon: f64,
}

impl Schwarzschild {
    /// A hole of Schwarzschild radius `r_s` > 0.
    pub const fn new(r_s: f64) -> Self {
        Self { horizon: 0.25 * r_s }
    }

    /// r_s = 2M.
    pub fn schwarzschild_radius(&self) -> f64 {
        4.0 * self.horizon
    }
}

impl Named for Schwarzschild {
    const NAME: &'static str = "schwarzschild";
    const TITLE: &'static str = "Schwarzschild";
    const SUMMARY: &'static str = "A hole of Schwarzschild radius `rs` at the origin; isotropic coordinates";
    const PARAMETERS: &'static [Parameter] = &[SCHWARZSCHILD_RADIUS];

    fn new(values: &[f64]) -> Self {
        Self::new(values[0])
    }

    fn values(&self) -> Vec<f64> {
        vec![self.schwarzschild_radius()]
    }
}

impl ConformallyFlat for Schwarzschild {
    #[inline(always)]
    fn index_squared<R: Real>(&self, w: R) -> R {
        let n = self.index(w);
        n * n
    }

    #[inline(always)]
    fn index<R: Real>(&self, w: R) -> R {
        let u = R::of(self.horizon) * w;
        let (a, inverse) = (R::of(1.0) + u, R::of(1.0) / (R::of(1.0) - u));
        // Positive inside the horizon, too, where steps may end that are then rejected.
        (a * a * a * inverse).abs()
    }

    /// ½ d(n²)/dw = (r_s/4) (1 + u)⁵ (4 − 2u) / (1 − u)³.
    #[inline(always)]
    fn pull<R: Real>(&self, w: R) -> R {
        let u = R::of(self.horizon) * w;
        let (a, inverse) = (R::of(1.0) + u, R::of(1.0) / (R::of(1.0) - u));
        let a2 = a * a;
        let rising = R::of(2.0 * self.horizon) * (a2 * a2 * a * (R::of(2.0) - u));
        (rising * inverse) * (inverse * inverse)
    }

    /// With q = hW and σ = 1/c: 2h (σ + q)⁵ (2σ − q) / (σ² (σ − q))³.
    #[inline(always)]
    fn projected_pull<R: Real>(&self, projected: R, secant2: R) -> R {
        let (q, secant) = (R::of(self.horizon) * projected, secant2.sqrt());
        let (a, inverse) = (secant + q, R::of(1.0) / (secant2 * (secant - q)));
        let a2 = a * a;
        let rising = R::of(2.0 * self.horizon) * (a2 * a2 * a * (secant + (secant - q)));
        (rising * inverse) * (inverse * inverse)
    }

    /// (1 − u)/(1 + u).
    fn lapse(&self, w: f64) -> f64 {
        let u = self.horizon * w;
        (1.0 - u) / (1.0 + u)
    }

    fn as_hole(&self) -> Option<StaticHole> {
        Some(StaticHole { mass: 2.0 * self.horizon, charge: 0.0 })
    }

    fn horizon(&self) -> f64 {
        self.horizon
    }

    /// Areal radius 3/2 r_s: ρ = (r_s/4)(2 + √3).
    fn photon_sphere(&self) -> f64 {
        self.horizon * (2.0 + 3.0_f64.sqrt())
    }

    /// (3√3/2) r_s \[D\].
    fn critical_impact_parameter(&self) -> f64 {
        1.5 * 3.0_f64.sqrt() * self.schwarzschild_radius()
    }

    /// \[J, eqs. 7, 8\], which hold on null rays: the paper's renormalisation to |p| = 1 makes them timelike and is
    /// left out.
    fn motion(&self, x: DVec3, p: DVec3) -> (DVec3, DVec3) {
        let (r, r_s) = (x.length(), self.schwarzschild_radius());
        let u = r_s / (4.0 * r);
        let (plus, minus) = (1.0 + u, 1.0 - u);
        let velocity = p * (minus * minus / plus.powi(6));
        let pull = p.length_squared() * minus * minus / plus.powi(7) + 1.0 / (1.0 - u * u);
        (velocity, x * (-r_s / (2.0 * r * r * r) * pull))
    }
}
