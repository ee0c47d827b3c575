//! Coordinate time along a ray of the lens map.
//!
//! dt = κ dl = B² dφ/b has the pole of κ at the photon sphere. Without b dφ it is the radial action W, which has none,
//! and in which errors of b cancel those of b φ, since ∂W/∂b = −φ:
//!
//! ```text
//! t = b φ + W,   W = ∫ κ (l/B)² dl.
//! ```
//!
//! Far away κ differs from 1 by O(1/B): what W differs by from a length is a logarithm. Rays that turn or could turn
//! are integrated over y, l = b sinh y; those that cross the photon sphere or could over z, s = tanh z. In both the
//! singularities next to the real axis lie on the imaginary one, and y, z = δ sinh v takes the nearest, ±i δ, and those
//! behind it to ±i π/2.

use std::f64::consts::FRAC_PI_2;

use super::connection::Connection;
use super::map::{Lens, Site};
use super::rules::{LANES, Lanes};
use crate::math::chebyshev::Chebyshev;

/// Longest panel in v, to each of which a rule of 16 nodes is applied.
const PANEL: f64 = 1.5;
/// Index of this rule.
const RULE: usize = 3;
/// Least δ: what is nearer adds δ² to the integral.
const NEAREST: f64 = 1e-8;

impl Lens {
    /// Coordinate time, in the unit of length, that light takes from `x` to `y`, neither at infinity, along one of the
    /// rays that [`Lens::connect`] gives.
    pub fn time(&self, x: &Site, y: &Site, ray: &Connection) -> f64 {
        let sides = [x, y].map(|site| site.s.signum());
        // Away from the photon sphere, which is away from the centre outside it.
        let away = [(x, ray.direction, sides[0]), (y, ray.arrival, sides[1])]
            .map(|(site, direction, side)| side * direction.dot(site.radial));
        let turns = away[0] < 0.0 && away[1] > 0.0;
        let action = if !x.is_beyond(y) && (turns || ray.b > self.critical) {
            let [from, to] = [0, 1].map(|end| libm::asinh(away[end] / (ray.b * [x, y][end].q)));
            self.action_beside(ray.b, 0.5 * (from + to), ray.line, sides[0])
        } else {
            let [from, to] = [x, y].map(|site| libm::asinh(site.s / (self.critical * site.q).sqrt()));
            let share = (ray.b / self.critical).min(1.0);
            let within = self.critical * (x.depth - y.depth).abs() * ((1.0 - share) * (1.0 + share)).sqrt();
            within + self.action_through(share, from.min(to), from.max(to))
        };
        ray.b * ray.swept + action
    }

    /// W of a ray of impact parameter `b` ≥ b_c on one side of the photon sphere, a straight `line` with y = `middle`
    /// between its ends.
    fn action_beside(&self, b: f64, middle: f64, line: f64, side: f64) -> f64 {
        // Of y from the middle to the ends, without the rounding of their difference.
        let half = libm::asinh(0.5 * line / (b * libm::cosh(middle)));
        let fit = if side < 0.0 { &self.inside } else { &self.outside };
        // 1 − m.
        let above = ((b - self.critical) / b).max(f64::MIN_POSITIVE);
        let nearest = 2.0 * libm::asin((0.5 * above).sqrt());
        let range = (middle - half, middle + half);
        let rest = self.over_panels(fit, range, nearest, |Hyperbolic { sinh, cosh, excess }| {
            let s = side * ((above + excess) / cosh).sqrt();
            let flat = if side < 0.0 { 0.0 } else { 1.0 };
            let tanh2 = (sinh / cosh).powi(2);
            (s, move |h| b * cosh * (side * (h - flat * s) / s * tanh2 - flat / (cosh * cosh)))
        });
        if side < 0.0 { rest } else { line + rest }
    }

    /// W of a ray of impact parameter `share` b_c, at most b_c, between two values of z.
    fn action_through(&self, share: f64, low: f64, high: f64) -> f64 {
        // That of h is at s = ±i `waist`.
        let singular = if self.through.is_some() { FRAC_PI_2 } else { libm::atan(self.waist) };
        let nearest = libm::asin((1.0 - share).sqrt()).min(singular);
        let part = |low: f64, high: f64, fit: &Chebyshev, flat: f64| {
            if low >= high {
                return 0.0;
            }
            let rest = self.over_panels(fit, (low, high), nearest, |Hyperbolic { sinh, cosh, .. }| {
                let (s, cosh2) = (sinh / cosh, cosh * cosh);
                // 1 − (b/B)².
                let clear = (1.0 - share + sinh * sinh) / cosh2 * (1.0 + share / cosh2);
                (s, move |h| 2.0 * self.critical * cosh2 * (h * clear.sqrt() - flat * s))
            });
            // B = b_c cosh² z.
            rest + flat * self.critical * libm::sinh(high - low) * libm::sinh(high + low)
        };
        part(low, high.min(0.0), &self.inside, 0.0) + part(low.max(0.0), high, &self.outside, 1.0)
    }

    /// The integral between two bounds of a function of h(s), whose singularities next to the real axis are at ±i
    /// `nearest`: `f` gives s and the function of h.
    fn over_panels<F: Fn(f64) -> f64>(
        &self,
        fit: &Chebyshev,
        (low, high): (f64, f64),
        nearest: f64,
        f: impl Fn(Hyperbolic) -> (f64, F),
    ) -> f64 {
        let delta = nearest.max(NEAREST);
        let [first, last] = [low, high].map(|bound| libm::asinh(bound / delta));
        let panels = ((last - first) / PANEL).ceil().max(1.0);
        let half = 0.5 * (last - first) / panels;
        let mut sum = 0.0;
        for panel in 0..panels as usize {
            let middle = first + (2 * panel + 1) as f64 * half;
            for (nodes, weights) in &self.rules[RULE] {
                let v = nodes.map(|node| Hyperbolic::of(middle + half * node));
                let at = v.map(|v| f(Hyperbolic::of(delta * v.sinh)));
                let s: Lanes = std::array::from_fn(|lane| at[lane].0);
                let [h, _] = fit.at_each(s);
                for lane in 0..LANES {
                    sum += weights[lane] * delta * v[lane].cosh * at[lane].1(h[lane]);
                }
            }
        }
        half * sum
    }
}

/// Hyperbolic functions of a number.
#[derive(Clone, Copy)]
struct Hyperbolic {
    sinh: f64,
    cosh: f64,
    /// cosh − 1.
    excess: f64,
}

impl Hyperbolic {
    /// All from one exponential, without cancellation.
    fn of(x: f64) -> Self {
        let grown = libm::expm1(x.abs());
        let shrunk = grown / (1.0 + grown);
        let excess = 0.5 * grown * shrunk;
        Self { sinh: (0.5 * (grown + shrunk)).copysign(x), cosh: 1.0 + excess, excess }
    }
}
