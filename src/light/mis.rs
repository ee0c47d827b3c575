//! Multiple importance sampling: how two ways to find the same light share it.
//!
//! Reference: Veach 1997, "Robust Monte Carlo Methods for Light Transport Simulation", 9.2.

use serde::{Deserialize, Serialize};

/// Heuristic by which light that two densities can find is shared between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Heuristic {
    /// In proportion to the densities.
    Balance,
    /// In proportion to their squares.
    Power,
}

impl Heuristic {
    /// Share of a sample drawn with density `own` where the other way has density `other`, in [0, 1]; shares of both
    /// ways add up to 1.
    #[inline]
    pub fn share(self, own: f64, other: f64) -> f64 {
        // Whichever is larger divides: no overflow, and 0/0 is no share.
        if own <= 0.0 {
            return 0.0;
        }
        let ratio = other / own;
        match self {
            Heuristic::Balance => 1.0 / (1.0 + ratio),
            Heuristic::Power => 1.0 / (1.0 + ratio * ratio),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_to_one_and_lie_between_zero_and_one() {
        for heuristic in [Heuristic::Balance, Heuristic::Power] {
            for a in [1e-300, 1e-9, 0.3, 1.0, 7.0, 1e12, 1e300] {
                for b in [0.0, 1e-300, 1e-9, 0.3, 1.0, 7.0, 1e12, f64::INFINITY] {
                    let (one, other) = (heuristic.share(a, b), heuristic.share(b, a));
                    assert!((0.0..=1.0).contains(&one), "{heuristic:?} {a} {b}: {one}");
                    assert!((one + other - 1.0).abs() < 1e-15, "{heuristic:?} {a} {b}: {one} {other}");
                }
            }
        }
        assert!(Heuristic::Power.share(2.0, 1.0) > Heuristic::Balance.share(2.0, 1.0));
    }
}
