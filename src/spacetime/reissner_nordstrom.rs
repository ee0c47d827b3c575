//! Reissner and Nordström's spacetime of a charged hole in isotropic coordinates.
//!
//! With the areal radius R = ρ + M + h²/ρ, h² = (M² − Q²)/4, ds² = −((1 − h²w²)/a)² dt² + a² dx², a = R/ρ =
//! 1 + Mw + h²w², w = 1/ρ; index n = a²/(1 − h²w²), horizon at ρ = h.
//!
//! References: Reissner 1916, Ann. Phys. 355, 106; Nordström 1918, Proc. KNAW 20, 1238. Photon sphere: Chandrasekhar
//! 1983, "The Mathematical Theory of Black Holes", §40.

use super::conformally_flat::ConformallyFlat;
use super::named::Named;
use super::parameter::{Parameter, Range, SCHWARZSCHILD_RADIUS};
use super::static_hole::StaticHole;
use crate::math::real::Real;

/// A hole of mass M and charge Q at the origin, |Q| ≤ M; extremal with |Q| = M: its horizon is at ρ = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReissnerNordstrom {
    mass: f64,
    /// Q/M.
    charge: f64,
    /// Isotropic radius of the horizon.
    h: f64,
}

impl ReissnerNordstrom {
    /// A hole of Schwarzschild radius `r_s` = 2M > 0 and `charge` Q/M from −1 to 1.
    pub fn new(r_s: f64, charge: f64) -> Self {
        let mass = 0.5 * r_s;
        Self { mass, charge, h: 0.5 * mass * ((1.0 - charge) * (1.0 + charge)).sqrt() }
    }

    /// The spacetime of a hole.
    pub(crate) fn of(hole: StaticHole) -> Self {
        Self::new(2.0 * hole.mass, hole.charge)
    }

    /// The hole.
    pub(crate) fn hole(&self) -> StaticHole {
        StaticHole { mass: self.mass, charge: self.charge }
    }

    /// Areal radius of the photon sphere, (3M + √(9M² − 8Q²))/2.
    fn areal_photon_sphere(&self) -> f64 {
        0.5 * self.mass * (3.0 + (9.0 - 8.0 * self.charge * self.charge).sqrt())
    }

    /// a, 1 − h²w² and h²w at the inverse radius `w`.
    #[inline(always)]
    fn terms<R: Real>(&self, w: R) -> (R, R, R) {
        let (hw, one) = (R::of(self.h) * w, R::of(1.0));
        (one + R::of(self.mass) * w + hw * hw, (one - hw) * (one + hw), R::of(self.h) * hw)
    }
}

impl Named for ReissnerNordstrom {
    const NAME: &'static str = "reissner-nordstrom";
    const TITLE: &'static str = "Reissner–Nordström";
    const SUMMARY: &'static str = "A hole of Schwarzschild radius `rs` (2M; 2 if absent) and charge `Q` (Q/M) at the origin; isotropic coordinates";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter { in_tables: Some(2.0), ..SCHWARZSCHILD_RADIUS },
        Parameter {
            key: "charge",
            column: "Q",
            symbol: "Q/M",
            noun: "the charge Q/M",
            range: Range::Ratio {
                least: -1.0,
                most: 1.0,
                why: "a hole of more charge than mass has no horizon, and its singularity is bare",
            },
            in_tables: None,
            per_column: 1.0,
        },
    ];

    fn new(values: &[f64]) -> Self {
        Self::new(values[0], values[1])
    }

    fn values(&self) -> Vec<f64> {
        vec![2.0 * self.mass, self.charge]
    }
}

impl ConformallyFlat for ReissnerNordstrom {
    #[inline(always)]
    fn index_squared<R: Real>(&self, w: R) -> R {
        let n = self.index(w);
        n * n
    }

    #[inline(always)]
    fn index<R: Real>(&self, w: R) -> R {
        let (a, d, _) = self.terms(w);
        // Positive inside the horizon, too, where steps may end that are then rejected.
        (a * a / d).abs()
    }

    /// ½ d(n²)/dw = 2 a³ (M + h²w (3 − h²w²)) / (1 − h²w²)³.
    #[inline(always)]
    fn pull<R: Real>(&self, w: R) -> R {
        let (a, d, h2w) = self.terms(w);
        let inverse = R::of(1.0) / d;
        let rising = R::of(self.mass) + h2w * (R::of(3.0) - h2w * w);
        (R::of(2.0) * (a * inverse) * rising) * (a * inverse) * (a * inverse)
    }

    /// With σ = 1/c, x = h²W² and A = σ² + MWσ + x: 2 A³ (Mσ³ + h²W (3σ² − x)) / (σ² (σ² − x))³.
    #[inline(always)]
    fn projected_pull<R: Real>(&self, projected: R, secant2: R) -> R {
        let (hw, secant) = (R::of(self.h) * projected, secant2.sqrt());
        let (x, h2w) = (hw * hw, R::of(self.h) * hw);
        // σ² − x, whose factors do not cancel.
        let d = (secant - hw) * (secant + hw);
        let a = secant2 + R::of(self.mass) * projected * secant + x;
        let over = a * (R::of(1.0) / (secant2 * d));
        let rising = R::of(self.mass) * secant * secant2 + h2w * (R::of(3.0) * secant2 - x);
        (R::of(2.0) * over * rising) * over * over
    }

    /// (1 − h²w²)/a.
    fn lapse(&self, w: f64) -> f64 {
        let (a, d, _) = self.terms(w);
        d / a
    }

    fn as_hole(&self) -> Option<StaticHole> {
        Some(self.hole())
    }

    fn horizon(&self) -> f64 {
        self.h
    }

    /// ρ of the areal radius R: R − M = ρ + h²/ρ.
    fn photon_sphere(&self) -> f64 {
        let s = self.areal_photon_sphere() - self.mass;
        0.5 * (s + ((s - 2.0 * self.h) * (s + 2.0 * self.h)).sqrt())
    }

    /// R²/√(R² − 2MR + Q²) at the photon sphere.
    fn critical_impact_parameter(&self) -> f64 {
        let (r, q) = (self.areal_photon_sphere(), self.charge * self.mass);
        r * r / (r * (r - 2.0 * self.mass) + q * q).sqrt()
    }
}
