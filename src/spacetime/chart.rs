//! Where a ray may stop: what lies outside, what lies inside, and what nothing comes back from.

use glam::DVec3;

use super::ConformallyFlat;

/// Why a ray need not be followed further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// It leaves to infinity and meets nothing on its way.
    Escaped,
    /// It falls through the horizon and meets nothing on its way.
    Captured,
}

/// The part of a spacetime that rays are followed in, around geometry that keeps between two radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chart {
    /// Square of the radius beyond which outward rays have escaped.
    outer2: f64,
    /// Square of the radius within which there is no geometry.
    core2: f64,
    /// Square of the radius within which an inward ray never turns.
    photon2: f64,
    /// Square of the critical impact parameter.
    critical2: f64,
    /// Square of the radius at which a ray has reached the horizon.
    horizon2: f64,
}

/// How close to the horizon a ray is followed if geometry reaches that far, relative to the horizon's radius.
const HORIZON_MARGIN: f64 = 1e-6;

impl Chart {
    /// A chart for geometry whose points have isotropic radii between `nearest` and `farthest`; the directions of
    /// escaping rays are good to `tolerance` radians.
    pub fn new<M: ConformallyFlat>(medium: &M, nearest: f64, farthest: f64, tolerance: f64) -> Self {
        let photon = medium.photon_sphere();
        let outer = farthest.max(medium.escape_radius(tolerance)).max(photon * (1.0 + 1e-9));
        let critical = medium.critical_impact_parameter();
        let horizon = medium.horizon() * (1.0 + HORIZON_MARGIN);
        Self {
            outer2: outer * outer,
            core2: nearest * nearest,
            photon2: photon * photon,
            critical2: critical * critical,
            horizon2: horizon * horizon,
        }
    }

    /// Whether a ray at `x` with momentum `p` (|p| = n) may stop here.
    ///
    /// Inside the photon sphere an inward ray has no turning point; outside, an inward ray has none if its impact
    /// parameter is below the critical one. Outside the photon sphere an outward ray has none.
    #[inline(always)]
    pub fn stop(&self, x: DVec3, p: DVec3) -> Option<Stop> {
        let s = x.length_squared();
        let outward = x.dot(p);
        if outward >= 0.0 {
            return (s >= self.outer2).then_some(Stop::Escaped);
        }
        let falls = s <= self.photon2 || x.cross(p).length_squared() < self.critical2;
        ((s < self.core2 && falls) || s <= self.horizon2).then_some(Stop::Captured)
    }

    /// Radius beyond which an outward ray has escaped.
    pub fn outer(&self) -> f64 {
        self.outer2.sqrt()
    }
}
