//! Fates of rays, which constants of motion decide, and charts: the radii between which a ray has to be followed.

use super::conformally_flat::ConformallyFlat;

/// Fate of a ray if nothing is in its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fate {
    /// It leaves to infinity.
    #[default]
    Escapes,
    /// It falls through the horizon, or passes the throat of a wormhole to the other side.
    Falls,
}

impl Fate {
    /// The fate of a ray at isotropic radius `rho` with impact parameter `b`, moving outwards or not.
    ///
    /// There is one circular ray, at the photon sphere. Outside it only inward rays below the critical impact parameter
    /// are captured; inside, only outward rays below it escape \[Darwin 1959; Synge 1966\].
    #[inline(always)]
    pub fn of<M: ConformallyFlat>(medium: &M, rho: f64, b: f64, outwards: bool) -> Self {
        let passes = b < medium.critical_impact_parameter();
        let outside = rho >= medium.photon_sphere();
        let escapes = (outside & (outwards | !passes)) | (!outside & outwards & passes);
        if escapes { Fate::Escapes } else { Fate::Falls }
    }
}

/// The part of a spacetime that rays are followed in, around geometry that keeps between two radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chart {
    /// Inverse of the radius beyond which there is no geometry and no ray turns back; positive.
    pub outer: f64,
    /// Inverse of the radius within which there is nothing to be met, or at which a ray has reached the horizon.
    pub inner: f64,
    /// Impact parameter above which rays from beyond that radius never come within it; infinite if none is known.
    pub widest: f64,
}

/// Relative distance from the impact parameter of a ray that grazes the geometry's sphere, above which another passes it:
/// more than rounding, of f32 as well.
const PASSING_MARGIN: f64 = 1e-5;
/// Distance from the horizon down to which a ray is followed if there is anything that near, relative to the horizon's
/// radius.
const HORIZON_MARGIN: f64 = 1e-6;

impl Chart {
    /// A chart for geometry whose points have isotropic radii up to `farthest`, and at least `nearest`, as what else
    /// rays are to be followed to.
    pub fn new<M: ConformallyFlat>(medium: &M, nearest: f64, farthest: f64) -> Self {
        let innermost = Self::innermost(medium);
        Self { inner: 1.0 / nearest.max(innermost), ..Self::to_throat(medium, farthest) }
    }

    /// The chart of one side of a wormhole, for geometry whose points have isotropic radii up to `farthest`: what falls
    /// is followed to the throat.
    pub fn to_throat<M: ConformallyFlat>(medium: &M, farthest: f64) -> Self {
        let farthest = farthest.max(medium.photon_sphere());
        let outer = 1.0 / farthest;
        let widest = farthest * medium.index(outer) * (1.0 + PASSING_MARGIN);
        Self { outer, inner: f64::INFINITY, widest }
    }

    /// Isotropic radius at which a ray has reached the horizon: nothing within is ever met. A horizon may be at 0, where
    /// the photon sphere tells the scale.
    pub fn innermost<M: ConformallyFlat>(medium: &M) -> f64 {
        (medium.horizon() * (1.0 + HORIZON_MARGIN)).max(HORIZON_MARGIN * medium.photon_sphere())
    }

    /// True if a ray of this fate at the inverse radius `w`, moving inwards at the rate `v` = dw/dψ, need not be
    /// followed further.
    #[inline(always)]
    pub fn is_left(&self, fate: Fate, w: f64, v: f64) -> bool {
        match fate {
            Fate::Escapes => v < 0.0 && w <= self.outer,
            Fate::Falls => v > 0.0 && w >= self.inner,
        }
    }

    /// True if a ray of impact parameter `b` at the inverse radius `w` passes all geometry by.
    #[inline(always)]
    pub fn is_passed_by(&self, b: f64, w: f64) -> bool {
        (b > self.widest) & (w <= self.outer)
    }
}
