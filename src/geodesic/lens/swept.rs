//! The angle that a ray sweeps, as an integral without singularities next to the path of integration.

use std::f64::consts::PI;

use super::map::Lens;
use super::rules::{LANES, Lanes, RULES};
use crate::math::chebyshev::Chebyshev;

impl Lens {
    /// φ and dφ/dm of a ray with m − 1 = `above` > 0, between two places that are `gap` apart.
    #[inline(always)]
    pub(super) fn monotone(&self, fit: &Chebyshev, from: f64, to: f64, gap: f64, above: f64) -> (f64, f64) {
        // Where both singularities are far away, a longer unit would cost s its digits.
        // Nor may singularities of h be nearer to the real axis.
        let unit = above.sqrt().min(self.waist);
        let m = 1.0 + above;
        let (low, high) = (from.min(to), from.max(to));
        // Where the root below is 0, or h ceases to be analytic.
        let bound = (m + 1.0).sqrt();
        let beyond = [-self.reach[0].min(bound), self.reach[1].min(bound)].map(|s| s / unit);
        let [swept, slope] = self.integrate((low / unit, high / unit, gap / unit), beyond, |sinh, cosh| {
            let s = sinh.map(|sinh| unit * sinh);
            let [h, _] = fit.at_each(s);
            std::array::from_fn(|i| {
                let s2 = s[i] * s[i];
                let below = (above + s2) * (m + 1.0 - s2);
                let term = 2.0 * h[i] * unit * cosh[i] / below.sqrt();
                [term, term / below]
            })
        });
        (swept, -m * slope)
    }

    /// φ, and dφ/db at fixed angles, of a ray of impact parameter `b` > b_c between the angles 2 atan `start` and 2
    /// atan `end`, `gamma` apart, from its turning point, on the side of the photon sphere that `side` says.
    #[inline(always)]
    pub(super) fn turning(
        &self,
        fit: &Chebyshev,
        (start, end, gamma): (f64, f64, f64),
        b: f64,
        side: f64,
    ) -> (f64, f64) {
        let m = self.critical / b;
        // Of tan²(θ/2) where B would be b_c: negative.
        let pole = ((b - self.critical) / (b + self.critical)).max(f64::MIN_POSITIVE).sqrt();
        let scale = (1.0 + m).sqrt();
        let gap = libm::sin(0.5 * gamma) * ((1.0 + start * start) * (1.0 + end * end)).sqrt();
        let range = (start / pole, end / pole, gap / pole);
        let [swept, by_b] = self.integrate(range, [-f64::INFINITY, f64::INFINITY], |sinh, cosh| {
            let round: Lanes = sinh.map(|sinh| (1.0 + (pole * sinh).powi(2)).sqrt());
            let s: Lanes = std::array::from_fn(|i| side * scale * pole * cosh[i] / round[i]);
            let [h, dh] = fit.at_each(s);
            std::array::from_fn(|i| {
                let share = 1.0 / (scale * round[i]);
                let s2 = s[i] * s[i];
                [2.0 * h[i] * share, (1.0 - s2) * (h[i] - s[i] * dh[i]) * share / s2]
            })
        });
        (swept, -by_b / b)
    }

    /// Integrals over v, sinh v from `low` to `high`, of two functions of sinh v and cosh v whose singularities are
    /// where sinh v has the values `beyond` or have an imaginary part of at least π/2. `gap` is `high` − `low`, without
    /// its rounding.
    #[inline(always)]
    fn integrate(
        &self,
        (low, high, gap): (f64, f64, f64),
        beyond: [f64; 2],
        f: impl Fn(Lanes, Lanes) -> [[f64; 2]; LANES],
    ) -> [f64; 2] {
        let exp_arsinh = |sinh: f64| {
            let larger = sinh.abs() + (1.0 + sinh * sinh).sqrt();
            if sinh < 0.0 { 1.0 / larger } else { larger }
        };
        let middle = (exp_arsinh(low) * exp_arsinh(high)).sqrt();
        let half = arsinh(gap / (middle + 1.0 / middle));
        // A rule of N nodes on an ellipse that keeps off the singularities [Trefethen 2013, th. 19.3]. On the real axis
        // the nearer one counts.
        let nearer = (middle / exp_arsinh(beyond[0])).min(exp_arsinh(beyond[1]) / middle);
        let real = (libm::log(nearer) / half).max(1.0);
        let across = arsinh(0.5 * PI / half.max(1e-3));
        let wanted = self.digits / across.min(libm::log(real + (real * real - 1.0).sqrt())).max(1e-3);
        let longest = RULES.len() - 1;
        let rule = RULES.iter().position(|&nodes| nodes as f64 >= wanted).unwrap_or(longest);
        let mut sums = [0.0; 2];
        for (x, weight) in &self.rules[rule] {
            let grown = x.map(|x| middle * libm::exp(half * x));
            let shrunk = grown.map(|grown| 1.0 / grown);
            let values = f(
                std::array::from_fn(|i| 0.5 * (grown[i] - shrunk[i])),
                std::array::from_fn(|i| 0.5 * (grown[i] + shrunk[i])),
            );
            for ([a, b], weight) in values.iter().zip(weight) {
                sums[0] += weight * a;
                sums[1] += weight * b;
            }
        }
        sums.map(|sum| half * sum)
    }
}

/// Inverse hyperbolic sine of a number ≥ 0, to relative rounding and faster than the standard library's.
#[inline(always)]
fn arsinh(x: f64) -> f64 {
    if x > 0.05 {
        return libm::log(x + (1.0 + x * x).sqrt());
    }
    // Its Taylor series: the next term is below 1e-17.
    let square = x * x;
    let terms = [-63.0 / 2816.0, 35.0 / 1152.0, -5.0 / 112.0, 3.0 / 40.0, -1.0 / 6.0];
    x + x * terms.iter().fold(0.0, |sum, term| (sum + term) * square)
}
