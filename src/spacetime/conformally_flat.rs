//! Optical media: static, spherical spacetimes as an index of refraction.

use glam::DVec3;

use super::static_hole::StaticHole;
use crate::math::real::Real;

/// A static, spherically symmetric spacetime in isotropic coordinates centred on the origin.
///
/// Its null rays are those of an optical medium of index n = Ψ/N, a function of the inverse isotropic radius w = 1/ρ.
/// n is smooth at w = 0, where it is 1: analytic, or with a logarithm from w² on.
pub trait ConformallyFlat: Copy + Send + Sync + 'static {
    /// n² at the inverse radius `w`.
    fn index_squared<R: Real>(&self, w: R) -> R;

    /// The index n at the inverse radius `w`.
    #[inline(always)]
    fn index<R: Real>(&self, w: R) -> R {
        self.index_squared(w).sqrt()
    }

    /// ½ d(n²)/dw at the inverse radius `w`: the pull towards the centre, times ρ².
    fn pull<R: Real>(&self, w: R) -> R;

    /// The pull of an orbit in its gnomonic projection: pull(W c) c³ at W = `projected`, given `secant2` = 1/c².
    ///
    /// Of all that a step does this is done most often: roots and quotients are what takes time.
    #[inline(always)]
    fn projected_pull<R: Real>(&self, projected: R, secant2: R) -> R {
        // The root and the quotient do not wait for each other.
        let c = secant2.sqrt() * (R::of(1.0) / secant2);
        self.pull(projected * c) * (c * c * c)
    }

    /// The lapse N at the inverse radius `w`: how fast a clock at rest runs beside coordinate time. 1 in a medium that
    /// only bends light.
    fn lapse(&self, _w: f64) -> f64 {
        1.0
    }

    /// The spacetime as that of a hole, charged or not, whose rays have a polynomial equation in the inverse areal radius;
    /// `None` of another.
    fn as_hole(&self) -> Option<StaticHole> {
        None
    }

    /// Isotropic radius of the horizon, 0 if there is none.
    fn horizon(&self) -> f64;

    /// Isotropic radius of a wormhole's throat, 0 if there is none. Beyond it ρ → throat²/ρ is the other side.
    fn throat(&self) -> f64 {
        0.0
    }

    /// Isotropic radius of the mouths of a throat that is a cylinder, within which n is proportional to w; its second
    /// derivative jumps there. 0 without one.
    #[inline(always)]
    fn mouth(&self) -> f64 {
        0.0
    }

    /// Proper distance of the isotropic radius `rho` from the throat of a wormhole; ρ elsewhere.
    fn proper_radius(&self, rho: f64) -> f64 {
        rho
    }

    /// Isotropic radius at the proper distance `l` ≥ 0 from the throat of a wormhole; l elsewhere.
    fn isotropic_radius(&self, l: f64) -> f64 {
        l
    }

    /// Isotropic radius of the outermost circular ray, 0 if there is none: outside it, a ray that moves outwards never
    /// turns back.
    fn photon_sphere(&self) -> f64;

    /// Impact parameter below which a ray that comes in from outside is captured or passes a throat, 0 if none is.
    fn critical_impact_parameter(&self) -> f64;

    /// (dx/dt, dp/dt): Hamilton's equations of a null ray in coordinate time t, with |p| = n.
    fn motion(&self, x: DVec3, p: DVec3) -> (DVec3, DVec3) {
        let w = 1.0 / x.length();
        let slowness = 1.0 / self.index_squared(w);
        (slowness * p, -slowness * self.pull(w) * w * w * w * x)
    }
}
