//! Kerr and Newman's spacetime of a spinning, charged hole in Cartesian Kerr–Schild coordinates.
//!
//! g = η + F l l with l = (±1, N): with + in the ingoing form, in which a ray that falls crosses the horizon, with − in
//! the outgoing form of scenes, in which a ray that is traced into the past does. N is the unit vector of
//! x + iy = (r + ia) e^{iφ} sin θ, z = r cos θ, so that X = rN + a ẑ×N, and F = (2Mr − q²)/(r² + a² cos² θ). Here q and
//! a are lengths, eM and aM of the parameters.
//!
//! References: Kerr 1963, PRL 11, 237; Newman et al. 1965, J. Math. Phys. 6, 918; Debney, Kerr, Schild 1969, J. Math.
//! Phys. 10, 1842. Shadow: Bardeen 1973, "Black Holes" (Les Houches), 215.

use glam::DVec3;

use super::named::Named;
use super::parameter::{Parameter, Range, SCHWARZSCHILD_RADIUS};

/// A hole at the origin that spins about z, with a² + e² ≤ 1 for a = a/M and e = Q/M; extremal if equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerrNewman {
    /// M, a length.
    mass: f64,
    /// a/M, positive if it turns right-handed about the axis.
    spin: f64,
    /// Q/M.
    charge: f64,
}

/// a/M.
pub(super) const SPIN: Parameter = Parameter {
    key: "spin",
    column: "a",
    symbol: "a/M",
    noun: "the spin a/M",
    range: Range::Ratio {
        least: -1.0,
        most: 1.0,
        why: "a hole that spins faster has no horizon, and its singularity is bare",
    },
    in_tables: None,
    per_column: 1.0,
};

impl KerrNewman {
    /// A hole of Schwarzschild radius `r_s` = 2M > 0, `spin` a/M and `charge` Q/M.
    pub const fn new(r_s: f64, spin: f64, charge: f64) -> Self {
        Self { mass: 0.5 * r_s, spin, charge }
    }

    /// M, a length.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// a/M.
    pub fn spin(&self) -> f64 {
        self.spin
    }

    /// Q/M.
    pub fn charge(&self) -> f64 {
        self.charge
    }

    /// (r₊/M − 1), the root of 1 − a² − e².
    fn root(&self) -> f64 {
        let [a, e] = [self.spin, self.charge].map(f64::abs);
        ((1.0 - a) * (1.0 + a) - e * e).max(0.0).sqrt()
    }

    /// Spheroidal radius r₊ of the horizon.
    pub fn horizon(&self) -> f64 {
        self.mass * (1.0 + self.root())
    }

    /// Spheroidal radius of the ergosphere's surface at the equator: M + √(M² − q²).
    pub fn ergosphere(&self) -> f64 {
        self.mass * (1.0 + ((1.0 - self.charge) * (1.0 + self.charge)).max(0.0).sqrt())
    }

    /// Chart radius at the equator of the spheroid of radius `r`: √(r² + a²).
    pub fn equatorial_radius(&self, r: f64) -> f64 {
        let a = self.spin * self.mass;
        (r * r + a * a).sqrt()
    }

    /// Spheroidal radius r of a position.
    pub fn radius(&self, x: DVec3) -> f64 {
        let a = self.spin * self.mass;
        let b = x.length_squared() - a * a;
        let az = 2.0 * a * x.z;
        let root = (b * b + az * az).sqrt();
        // Of b + root and the other form, the one in which nothing cancels.
        let r2 = if b >= 0.0 { 0.5 * (b + root) } else { 0.5 * az * az / (root - b) };
        r2.sqrt()
    }

    /// N of the outgoing chart at a position, that of the ingoing one with the spin reversed, and F there.
    #[inline(always)]
    pub fn outgoing(&self, x: DVec3) -> (DVec3, f64) {
        let (a, r) = (self.spin * self.mass, self.radius(x));
        let per = 1.0 / (r * r + a * a);
        let n = DVec3::new((r * x.x - a * x.y) * per, (r * x.y + a * x.x) * per, x.z / r);
        (n, self.potential_at(r, x.z))
    }

    /// F = (2Mr − q²) r²/(r⁴ + a²z²): 1 on the surface of the ergosphere, less outside.
    pub fn potential(&self, x: DVec3) -> f64 {
        self.potential_at(self.radius(x), x.z)
    }

    /// F at the spheroidal radius `r` and the height `z`.
    #[inline(always)]
    fn potential_at(&self, r: f64, z: f64) -> f64 {
        let (a, q) = (self.spin * self.mass, self.charge * self.mass);
        let r2 = r * r;
        (2.0 * self.mass * r - q * q) * r2 / (r2 * r2 + a * a * z * z)
    }

    /// True in the ergosphere and within the horizon: where nothing can be at rest.
    pub fn drags(&self, x: DVec3) -> bool {
        // NaN at the centre drags, too.
        !(self.potential(x) < 1.0 && self.radius(x) > self.horizon())
    }

    /// Spheroidal radius outside of which no ray that moves outwards turns back: the outermost circular one's.
    pub fn outermost_photon_orbit(&self) -> f64 {
        self.photon_orbits()[1]
    }

    /// Spheroidal radii of the circular photon orbits in the equator, along the spin and against it.
    pub fn photon_orbits(&self) -> [f64; 2] {
        // r² − 3r + 2e² ± 2|a| √(r − e²) = 0.
        let (a, e2) = (self.spin.abs(), self.charge * self.charge);
        let orbit = |a: f64, mut low: f64, mut high: f64| {
            for _ in 0..64 {
                let r = 0.5 * (low + high);
                let inside = r * r - 3.0 * r + 2.0 * e2 + 2.0 * a * (r - e2).max(0.0).sqrt() < 0.0;
                if inside { low = r } else { high = r }
            }
            self.mass * high
        };
        [orbit(a, 1.0 + self.root(), 3.0), orbit(-a, 1.5, 4.5)]
    }

    /// Largest impact parameter of rays from afar that are captured: of the retrograde circular orbit.
    pub fn shadow(&self) -> f64 {
        let (a, r) = (self.spin.abs(), self.outermost_photon_orbit() / self.mass);
        // L − a of that orbit, from dR/dr = 0: 2r (r² − ax) = (r − 1) x².
        let x = -r * (a + (a * a + 2.0 * (r - 1.0) * r).sqrt()) / (r - 1.0);
        self.mass * (x + a).abs()
    }
}

impl Named for KerrNewman {
    const NAME: &'static str = "kerr-newman";
    const TITLE: &'static str = "Kerr–Newman";
    const SUMMARY: &'static str = "A hole of spin `a` (a/M) along z, charge `q` (Q/M) and Schwarzschild radius `rs` (2M; 2 if absent) at the origin; Cartesian Kerr–Schild coordinates";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter { in_tables: Some(2.0), ..SCHWARZSCHILD_RADIUS },
        SPIN,
        Parameter {
            key: "charge",
            column: "q",
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

    fn conflict(values: &[f64]) -> Option<(String, String)> {
        let (a, e) = (values[1], values[2]);
        let problem = || {
            format!(
                "the spin a/M is {a} and the charge Q/M is {e}: beyond (a/M)² + (Q/M)² = 1 there is no horizon, and the singularity is bare"
            )
        };
        (a * a + e * e > 1.0 + 4.0 * f64::EPSILON)
            .then(|| (problem(), "give less spin or less charge".to_owned()))
    }

    fn new(values: &[f64]) -> Self {
        Self::new(values[0], values[1], values[2])
    }

    fn values(&self) -> Vec<f64> {
        vec![2.0 * self.mass, self.spin, self.charge]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shadow_reaches_as_far_as_the_retrograde_circular_orbit() {
        // |b_c| = 6 cos(⅓ arccos a) + a.
        for (spin, b) in [(0.0, 27.0_f64.sqrt()), (0.9, 6.832_319_230_447), (-0.9, 6.832_319_230_447)] {
            let shadow = KerrNewman::new(2.0, spin, 0.0).shadow();
            assert!((shadow - b).abs() < 1e-9, "a = {spin}: {shadow} for {b}");
        }
        // Reissner–Nordström, extremal: 4M.
        assert!((KerrNewman::new(2.0, 0.0, 1.0).shadow() - 4.0).abs() < 1e-7);
    }

    #[test]
    fn circular_photon_orbits_are_at_the_roots_of_the_textbook() {
        // r = 2 + 2 cos(⅔ arccos ∓a).
        for spin in [0.0, 0.5, -0.9, 0.998, 1.0_f64] {
            let exact = [-1.0, 1.0].map(|sign| 2.0 + 2.0 * (2.0 / 3.0 * (sign * spin.abs()).acos()).cos());
            let found = KerrNewman::new(2.0, spin, 0.0).photon_orbits();
            let off = (found[0] - exact[0]).abs().max((found[1] - exact[1]).abs());
            assert!(off < 1e-7, "a = {spin}: {found:?} for {exact:?}");
        }
        let [inner, outer] = KerrNewman::new(2.0, 0.0, 1.0).photon_orbits();
        assert!((inner - 2.0).abs() < 1e-7 && (outer - 2.0).abs() < 1e-7);
    }

    #[test]
    fn the_ergosphere_touches_the_horizon_at_the_poles() {
        let hole = KerrNewman::new(2.0, 0.9, 0.0);
        let horizon = hole.horizon();
        assert!(!hole.drags(DVec3::Z * (horizon + 1e-9)) && hole.drags(DVec3::Z * (horizon - 1e-9)));
        let edge = hole.equatorial_radius(2.0);
        assert!(!hole.drags(DVec3::X * (edge + 1e-9)) && hole.drags(DVec3::X * (edge - 1e-9)));
        assert!(hole.drags(DVec3::ZERO));
    }
}
