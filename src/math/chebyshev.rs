//! Smooth functions on an interval as sums of Chebyshev polynomials.
//!
//! Reference: Trefethen 2013, "Approximation Theory and Approximation Practice", ch. 3 and 19.

use std::f64::consts::PI;

/// A function and its derivative, as sums of Chebyshev polynomials.
#[derive(Clone, Debug, PartialEq)]
pub struct Chebyshev {
    /// Middle of the interval.
    middle: f64,
    /// 1 / half its length.
    scale: f64,
    /// Coefficients of the function and of its derivative, by degree.
    terms: Vec<[f64; 2]>,
}

impl Chebyshev {
    /// The polynomial of degree `count` − 1 that agrees with `f` in `count` ≥ 1 Chebyshev points between `low` and
    /// `high`.
    pub fn fit(count: usize, (low, high): (f64, f64), f: impl Fn(f64) -> f64) -> Self {
        let (middle, scale) = (0.5 * (low + high), 2.0 / (high - low));
        let angle = |k: usize| PI * (k as f64 + 0.5) / count as f64;
        let values: Vec<f64> = (0..count).map(|k| f(middle + libm::cos(angle(k)) / scale)).collect();
        let coefficient = |degree: usize| {
            let sum: f64 =
                values.iter().enumerate().map(|(k, y)| y * libm::cos(degree as f64 * angle(k))).sum();
            sum * if degree == 0 { 1.0 } else { 2.0 } / count as f64
        };
        let mut terms: Vec<[f64; 2]> = (0..count).map(|degree| [coefficient(degree), 0.0]).collect();
        // T′ₙ = 2n Tₙ₋₁ + n/(n − 2) T′ₙ₋₂.
        for degree in (1..count).rev() {
            let above = terms.get(degree + 1).map_or(0.0, |term| term[1]);
            terms[degree - 1][1] = above + 2.0 * scale * degree as f64 * terms[degree][0];
        }
        terms[0][1] *= 0.5;
        Self { middle, scale, terms }
    }

    /// Drops the highest terms, each of which is at most `tolerance`.
    pub fn trimmed(&self, tolerance: f64) -> Self {
        let used = self.terms.iter().rposition(|term| term[0].abs() > tolerance).map_or(1, |last| last + 1);
        Self { terms: self.terms[..used].to_vec(), ..*self }
    }

    /// Reach of the largest ellipse in which the function is likely to be analytic, from the middle of the interval and
    /// in halves of its length, if the terms have fallen to `tolerance`: those of T_n fall like the nth power of the
    /// sum of its half-axes.
    pub fn reach(&self, tolerance: f64) -> f64 {
        let sum = libm::pow(tolerance, -1.0 / self.terms.len() as f64);
        0.5 * (sum + 1.0 / sum)
    }

    /// Coefficients by power of x: as good as terms that fall fast enough.
    pub fn powers(&self) -> Vec<f64> {
        let count = self.terms.len();
        let mut powers = vec![0.0; count];
        // T_n and the one before, by power of x.
        let (mut this, mut before) = (vec![0.0; count], vec![0.0; count]);
        this[0] = 1.0;
        for (degree, term) in self.terms.iter().enumerate() {
            let twice = if degree == 0 { 1.0 } else { 2.0 };
            let mut next: Vec<f64> = this
                .iter()
                .zip(&before)
                .map(|(this, before)| -twice * self.scale * self.middle * this - before)
                .collect();
            for power in 0..count {
                powers[power] += term[0] * this[power];
                if power > 0 {
                    next[power] += twice * self.scale * this[power - 1];
                }
            }
            (this, before) = (next, this);
        }
        powers
    }

    /// Value and derivative at `x`, by Clenshaw's recurrence.
    #[inline]
    pub fn at(&self, x: f64) -> [f64; 2] {
        let [[value], [slope]] = self.at_each([x]);
        [value, slope]
    }

    /// Values and derivatives at several places, lane beside lane.
    #[inline(always)]
    pub fn at_each<const N: usize>(&self, x: [f64; N]) -> [[f64; N]; 2] {
        let x = x.map(|x| (x - self.middle) * self.scale);
        let (mut next, mut after) = ([[0.0; N]; 2], [[0.0; N]; 2]);
        for term in self.terms.iter().rev() {
            for i in 0..2 {
                for lane in 0..N {
                    let here = term[i] + 2.0 * x[lane] * next[i][lane] - after[i][lane];
                    (after[i][lane], next[i][lane]) = (next[i][lane], here);
                }
            }
        }
        [0, 1].map(|i| std::array::from_fn(|lane| next[i][lane] - x[lane] * after[i][lane]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_analytic_function_and_its_derivative_are_met_to_rounding() {
        let fit = Chebyshev::fit(40, (-1.0, 2.0), |x| (1.0 + x).exp() / (2.0 + x));
        for i in 0..=100 {
            let x = -1.0 + 0.03 * f64::from(i);
            let (f, slope) = ((1.0 + x).exp() / (2.0 + x), (1.0 + x).exp() * (1.0 + x) / (2.0 + x).powi(2));
            let [value, derivative] = fit.at(x);
            // Towards the ends rounding of the derivative grows as the square of the number of terms.
            assert!(
                (value - f).abs() < 1e-13 && (derivative - slope).abs() < 1e-10,
                "{x}: {value} {derivative}"
            );
        }
    }

    #[test]
    fn the_terms_tell_how_far_a_function_is_analytic() {
        // A pole at twice the half-length.
        let fit = Chebyshev::fit(60, (0.0, 2.0), |x| 1.0 / (3.0 - x)).trimmed(1e-12);
        assert!((1.8..2.2).contains(&fit.reach(1e-12)), "{}", fit.reach(1e-12));
    }

    #[test]
    fn powers_of_the_argument_make_the_same_polynomial() {
        let fit = Chebyshev::fit(12, (0.0, 0.8), |x| 1.0 / (1.5 - x));
        for i in 0..=10 {
            let x = 0.08 * f64::from(i);
            let value = fit.powers().iter().rev().fold(0.0, |sum, power| sum * x + power);
            assert!((value - fit.at(x)[0]).abs() < 1e-10, "{x}: {value}");
        }
    }

    #[test]
    fn trimming_loses_no_more_than_it_is_allowed() {
        let fit = Chebyshev::fit(40, (-1.0, 1.0), |x| (3.0 * x).cos());
        let short = fit.trimmed(1e-6);
        assert!(short.terms.len() < 20);
        for i in 0..=100 {
            let x = -1.0 + 0.02 * f64::from(i);
            assert!((short.at(x)[0] - fit.at(x)[0]).abs() < 1e-5);
        }
        assert_eq!(Chebyshev::fit(8, (0.0, 1.0), |_| 0.0).trimmed(1e-6).at(0.3), [0.0, 0.0]);
    }
}
