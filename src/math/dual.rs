//! Numbers that carry a derivative along (forward-mode automatic differentiation).
//!
//! Reference: Griewank, Walther 2008, "Evaluating Derivatives", 2nd ed., ch. 3.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::real::Real;

/// A value and its derivative with respect to one input. Values are computed as they are without the derivative, bit
/// for bit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Dual<R> {
    /// The value.
    pub value: R,
    /// Its derivative.
    pub slope: R,
}

impl<R: Real> PartialEq for Dual<R> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<R: Real> PartialOrd for Dual<R> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<R: Real> Add for Dual<R> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<R: Real> Sub for Dual<R> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<R: Real> Mul for Dual<R> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }
}

impl<R: Real> Div for Dual<R> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl<R: Real> Neg for Dual<R> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<R: Real> Real for Dual<R> {
    const EPSILON: f64 = R::EPSILON;

    fn of(x: f64) -> Self {
        Self { value: R::of(x), slope: R::of(0.0) }
    }

    fn value(self) -> f64 {
        self.value.value()
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self { value: root, slope: self.slope / (root + root) }
    }

    fn abs(self) -> Self {
        if self.value < R::of(0.0) { -self } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivative_of_a_formula_is_that_of_its_closed_form() {
        let f = |x: Dual<f64>| ((x * x + Dual::of(1.0)).sqrt() / x - x.abs()) * -x;
        for x in [-2.5_f64, -0.3, 0.7, 4.0] {
            let got = f(Dual { value: x, slope: 1.0 });
            let exact = -x / (x * x + 1.0).sqrt() + 2.0 * x.abs();
            assert_eq!(got.value, ((x * x + 1.0).sqrt() / x - x.abs()) * -x);
            assert!((got.slope - exact).abs() < 1e-14, "at {x}: {} for {exact}", got.slope);
        }
    }
}
