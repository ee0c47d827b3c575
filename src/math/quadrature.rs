//! Integrals of smooth functions.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_powers_are_exact_up_to_degree_15() {
        for power in 0..16 {
            let exact = 1.0 / f64::from(power + 1);
            assert!((mean(|x| x.powi(power)) - exact).abs() < 1e-15, "power {power}");
        }
        assert!((mean(|x| x.powi(16)) - 1.0 / 17.0).abs() > 1e-12);
    }
}
