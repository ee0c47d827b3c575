//! Photons in the chart: position, covariant momentum, time; and their Hamiltonian.
//!
//! H = ½ (η^{μν} p_μ p_ν − F (l·p)²) = 0 with l^μ = (−1, N) and p_t = −1, so that with w = l·p = 1 + N·p
//!
//! ```text
//! dx/dτ = p − F w N,    dp/dτ = ½ w² ∇F + F w ∇(N·p),    dt/dτ = 1 + F w,    τ affine
//! ```
//!
//! No coordinate is singular outside the ring, and neither constants of motion nor separability are used.

use glam::DVec3;

use super::super::dop853::TABLEAU;
use super::hole::UnitHole;

/// A photon of energy 1 in the chart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KerrPhoton {
    /// Position.
    pub x: DVec3,
    /// Covariant momentum p_i.
    pub p: DVec3,
    /// Coordinate time.
    pub t: f64,
}

/// x, p and t as one vector.
type Vector = [[f64; 7]; 1];

impl KerrPhoton {
    /// The future-directed photon at `x` whose covariant momentum has the direction of `p`; `None` in the ergosphere if
    /// its energy is not positive: then it falls.
    pub fn new(hole: &UnitHole, x: DVec3, p: DVec3) -> Option<Self> {
        let (r, n) = hole.spheroidal(x);
        let f = hole.potential(r, n.z);
        let direction = p.normalize();
        // Energy over |p|, the larger root of (1 + F)E² + 2FcE + Fc² = 1.
        let c = n.dot(direction);
        let root = (1.0 + f - f * c * c).sqrt();
        let energy = if c > 0.0 { (1.0 - f * c * c) / (root + f * c) } else { (root - f * c) / (1.0 + f) };
        (energy > 0.0).then(|| Self { x, p: direction / energy, t: 0.0 })
    }

    fn vector(&self) -> Vector {
        let Self { x, p, t } = self;
        [[x.x, x.y, x.z, p.x, p.y, p.z, *t]]
    }

    fn of([v]: Vector) -> Self {
        Self { x: DVec3::from_slice(&v[0..3]), p: DVec3::from_slice(&v[3..6]), t: v[6] }
    }

    /// (dx/dτ, dp/dτ, dt/dτ).
    pub(super) fn slope(&self, hole: &UnitHole) -> Self {
        let Self { x, p, .. } = *self;
        let (a, e2) = (hole.a, hole.e2);
        let (r, n) = hole.spheroidal(x);
        let rho2 = r * r + a * a;
        let sigma = r * r + a * a * n.z * n.z;
        let f = (2.0 * r - e2) / sigma;
        // Gradients: of r, of μ = z/r, of Σ, of F.
        let r_slope = DVec3::new(r * x.x, r * x.y, rho2 * n.z) / sigma;
        let mu_slope = (DVec3::Z - n.z * r_slope) / r;
        let sigma_slope = 2.0 * r * r_slope + (2.0 * a * a * n.z) * mu_slope;
        let f_slope = (2.0 * r_slope - f * sigma_slope) / sigma;
        // Of N·p at constant p: through r, and directly.
        let through_r = (p.x * (x.x - 2.0 * r * n.x) + p.y * (x.y - 2.0 * r * n.y)) / rho2 - p.z * n.z / r;
        let direct = DVec3::new((r * p.x - a * p.y) / rho2, (a * p.x + r * p.y) / rho2, p.z / r);
        let w = 1.0 + n.dot(p);
        Self {
            x: p - (f * w) * n,
            p: (0.5 * w * w) * f_slope + (f * w) * (through_r * r_slope + direct),
            t: 1.0 + f * w,
        }
    }

    /// dr/dτ, of the sign of the radial motion.
    pub(super) fn rise(&self, hole: &UnitHole) -> f64 {
        let (r, n) = hole.spheroidal(self.x);
        let towards = DVec3::new(r * self.x.x, r * self.x.y, (r * r + hole.a * hole.a) * n.z);
        towards.dot(self.slope(hole).x) / (r * r + hole.a * hole.a * n.z * n.z)
    }

    /// The photon after `h` of τ, and the estimated error of it.
    pub(super) fn step(&self, hole: &UnitHole, h: f64) -> (Self, Self) {
        let slope = |_: f64, state: Vector| Self::of(state).slope(hole).vector();
        let start = self.vector();
        let [gain, error] = TABLEAU.advance(slope, [start, slope(0.0, start)], h);
        let gain = Self::of(gain);
        (Self { x: self.x + gain.x, p: self.p + gain.p, t: self.t + gain.t }, Self::of(error))
    }
}
