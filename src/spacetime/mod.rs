//! Spacetimes: one file each, and how rays in them end.
//!
//! # Adding a static, spherically symmetric spacetime
//!
//! Write its line element as ds² = −N(ρ)² dt² + Ψ(ρ)² dx² in isotropic coordinates and implement
//! [`ConformallyFlat`] with n = Ψ/N, as a function of the inverse radius w = 1/ρ. A weak lens of index n² = 1 + k w²:
//!
//! ```
//! use warpfront::math::real::Real;
//! use warpfront::spacetime::ConformallyFlat;
//!
//! #[derive(Clone, Copy)]
//! struct Weak { k: f64 }
//!
//! impl ConformallyFlat for Weak {
//!     fn index_squared<R: Real>(&self, w: R) -> R { R::of(1.0) + R::of(self.k) * w * w }
//!     fn pull<R: Real>(&self, w: R) -> R { R::of(self.k) * w } // ½ d(n²)/dw
//!     fn horizon(&self) -> f64 { 0.0 }
//!     fn photon_sphere(&self) -> f64 { 0.0 }
//!     fn critical_impact_parameter(&self) -> f64 { self.k.sqrt() }
//! }
//! assert_eq!(Weak { k: 2.0 }.index_squared(0.5), 1.5);
//! ```

mod chart;
mod schwarzschild;

pub use chart::{Chart, Fate};
pub use schwarzschild::Schwarzschild;

use crate::math::real::Real;

/// A static, spherically symmetric spacetime in isotropic coordinates centred on the origin.
///
/// Its null rays are those of an optical medium of index n = Ψ/N, a function of the inverse isotropic radius w = 1/ρ.
/// n is analytic at w = 0, where it is 1.
pub trait ConformallyFlat: Copy + Send + Sync {
    /// n² at the inverse radius `w`.
    fn index_squared<R: Real>(&self, w: R) -> R;

    /// The index n at the inverse radius `w`.
    #[inline(always)]
    fn index<R: Real>(&self, w: R) -> R {
        self.index_squared(w).sqrt()
    }

    /// ½ d(n²)/dw at the inverse radius `w`: the pull towards the centre, times ρ².
    fn pull<R: Real>(&self, w: R) -> R;

    /// The lapse N at the inverse radius `w`: how fast a clock at rest runs beside coordinate time. 1 in a medium that only
    /// bends light.
    fn lapse(&self, _w: f64) -> f64 {
        1.0
    }

    /// Isotropic radius of the horizon, 0 if there is none.
    fn horizon(&self) -> f64;

    /// Isotropic radius of the outermost circular ray, 0 if there is none: outside it, a ray that moves outwards never
    /// turns back.
    fn photon_sphere(&self) -> f64;

    /// Impact parameter below which a ray that comes in from outside is captured, 0 if none is.
    fn critical_impact_parameter(&self) -> f64;
}
