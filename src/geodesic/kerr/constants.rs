//! Constants of motion, and the fate that they decide.

use super::hole::UnitHole;
use crate::spacetime::Fate;

/// Constants of motion of a ray of energy 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Constants {
    /// Angular momentum about the axis.
    pub l: f64,
    /// Carter's K = (L − a)² + Q ≥ 0.
    pub k: f64,
    /// J² = |N′|² − a²μ².
    pub j2: f64,
    /// k² = J² − a², negative for vortical rays.
    pub k2: f64,
    /// κ = a²Q + e²K.
    pub kappa: f64,
    /// Inverse radius at which U is least and negative, which no ray crosses; infinite if there is none.
    pub barrier: f64,
}

/// Least value of U at the barrier, of either sign, in roundings of its terms: closer, rounding would decide where the
/// ray turns.
const CLOSEST: f64 = 64.0 * f64::EPSILON;

impl Constants {
    /// U = u′².
    #[inline(always)]
    pub fn rate_squared(&self, u: f64) -> f64 {
        let u2 = u * u;
        1.0 + u2 * (-self.k2 + u * (2.0 * self.k - self.kappa * u))
    }

    /// dU/du.
    #[inline(always)]
    pub fn rate_slope(&self, u: f64) -> f64 {
        2.0 * u * (-self.k2 + u * (3.0 * self.k - 2.0 * self.kappa * u))
    }

    /// Fate of a ray at the inverse radius `u` with u′ = `v`, if nothing is in its way.
    #[inline(always)]
    pub fn fate(&self, u: f64, v: f64) -> Fate {
        let falls = if self.barrier < f64::INFINITY { u > self.barrier } else { v > 0.0 };
        if falls { Fate::Falls } else { Fate::Escapes }
    }

    /// Moves rays that rounding could take across the least value of U off it, and finds the barrier.
    #[inline(always)]
    pub(super) fn settle(&mut self, hole: &UnitHole) {
        let discriminant = 9.0 * self.k * self.k - 8.0 * self.kappa * self.k2;
        let least = 2.0 * self.k2 / (3.0 * self.k + discriminant.max(0.0).sqrt());
        let is_least = (self.k2 > 0.0) & (discriminant >= 0.0) & (least < hole.horizon);
        let height = self.rate_squared(least);
        let stops = is_least & (height < 0.0);
        let is_near = is_least & (height.abs() < CLOSEST);
        let wanted = if stops { -CLOSEST } else { CLOSEST };
        let shift = if is_near { (height - wanted) / (least * least) } else { 0.0 };
        self.k2 += shift;
        self.j2 += shift;
        self.barrier = if stops { least } else { f64::INFINITY };
    }
}
