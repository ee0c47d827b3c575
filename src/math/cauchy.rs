//! Products of power series, a power at a time.

use super::real::Real;

/// Sum of products a_i b_{n−i}. The last coefficients, which the next ones wait for, come in last.
#[inline(always)]
pub fn product<R: Real, const P: usize>(a: &[R; P], b: &[R; P], n: usize) -> R {
    if n == 0 {
        return a[0] * b[0];
    }
    let mut sum = R::of(0.0);
    for i in 1..n {
        sum = sum + a[i] * b[n - i];
    }
    sum + (a[0] * b[n] + a[n] * b[0])
}

/// Sum of products a_i a_{n−i}, by symmetry; in the same order.
#[inline(always)]
pub fn square<R: Real, const P: usize>(a: &[R; P], n: usize) -> R {
    let mut sum = R::of(0.0);
    for i in (1..n.div_ceil(2)).rev() {
        sum = sum + a[i] * a[n - i];
    }
    if n == 0 {
        return a[0] * a[0];
    }
    let middle = if n.is_multiple_of(2) { a[n / 2] * a[n / 2] } else { R::of(0.0) };
    let sum = (sum + sum) + middle;
    let last = a[0] * a[n];
    sum + (last + last)
}
