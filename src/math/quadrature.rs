//! Integrals of smooth functions.

use std::f64::consts::PI;

/// Positive nodes and weights of Gauss–Legendre quadrature of order 16 on [−1, 1].
const NODES: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// The mean of `f` over [0, 1]: exact for polynomials of degree 15.
pub fn mean(f: impl Fn(f64) -> f64) -> f64 {
    NODES.map(|(x, weight)| 0.5 * weight * (f(0.5 - 0.5 * x) + f(0.5 + 0.5 * x))).iter().sum()
}

/// A Gauss–Legendre rule of `count` nodes on [−1, 1], as (node, weight): exact for polynomials of degree 2 `count` − 1.
///
/// Nodes by Newton's method on Legendre's recurrence \[Press et al. 2007, "Numerical Recipes", 3rd ed., 4.6\].
pub fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let node = |index: usize| {
        let mut x = libm::cos(PI * (index as f64 + 0.75) / (count as f64 + 0.5));
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut here, mut before) = (1.0, 0.0);
            for k in 0..count {
                let k = k as f64;
                (here, before) = (((2.0 * k + 1.0) * x * here - k * before) / (k + 1.0), here);
            }
            slope = count as f64 * (x * here - before) / (x * x - 1.0);
            x -= here / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_of_any_length_integrate_even_powers_exactly() {
        for count in [4, 7, 16, 64, 128] {
            for power in 0..count as i32 {
                let sum: f64 = gauss_legendre(count).iter().map(|(x, w)| w * x.powi(2 * power)).sum();
                let exact = 2.0 / f64::from(2 * power + 1);
                assert!((sum - exact).abs() < 1e-13, "{count} nodes, power {}: {sum}", 2 * power);
            }
        }
    }

    #[test]
    fn means_of_powers_are_exact_up_to_degree_15() {
        for power in 0..16 {
            let exact = 1.0 / f64::from(power + 1);
            assert!((mean(|x| x.powi(power)) - exact).abs() < 1e-15, "power {power}");
        }
        assert!((mean(|x| x.powi(16)) - 1.0 / 17.0).abs() > 1e-12);
    }
}
