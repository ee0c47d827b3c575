//! Products of power series, a power at a time.

use super::real::Real;

/// Sum of products a_i b_{n−i}.
#[inline(always)]
pub fn product<R: Real, const P: usize>(a: &[R; P], b: &[R; P], n: usize) -> R {
    let mut sum = a[0] * b[n];
    for i in 1..n + 1 {
        sum = sum + a[i] * b[n - i];
    }
    sum
}

/// Sum of products a_i a_{n−i}, by symmetry.
#[inline(always)]
pub fn square<R: Real, const P: usize>(a: &[R; P], n: usize) -> R {
    let mut sum = R::of(0.0);
    for i in 0..n.div_ceil(2) {
        sum = sum + a[i] * a[n - i];
    }
    sum = sum + sum;
    if n.is_multiple_of(2) { sum + a[n / 2] * a[n / 2] } else { sum }
}
