//! Coordinate time along an orbit.
//!
//! dt = n² dσ = n²/w² dψ is singular at infinity, w = 0. From p = dx/dσ and dp/dσ = ½∇n² follows
//! d(x·p)/dσ = n² − w g, and with x·p = −v/w
//!
//! ```text
//! t = [−v/w] + ∫ g/w dψ.
//! ```
//!
//! The rest grows like a logarithm. With g₀ = g(0), with v = dw/dψ and its sign s, which does not change within a
//! step,
//!
//! ```text
//! ∫ g/w dψ = s g₀ ln(w₁/w₀) + ∫ (g − s g₀ v)/w dψ,
//! ```
//!
//! whose integrand is bounded at infinity, or a logarithm: there g and |v| = √(n² − b²w²) differ from g₀ and 1 by O(w), g of
//! Interstellar's wormhole by O(w ln w). Beside a
//! horizon w is far from 0, and n²/w² is integrated as it is.
//!
//! If a ray is steep, the last integral is one over w, by dψ = dw/v, and so as exact as the ends of the step. A
//! step's length in ψ is not: of a radial ray, which keeps its direction whatever ψ, nothing controls it. Elsewhere v
//! may vanish, and the integral is one over ψ along the step's dense output.

use super::{OrbitStepper, Phase, Step};
use crate::math::quadrature::mean;
use crate::math::real::Real;
use crate::spacetime::ConformallyFlat;

/// Swept angle, radians, below which ψ and ξ are the same number.
const SMALL_ANGLE: f64 = 1e-8;
/// Ratio of the bounds of one panel next to a logarithm.
const PANEL: f64 = 4.0;
/// Tangent of the angle between ray and radius below which the ray is steep.
const STEEP: f64 = 0.5;
/// w g/n² above which the split is left: towards a horizon its parts grow and cancel.
const STRONG: f64 = 4.0;

/// Coordinate time, in the unit of length, that `step` takes; in f64 whatever the step was taken in.
pub fn elapsed<M: ConformallyFlat, R: Real>(medium: &M, stepper: &impl OrbitStepper, step: &Step<R>) -> f64 {
    let (b, h) = (step.b.value(), step.h.value());
    let [start, end] =
        [step.start, step.end].map(|phase| Phase::new(medium, phase.w.value(), phase.v.value()));
    let sign = (start.v + end.v).signum();
    let far = medium.pull(0.0);
    let near_horizon =
        [start, end].iter().any(|phase| phase.pull * phase.w > STRONG * medium.index_squared(phase.w));
    let rate = |phase: Phase<f64>| {
        if near_horizon {
            medium.index_squared(phase.w) / (phase.w * phase.w)
        } else {
            (phase.pull - sign * far * phase.v) / phase.w
        }
    };
    let steep = [start, end].iter().all(|phase| b * phase.w < STEEP * phase.v.abs());
    let integral = if steep {
        let along = end.w - start.w;
        along
            * mean_between(medium, end.w / start.w, |share| {
                let w = start.w + share * along;
                let v = sign * (medium.index_squared(w) - (b * w).powi(2)).sqrt();
                rate(Phase::new(medium, w, v)) / v
            })
    } else {
        let angle = libm::atan(b * h);
        let small = angle < SMALL_ANGLE;
        let along = if small { h } else { angle / b };
        let parts = stepper.parts(medium, b, start);
        along
            * mean_between(medium, end.w / start.w, |share| {
                let h = if small { share * h } else { libm::tan(share * angle) / b };
                rate(parts(h).end)
            })
    };
    if near_horizon {
        integral
    } else {
        start.v / start.w - end.v / end.w + sign * far * libm::log(end.w / start.w) + integral
    }
}

/// The mean of `f` over [0, 1], where w changes about evenly and by the factor `ratio`: finely next to infinity if there
/// is a logarithm.
#[inline(always)]
fn mean_between<M: ConformallyFlat>(medium: &M, ratio: f64, f: impl Fn(f64) -> f64) -> f64 {
    if medium.mouth() == 0.0 {
        return mean(f);
    }
    let least = ratio.min(1.0 / ratio);
    let from_least = |share: f64| f(if ratio < 1.0 { 1.0 - share } else { share });
    let (mut sum, mut high) = (0.0, 1.0);
    while high > PANEL * least && high > f64::EPSILON {
        let low = high / PANEL;
        sum += (high - low) * mean(|share| from_least(low + share * (high - low)));
        high = low;
    }
    sum + high * mean(|share| from_least(share * high))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geodesic::{Control, Dop853, Launch, OrbitEnd, Rkn6, follow};
    use crate::spacetime::Schwarzschild;

    /// r_s.
    const HOLE: f64 = 0.7;

    /// Time from `x` in the direction `d` out to the isotropic radius `r_out`.
    fn time(stepper: impl OrbitStepper, tolerance: f64, x: DVec3, d: DVec3, r_out: f64) -> f64 {
        let medium = Schwarzschild::new(HOLE);
        let launch = Launch::new(&medium, x, d, f64::EPSILON);
        let control = Control::new(&medium, tolerance, f64::INFINITY);
        let ray = (launch.b, Phase::new(&medium, launch.w, launch.v), launch.fate);
        let mut time = 0.0;
        let journey = follow(&medium, &stepper, &control, ray, 1.0 / r_out, |step| {
            time += elapsed(&medium, &stepper, step);
        });
        assert!(matches!(journey.end, OrbitEnd::Crosses(..)), "{journey:?}");
        time
    }

    /// Eddington's radial coordinate, r + r_s ln(r/r_s − 1) of the areal radius r, at the isotropic radius `rho`.
    fn tortoise(rho: f64) -> f64 {
        let u = HOLE / (4.0 * rho);
        // r/r_s − 1 = (1 − u)²/4u.
        rho * (1.0 + u).powi(2) + HOLE * ((1.0 - u).powi(2) / (4.0 * u)).ln()
    }

    #[test]
    fn a_radial_ray_takes_the_difference_of_eddingtons_coordinate_at_any_tolerance() {
        for (from, to) in [(0.175001, 0.3), (0.18, 5.0), (0.5, 1e3), (3.0, 3.5), (10.0, 1e9), (1e7, 1e8)] {
            let exact = tortoise(to) - tortoise(from);
            for tolerance in [1e-2, 1e-10] {
                let rkn6 = time(Rkn6, tolerance, DVec3::X * from, DVec3::X, to);
                let dop853 = time(Dop853, tolerance, DVec3::Y * from, DVec3::Y, to);
                for found in [rkn6, dop853] {
                    let error = (found - exact).abs() / (exact + HOLE);
                    assert!(error < 1e-10, "{from} to {to} at {tolerance:e}: {found}, exactly {exact}");
                }
            }
        }
    }

    #[test]
    fn time_runs_alike_both_ways() {
        // A ray that goes in to its periastron first comes back to where the other one starts.
        let (x, tangent) = (2.0 * DVec3::X, DVec3::Y);
        let inwards = time(Dop853, 1e-12, x, tangent - 0.3 * x, 40.0);
        let outwards = time(Dop853, 1e-12, x, tangent + 0.3 * x, 40.0);
        let there_and_back = time(Dop853, 1e-12, x, tangent - 0.3 * x, 2.0);
        assert!((inwards - outwards - there_and_back).abs() < 1e-11, "{inwards} {outwards} {there_and_back}");
    }
}
