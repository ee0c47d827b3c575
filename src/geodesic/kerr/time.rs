//! Kerr–Schild time along a ray.

use super::constants::Constants;
use super::hole::UnitHole;
use super::state::MinoState;
use crate::math::quadrature;

/// Coordinate time that a photon of energy 1 takes over a step of length `h` in λ, with its states `at` parts of it; in
/// units of the mass.
///
/// dt/dλ = Σ + (2/u − e²) G. Of Σ = 1/u² + a²μ², 1/u² = (−v/u)′ + Ku − κu²; of 2G/u, where the ray rises, −4v/u is left
/// to the logarithm: what remains is bounded out to infinity.
pub fn elapsed(hole: &UnitHole, constants: &Constants, h: f64, at: &dyn Fn(f64) -> MinoState) -> f64 {
    let (start, end) = (at(0.0), at(h));
    let falls = start.v > 0.0;
    let rate = |part: f64| {
        let state = at(part);
        let (u, g) = (state.u, state.winding(hole, constants));
        let a_mu = hole.a * state.n.z;
        let drag = if falls { 2.0 * g } else { 2.0 * (g + 2.0 * state.v) } / u;
        constants.k * u - constants.kappa * u * u + a_mu * a_mu + drag - hole.e2 * g
    };
    let far = start.v / start.u - end.v / end.u;
    let logarithm = if falls { 0.0 } else { -4.0 * libm::log(end.u / start.u) };
    let half = |from: f64| quadrature::mean(|x| rate(h * (from + 0.5 * x)));
    far + logarithm + 0.5 * h * (half(0.0) + half(0.5))
}
