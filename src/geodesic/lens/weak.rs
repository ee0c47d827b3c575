//! Rays that keep away from the photon sphere, in closed form.
//!
//! There κ − 1 is a short polynomial of b_c/B = m sin θ, m = b_c/b, so that the angle swept is a sum of integrals of
//! powers of sines:
//!
//! ```text
//! κ = 1 + Σ c_k (b_c/B)^k,   φ = γ + Σ c_k m^k J_k,   k J_k = [−cos θ sin^(k−1) θ] + (k − 1) J_(k−2).
//! ```
//!
//! For m > 1 the recurrence is unstable; but then rays do not turn, and a rule of a few nodes does for
//!
//! ```text
//! φ = ∫ κ du/√(m² − u²),   u = b_c/B.
//! ```

use std::f64::consts::PI;

use crate::geodesic::areal_series::small_sinc_cos;
use crate::math::chebyshev::Chebyshev;
use crate::math::quadrature::gauss_legendre;

/// κ outside of a sphere around the photon sphere.
#[derive(Clone, Debug)]
pub struct WeakBending {
    /// b_c.
    critical: f64,
    /// c_k, from k = 1 on.
    terms: [f64; TERMS],
    /// Nodes and weights of a Gauss–Legendre rule that is as good as the polynomial.
    rule: [(f64, f64); NODES],
}

/// Bending of a ray that may turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    /// Angle swept beyond that of the straight line.
    pub(super) excess: f64,
    /// Its derivative by b at fixed angles, times −b.
    pub(super) by_m: f64,
    /// κ at both ends.
    pub(super) at_ends: [f64; 2],
}

impl Bend {
    /// The angle swept, and its derivative by that of the straight line, `gamma`, with which the angle at the far end changes
    /// by `turn` and ln b by `db`.
    #[inline(always)]
    pub(super) fn by_angle(&self, (gamma, turn): (f64, f64), db: f64) -> (f64, f64) {
        let Self { excess, by_m, at_ends: [at_near, at_far] } = *self;
        (gamma + excess, at_near * (1.0 + turn) - at_far * turn - by_m * db)
    }
}

/// Terms of the polynomial.
const TERMS: usize = 16;
/// Largest b_c/B on a ray.
const REACH: f64 = 0.75;
/// Nodes of the rule.
const NODES: usize = 8;
/// Least angle swept by the straight line, radians: below, rounding weighs more than the tolerances that terms allow.
const SHORTEST: f64 = 1e-8;

/// Calls a closure for each number below a constant, written out: only straight-line code runs lane beside lane.
macro_rules! each {
    ($add:ident below $count:ident: $($i:literal)*) => {
        const { assert!($count == [$($i),*].len(), "write out all") };
        $($add($i);)*
    };
}

pub(super) use each;

impl WeakBending {
    /// Fits `stretch`, κ as a function of b_c/B, to a relative `tolerance`; `None` if that takes more terms.
    pub(super) fn fit(critical: f64, tolerance: f64, stretch: impl Fn(f64) -> f64) -> Option<Self> {
        let whole = Chebyshev::fit(2 * TERMS, (0.0, REACH), |share| (stretch(share) - 1.0) / share);
        let powers = whole.trimmed(tolerance).powers();
        let mut terms = [0.0; TERMS];
        terms.get_mut(..powers.len())?.copy_from_slice(&powers);
        let mut rule = [(0.0, 0.0); NODES];
        rule.copy_from_slice(&gauss_legendre(NODES));
        Some(Self { critical, terms, rule })
    }

    /// True if no place nearer than one of b_c/B = `share` is too near.
    #[inline(always)]
    pub(super) fn reaches(share: f64) -> bool {
        share <= REACH
    }

    /// True if [`bend`](Self::bend) tells how a ray is bent: if it turns, and no part of it is too near, nor all of it too
    /// short. Its straight line leaves the nearer place, of b_c/B = `near`, at this cosine to the radius and sweeps the angle
    /// `gamma`.
    #[inline(always)]
    pub(super) fn tells(near: f64, leaving: f64, gamma: f64, m: f64) -> bool {
        (m <= 1.0) & Self::reaches(if leaving < 0.0 { m } else { near }) & (gamma > SHORTEST)
    }

    /// The bend of a ray of m ≤ 1 between two places with these b_c/B, that of the nearer one first: of these cosines of
    /// the angle to the radius, with the angle `gamma` between them along a straight line.
    #[inline(always)]
    pub(super) fn bend(
        &self,
        [near, far]: [f64; 2],
        [leaving, arriving]: [f64; 2],
        gamma: f64,
        m: f64,
    ) -> Bend {
        let (leaving, arriving, m2) = (m * leaving, m * arriving, m * m);
        let (mut near_power, mut far_power) = (1.0, 1.0);
        // k m^k J_k of the last k, and of the one before.
        let (mut last, mut before) = (0.0, 0.0);
        let (mut excess, mut by_m) = (0.0, 0.0);
        let (mut at_near, mut at_far) = (1.0, 1.0);
        let mut add = |i: usize| {
            let k = (i + 1) as f64;
            let earlier = if i == 1 { gamma * m2 } else { before * (m2 * ((k - 1.0) / (k - 2.0))) };
            let integral = arriving * far_power - leaving * near_power + earlier;
            (before, last) = (last, integral);
            excess += self.terms[i] * (1.0 / k) * integral;
            by_m += self.terms[i] * integral;
            (near_power, far_power) = (near_power * near, far_power * far);
            at_near += self.terms[i] * near_power;
            at_far += self.terms[i] * far_power;
        };
        each!(add below TERMS: 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15);
        Bend { excess, by_m, at_ends: [at_near, at_far] }
    }

    /// φ and dφ/dm of a ray of m > 1 between two places with b_c/B of at most `near`, by how much less the other's is.
    #[inline(always)]
    pub(super) fn pass(&self, (near, gap): (f64, f64), m: f64) -> (f64, f64) {
        let half = 0.5 * gap;
        let middle = near - half;
        let (mut swept, mut slope) = (0.0, 0.0);
        let mut add = |i: usize| {
            let (node, weight) = self.rule[i];
            let u = middle + half * node;
            let per_square = 1.0 / ((m - u) * (m + u));
            let share = weight * self.stretch(u) * per_square.sqrt();
            swept += share;
            slope += share * per_square;
        };
        each!(add below NODES: 0 1 2 3 4 5 6 7);
        (half * swept, -m * half * slope)
    }

    /// κ at a b_c/B.
    #[inline(always)]
    fn stretch(&self, u: f64) -> f64 {
        1.0 + self.terms.iter().rev().fold(0.0, |sum, term| (sum + term) * u)
    }

    /// Cosine and sine of the angle that a ray of impact parameter `b` sweeps on its way to infinity, from a place with
    /// this 1/B and with this cosine and sine of the angle between ray and radius; and true if they are known: if the ray
    /// is nowhere too near, and would turn.
    #[inline(always)]
    pub fn to_infinity(&self, b: f64, q: f64, [cos, sin]: [f64; 2]) -> ([f64; 2], bool) {
        let (share, m) = (self.critical * q, self.critical / b);
        let is_known = (m <= 1.0) & (if cos < 0.0 { m } else { share } <= REACH);
        let (leaving, m2, angle) = (m * cos, m * m, angle(cos, sin));
        let mut power = 1.0;
        // k m^k J_k of the last k, and of the one before.
        let (mut last, mut before) = (0.0, 0.0);
        let mut half = 0.0;
        let mut add = |i: usize| {
            let k = (i + 1) as f64;
            let integral = match i {
                0 => m - leaving,
                1 => angle * m2 - leaving * power,
                _ => before * (m2 * ((k - 1.0) / (k - 2.0))) - leaving * power,
            };
            (before, last) = (last, integral);
            half += self.terms[i] * (0.5 / k) * integral;
            power *= share;
        };
        each!(add below TERMS: 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15);
        (turned([cos, sin], half), is_known)
    }
}

/// Cosine and sine of an angle with these, and twice `half` more.
#[inline(always)]
pub(super) fn turned([cos, sin]: [f64; 2], half: f64) -> [f64; 2] {
    let (sinc, c) = small_sinc_cos(half);
    let s = half * sinc;
    let (sin_bend, versine) = (2.0 * s * c, 2.0 * s * s);
    let turned = |along: f64, across: f64| along - along * versine + across * sin_bend;
    [turned(cos, -sin), turned(sin, cos)]
}

/// The angle with this cosine and sine, not negative, to 1e-10.
#[inline(always)]
pub(super) fn angle(cos: f64, sin: f64) -> f64 {
    // Tangents of a half and of a quarter of it, or of what it lacks to a half turn.
    let half = sin / (1.0 + cos.abs());
    let quarter = half / (1.0 + (1.0 + half * half).sqrt());
    let square = quarter * quarter;
    let mut sum = 1.0 / 25.0;
    for k in (0..12).rev() {
        sum = 1.0 / f64::from(2 * k + 1) - square * sum;
    }
    let angle = 4.0 * quarter * sum;
    if cos < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_arc_tangent() {
        for i in 0..=1000 {
            let exact = 1e-3 * PI * f64::from(i);
            let found = angle(libm::cos(exact), libm::sin(exact));
            assert!((found - exact).abs() < 1e-10, "{exact}: {found}");
        }
    }
}
