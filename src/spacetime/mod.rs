//! Spacetimes: one file each, and where rays in them may stop.
//!
//! # Adding a static, spherically symmetric spacetime
//!
//! Write its line element as ds² = −N(ρ)² dt² + Ψ(ρ)² dx² in isotropic coordinates and implement
//! [`ConformallyFlat`] with n = Ψ/N. A weak lens of index n² = 1 + k/ρ²:
//!
//! ```
//! use warpfront::spacetime::ConformallyFlat;
//!
//! #[derive(Clone, Copy)]
//! struct Weak { k: f64 }
//!
//! impl ConformallyFlat for Weak {
//!     fn index_squared(&self, s: f64) -> f64 { 1.0 + self.k / s }
//!     fn pull(&self, s: f64) -> f64 { self.k / (s * s) } // −½ d(n²)/dρ / ρ
//!     fn horizon(&self) -> f64 { 0.0 }
//!     fn photon_sphere(&self) -> f64 { 0.0 }
//!     fn critical_impact_parameter(&self) -> f64 { self.k.sqrt() }
//!     fn escape_direction(&self, _x: glam::DVec3, p: glam::DVec3) -> glam::DVec3 { p.normalize() }
//!     fn escape_radius(&self, tolerance: f64) -> f64 { (self.k / tolerance).sqrt() }
//! }
//! assert_eq!(Weak { k: 2.0 }.index_squared(4.0), 1.5);
//! ```

mod chart;
mod schwarzschild;

pub use chart::{Chart, Stop};
pub use schwarzschild::Schwarzschild;

use glam::DVec3;

/// A static, spherically symmetric spacetime in isotropic coordinates centred on the origin.
///
/// Its null rays are those of an optical medium of index n = Ψ/N: with dσ = dl/n they obey x' = p, p' = ½∇n²(x),
/// |p| = n. Positions are relative to the centre.
pub trait ConformallyFlat: Copy + Send + Sync {
    /// n² at the squared isotropic radius `s` = ρ².
    fn index_squared(&self, s: f64) -> f64;

    /// The factor g in ½∇n² = −g x, at the squared isotropic radius `s`.
    fn pull(&self, s: f64) -> f64;

    /// Isotropic radius of the horizon, 0 if there is none.
    fn horizon(&self) -> f64;

    /// Isotropic radius of the outermost circular ray: outside it, a ray that moves outwards never turns back.
    fn photon_sphere(&self) -> f64;

    /// Impact parameter below which an infalling ray is captured.
    fn critical_impact_parameter(&self) -> f64;

    /// Unit direction that a ray at `x` with momentum `p`, outward bound beyond [`Self::escape_radius`], has at
    /// infinity.
    fn escape_direction(&self, x: DVec3, p: DVec3) -> DVec3;

    /// Radius from which on [`Self::escape_direction`] is good to `tolerance` radians.
    fn escape_radius(&self, tolerance: f64) -> f64;

    /// ½∇n² at `x`.
    #[inline(always)]
    fn force(&self, x: DVec3) -> DVec3 {
        x * -self.pull(x.length_squared())
    }

    /// The momentum of a null ray at `x` in the unit direction `direction`.
    #[inline(always)]
    fn momentum(&self, x: DVec3, direction: DVec3) -> DVec3 {
        direction * self.index_squared(x.length_squared()).sqrt()
    }
}
