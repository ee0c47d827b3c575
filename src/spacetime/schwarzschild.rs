//! Schwarzschild's spacetime in isotropic coordinates.
//!
//! ds² = −((1−u)/(1+u))² dt² + (1+u)⁴ dx², u = r_s/4ρ \[J, eq. 2\]; index n = (1+u)³/(1−u).
//!
//! References: \[J\] Jackson, Normann, Hatledal 2025, "The Warped Universe". \[D\] Darwin 1959, Proc. R. Soc. A 249, 180.

use glam::DVec3;

use super::ConformallyFlat;

/// A hole of Schwarzschild radius `r_s` at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schwarzschild {
    /// r_s / 4, the isotropic radius of the horizon.
    horizon: f64,
}

impl Schwarzschild {
    /// A hole of Schwarzschild radius `r_s` > 0.
    pub fn new(r_s: f64) -> Self {
        Self { horizon: 0.25 * r_s }
    }

    /// r_s = 2M.
    pub fn schwarzschild_radius(&self) -> f64 {
        4.0 * self.horizon
    }
}

impl ConformallyFlat for Schwarzschild {
    #[inline(always)]
    fn index_squared(&self, s: f64) -> f64 {
        let u = self.horizon / s.sqrt();
        let a = 1.0 + u;
        let n = a * a * a / (1.0 - u);
        n * n
    }

    /// −½ d(n²)/dρ / ρ = n² u (4 − 2u) / ((1 − u²) ρ²).
    #[inline(always)]
    fn pull(&self, s: f64) -> f64 {
        let u = self.horizon / s.sqrt();
        let (a, c) = (1.0 + u, 1.0 - u);
        let a2 = a * a;
        a2 * a2 * a * u * (4.0 - 2.0 * u) / (c * c * c * s)
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

    /// The asymptote of the orbit in n² ≈ 1 + 8u + 30u², which has a closed form: with w = 1/ρ,
    /// (dw/dφ)² = (1 + 2 r_s w − (b² − 15/8 r_s²) w²)/b². Terms from u³ on are dropped.
    fn escape_direction(&self, x: DVec3, p: DVec3) -> DVec3 {
        let r_s = self.schwarzschild_radius();
        let rho = x.length();
        let radial = x / rho;
        let momentum_radial = p.dot(radial);
        let sideways = p - momentum_radial * radial;
        let b = rho * sideways.length();
        if b <= f64::MIN_POSITIVE {
            return radial;
        }
        let k2 = b * b - 1.875 * r_s * r_s;
        let w = 1.0 / rho;
        let slope = |w: f64| (1.0 + 2.0 * r_s * w - k2 * w * w).max(0.0).sqrt();
        // ∫ b dw / slope from 0 to w.
        let swept = if k2 > 1e-6 * b * b {
            let k = k2.sqrt();
            let angle = |w: f64| (k * w - r_s / k).atan2(slope(w));
            (angle(w) - angle(0.0)) * b / k
        } else {
            // Nearly radial: the integrand is 1 to within r_s w, Simpson's rule is good to its fourth power.
            b * w / 6.0 * (1.0 + 4.0 / slope(0.5 * w) + 1.0 / slope(w))
        };
        (radial * swept.cos() + sideways * (rho / b) * swept.sin()).normalize()
    }

    /// The dropped force bends by less than 2 (r_s/ρ)³.
    fn escape_radius(&self, tolerance: f64) -> f64 {
        self.schwarzschild_radius() * (2.0 / tolerance).cbrt().max(8.0)
    }
}
