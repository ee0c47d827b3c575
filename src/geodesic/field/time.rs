//! Coordinate time along a ray in a field.
//!
//! dt = n² dσ. From p = dx/dσ and dp/dσ = F = ½∇n² follows d(x·p)/dσ = n² + x·F, so that
//!
//! ```text
//! t = [x·p] − ∫ x·F dσ,
//! ```
//!
//! in which far from the middle, where x counts from, the integral grows like a logarithm only. It is taken along the
//! step's dense output, dσ = dτ/(1 − β·Y)², over the logarithm of 1 − β·Y, which may fall by orders of magnitude.

use super::step::{FieldRays, FieldStep, lane};
use crate::geodesic::Stepper;
use crate::math::quadrature::mean;
use crate::spacetime::IndexField;

/// Change of 1 − β·Y below which it counts as constant.
const SMALL_CHANGE: f64 = 1e-6;

/// Coordinate time, in the unit of length, that a step of length `h` from `start` takes.
pub fn elapsed_in_field<F: IndexField, S: Stepper>(
    field: &F,
    stepper: &S,
    start: &FieldRays<1>,
    step: &FieldStep<1>,
    h: f64,
) -> f64 {
    let middle = field.middle();
    let along = |rays: &FieldRays<1>| (lane(&rays.x, 0) - middle).dot(lane(&rays.p, 0));
    let change = step.ahead[0] - 1.0;
    let log = libm::log(step.ahead[0]);
    let integral = mean(|v| {
        // The part of the step at which the logarithm has come so far, and its derivative.
        let (part, slope) = if change.abs() < SMALL_CHANGE {
            (v, 1.0)
        } else {
            let power = libm::exp(v * log);
            ((power - 1.0) / change, power * log / change)
        };
        let part = FieldStep::new::<3>(field, stepper, start, &[part * h]);
        let pull = (lane(&part.end.x, 0) - middle).dot(lane(&part.end.force, 0));
        pull * slope / (part.ahead[0] * part.ahead[0])
    });
    along(&step.end) - along(start) - h * integral
}
