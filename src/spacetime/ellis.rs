//! Ellis's wormhole in isotropic coordinates.
//!
//! ds² = −dt² + dl² + (l² + b₀²) dΩ² with l = ρ − b₀²/4ρ is −dt² + n² dx², n = 1 + b₀²/4ρ²; throat at ρ = b₀/2. The
//! map ρ → (b₀/2)²/ρ is the other side, seen from here.
//!
//! References: Ellis 1973, J. Math. Phys. 14, 104; Morris, Thorne 1988, Am. J. Phys. 56, 395.

use super::conformally_flat::ConformallyFlat;
use super::named::Named;
use super::parameter::{Parameter, THROAT_RADIUS};
use crate::math::real::Real;

/// A wormhole of throat radius b₀ about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellis {
    /// Isotropic radius of the throat, b₀/2.
    throat: f64,
}

impl Ellis {
    /// A wormhole of throat radius `b0` > 0, areal.
    pub const fn new(b0: f64) -> Self {
        Self { throat: 0.5 * b0 }
    }
}

impl Named for Ellis {
    const NAME: &'static str = "ellis-wormhole";
    const TITLE: &'static str = "Ellis wormhole";
    const SUMMARY: &'static str =
        "A wormhole of throat radius `b0` at the origin, which joins two worlds; isotropic coordinates";
    const PARAMETERS: &'static [Parameter] = &[THROAT_RADIUS];

    fn new(values: &[f64]) -> Self {
        Self::new(values[0])
    }

    fn values(&self) -> Vec<f64> {
        vec![2.0 * self.throat]
    }
}

impl ConformallyFlat for Ellis {
    #[inline(always)]
    fn index_squared<R: Real>(&self, w: R) -> R {
        self.index(w).squared()
    }

    #[inline(always)]
    fn index<R: Real>(&self, w: R) -> R {
        R::of(1.0) + (R::of(self.throat) * w).squared()
    }

    /// ½ d(n²)/dw = 2 (b₀/2)² w n.
    #[inline(always)]
    fn pull<R: Real>(&self, w: R) -> R {
        R::of(2.0 * self.throat * self.throat) * w * self.index(w)
    }

    fn horizon(&self) -> f64 {
        0.0
    }

    fn throat(&self) -> f64 {
        self.throat
    }

    fn proper_radius(&self, rho: f64) -> f64 {
        rho - self.throat.powi(2) / rho
    }

    fn isotropic_radius(&self, l: f64) -> f64 {
        0.5 * (l + (l * l + 4.0 * self.throat.powi(2)).sqrt())
    }

    /// The throat: rays circle there.
    fn photon_sphere(&self) -> f64 {
        self.throat
    }

    /// b₀.
    fn critical_impact_parameter(&self) -> f64 {
        2.0 * self.throat
    }
}
