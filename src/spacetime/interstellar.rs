//! Wormhole of the film "Interstellar" in isotropic coordinates: three parameters set the radius and the length of its
//! throat, and the width of its lens.
//!
//! ds² = −dt² + dl² + r(l)² dΩ² \[J, eq. 5\]: for |l| < a a cylinder of the radius r = r₀; beyond, with
//! x = 2(|l| − a)/πM, r = r₀ + M (x atan x − ½ ln(1 + x²)), whose lensing width is W = 1.42953 M. With
//! d ln ρ = dl/r, scaled so that r/ρ → 1 far away, it is −dt² + n² dx², n = r/ρ. In the cylinder n = r₀ w exactly;
//! outside
//!
//! ```text
//! d ln n/d ln w = (2/π) atan(1/x),
//! ```
//!
//! and ln ρ is an integral that only numbers tell (`flare.rs`). The map ρ → ρ₀²/ρ, ρ₀ the isotropic radius of the
//! throat, is the other side, seen from here. At the mouths |l| = a the second derivative of n jumps.
//!
//! Reference: \[J\] James, von Tunzelmann, Franklin, Thorne 2015, Am. J. Phys. 83, 486 (arXiv:1502.03809).

use super::conformally_flat::ConformallyFlat;
use super::flare::{Flare, MOST_TABLES};
use super::named::Named;
use super::parameter::{Parameter, Range, THROAT_RADIUS};
use crate::math::real::Real;

/// A wormhole about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interstellar {
    /// r₀.
    radius: f64,
    /// 2a.
    length: f64,
    /// W.
    lensing_width: f64,
    /// M.
    mass: f64,
    /// Isotropic radius of the mouths.
    mouth: f64,
    /// Isotropic radius of the throat's middle.
    throat: f64,
    /// The space beyond the mouths.
    flare: &'static Flare,
}

/// W/M \[J, eq. 8\].
const WIDTH_PER_MASS: f64 = 1.42953;
/// Bounds of the lensing width over the throat's radius.
const WIDTHS: (f64, f64) = (1e-3, 50.0);
/// Largest length of the throat over its radius: its ends are as many times as far apart in the chart as e to half of
/// that.
const LONGEST: f64 = 40.0;

impl Interstellar {
    /// A wormhole whose throat has the areal `radius` > 0 and the `length` ≥ 0, and whose lens is `lensing_width` > 0 wide.
    pub fn new(radius: f64, length: f64, lensing_width: f64) -> Self {
        let mass = lensing_width / WIDTH_PER_MASS;
        let flare = Flare::of(mass / radius);
        let mouth = radius / flare.index_at_mouth;
        let throat = mouth * libm::exp(-0.5 * length / radius);
        Self { radius, length, lensing_width, mass, mouth, throat, flare }
    }

    #[inline(always)]
    fn excess<R: Real>(&self, w: R) -> R {
        R::of(self.mass) * self.flare.excess(self.mouth, w)
    }
}

impl Named for Interstellar {
    const NAME: &'static str = "interstellar-wormhole";
    const TITLE: &'static str = "Interstellar's wormhole";
    const SUMMARY: &'static str = "A wormhole of throat radius `rho`, throat length 2 `a` and lensing width `W` at the origin, which joins two worlds; isotropic coordinates";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter { column: "rho", ..THROAT_RADIUS },
        Parameter {
            key: "throat_length",
            column: "a",
            symbol: "2a",
            noun: "the throat length",
            range: Range::Extent,
            in_tables: None,
            per_column: 2.0,
        },
        Parameter {
            key: "lensing_width",
            column: "W",
            symbol: "W",
            noun: "the lensing width",
            range: Range::Extent,
            in_tables: None,
            per_column: 1.0,
        },
    ];

    fn conflict(values: &[f64]) -> Option<(String, String)> {
        let (radius, length, width) = (values[0], values[1], values[2]);
        let (least, most) = (WIDTHS.0 * radius, WIDTHS.1 * radius);
        if radius == 0.0 {
            return None;
        }
        if !(least..=most).contains(&width) {
            let problem = format!("lensing_width is {width}, but throat_radius {radius}");
            let bounds = format!("from {} to {} throat radii", WIDTHS.0, WIDTHS.1);
            return Some((problem, format!("give a lensing_width of {least} to {most}, {bounds}")));
        }
        let shape = width / WIDTH_PER_MASS / radius;
        if !Flare::of(shape).is_of(shape) {
            let problem = format!("lensing_width over throat_radius is the {MOST_TABLES}th other one");
            return Some((problem, format!("give at most {MOST_TABLES} in one run")));
        }
        let longest = LONGEST * radius;
        let problem = || {
            format!(
                "throat_length is {length}, but throat_radius {radius}: the middle of the throat would be too near to its centre, in isotropic coordinates, for numbers to tell"
            )
        };
        let remedy = || format!("give a throat_length of {longest} at most, {LONGEST} throat radii");
        (!(0.0..=longest).contains(&length)).then(|| (problem(), remedy()))
    }

    fn new(values: &[f64]) -> Self {
        Self::new(values[0], values[1], values[2])
    }

    fn values(&self) -> Vec<f64> {
        vec![self.radius, self.length, self.lensing_width]
    }
}

impl ConformallyFlat for Interstellar {
    #[inline(always)]
    fn index_squared<R: Real>(&self, w: R) -> R {
        self.index(w).squared()
    }

    #[inline(always)]
    fn index<R: Real>(&self, w: R) -> R {
        let (within, beyond) = (R::of(self.radius) * w, R::of(1.0) + w * self.excess(w));
        if w > R::of(1.0 / self.mouth) { within } else { beyond }
    }

    #[inline(always)]
    fn pull<R: Real>(&self, w: R) -> R {
        let within = R::of(self.radius * self.radius) * w;
        let beyond = R::of(self.mass) * self.flare.pull(self.mouth, w);
        if w > R::of(1.0 / self.mouth) { within } else { beyond }
    }

    fn horizon(&self) -> f64 {
        0.0
    }

    fn throat(&self) -> f64 {
        self.throat
    }

    fn mouth(&self) -> f64 {
        self.mouth
    }

    /// The mouth: rays circle there, and all over the cylinder within.
    fn photon_sphere(&self) -> f64 {
        self.mouth
    }

    /// r₀.
    fn critical_impact_parameter(&self) -> f64 {
        self.radius
    }

    fn proper_radius(&self, rho: f64) -> f64 {
        if rho < self.mouth {
            return self.radius * libm::log(rho / self.throat);
        }
        0.5 * self.length + self.radius * self.flare.way(rho / self.mouth)
    }

    fn isotropic_radius(&self, l: f64) -> f64 {
        let beyond = l - 0.5 * self.length;
        if beyond < 0.0 {
            return self.throat * libm::exp(l / self.radius);
        }
        self.mouth * self.flare.stretch(beyond / self.radius)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_2_PI, PI};

    use super::*;
    use crate::math::dual::Dual;

    /// Throat radius, throat length and lensing width.
    const LENGTHS: [[f64; 3]; 6] = [
        [1.0, 0.01, 0.014],
        [1.0, 10.0, 1.0],
        [2.0, 0.0, 1.5],
        [0.5, 4.0, 3.0],
        [3.0, 1.0, 150.0],
        [1.0, 0.5, 0.001],
    ];

    fn wormholes() -> impl Iterator<Item = Interstellar> {
        LENGTHS.into_iter().map(|[radius, length, width]| Interstellar::new(radius, length, width))
    }

    /// Areal radius at the distance `way` from a mouth, and x there.
    fn areal(hole: &Interstellar, way: f64) -> (f64, f64) {
        let x = 2.0 * way / (PI * hole.mass);
        let rise =
            if x < 1e-3 { x * x / 2.0 - x.powi(4) / 12.0 } else { x * x.atan() - 0.5 * (x * x).ln_1p() };
        (hole.radius + hole.mass * rise, x)
    }

    #[test]
    fn the_index_is_the_areal_radius_over_the_isotropic_one() {
        for hole in wormholes() {
            for i in 0..200 {
                let way = hole.radius * 10f64.powf(-7.0 + 0.07 * f64::from(i));
                let (r, x) = areal(&hole, way);
                let rho = hole.isotropic_radius(0.5 * hole.length + way);
                let (n, w) = (r / rho, 1.0 / rho);
                let pull = n * n * rho * FRAC_2_PI * 1f64.atan2(x);
                let errors = [hole.index(w) / n - 1.0, hole.pull(w) / pull - 1.0];
                assert!(errors.iter().all(|error| error.abs() < 1e-12), "{hole:?} at {way}: {errors:?}");
            }
        }
    }

    #[test]
    fn the_index_is_that_of_a_cylinder_within_the_mouth_and_of_a_mass_far_away() {
        for hole in wormholes() {
            for w in [1.001 / hole.mouth, 1.0 / (hole.throat * hole.mouth).sqrt(), 1.0 / hole.throat] {
                assert!((hole.index(w) / (hole.radius * w) - 1.0).abs() < 1e-12, "{hole:?}");
            }
            let far = 1e-18 / hole.mass;
            assert!((hole.pull(far) / hole.mass - 1.0).abs() < 1e-9, "{hole:?}");
            assert_eq!((hole.index(0.0), hole.pull(0.0)), (1.0, hole.mass), "{hole:?}");
            let mouth = 1.0 / hole.mouth;
            assert!((hole.index(mouth) / (hole.radius * mouth) - 1.0).abs() < 1e-13, "{hole:?}");
        }
    }

    #[test]
    fn the_pull_is_the_index_times_its_derivative() {
        for hole in wormholes() {
            for i in 0..300 {
                let w = 10f64.powf(-9.0 + 0.03 * f64::from(i)) / hole.throat;
                let n = hole.index(Dual { value: w, slope: 1.0 });
                let pull = hole.pull(w);
                let error = (n.value * n.slope / pull - 1.0).abs();
                assert!(error < 1e-8, "{hole:?} at {w}: {error:e}");
            }
        }
    }

    #[test]
    fn proper_and_isotropic_radii_are_inverse_to_each_other() {
        for hole in wormholes() {
            for l in [1e-3, 0.1, 0.5, 1.0, 4.9, 5.1, 100.0, 1e6].map(|l| l * hole.radius) {
                let rho = hole.isotropic_radius(l);
                assert!((hole.proper_radius(rho) - l).abs() < 1e-12 * (l + hole.radius), "{hole:?} at {l}");
            }
        }
    }

    #[test]
    fn a_narrow_lens_leaves_flat_space_beside_the_mouth() {
        let hole = Interstellar::new(1.0, 0.5, 0.001);
        assert!((hole.mouth - 1.0).abs() < 0.01, "{hole:?}");
        for rho in [1.05, 2.0, 100.0] {
            assert!((hole.index(1.0 / rho) - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn values_that_are_no_wormhole_are_told_by_their_key() {
        for (values, key) in [
            ([1.0, 41.0, 1.0], "throat_length"),
            ([1.0, f64::NAN, 1.0], "throat_length"),
            ([1.0, -1.0, 1.0], "throat_length"),
            ([1.0, 1.0, 0.0], "lensing_width"),
            ([1.0, 1.0, f64::NAN], "lensing_width"),
            ([1.0, 1.0, 1e3], "lensing_width"),
        ] {
            let (problem, remedy) = Interstellar::conflict(&values).unwrap();
            assert!(problem.contains(key) && remedy.contains(key), "{problem}; {remedy}");
            // Nor do they panic or take long.
            let hole = <Interstellar as Named>::new(&values);
            let _ = (hole.index(0.3), hole.isotropic_radius(2.0), hole.proper_radius(2.0));
        }
    }
}
