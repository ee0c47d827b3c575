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
//!
//! How far along itself a ray has come after a step is not controlled, since it moves nothing. So a step is followed once
//! more in parts, the last of them to beside its end.

use super::step::{FieldRays, FieldStep, lane};
use crate::geodesic::Dop853;
use crate::math::quadrature::mean;
use crate::spacetime::IndexField;

/// Change of 1 − β·Y below which it counts as constant.
const SMALL_CHANGE: f64 = 1e-6;
/// Parts of a step.
const PARTS: u32 = 6;
/// Corrections of the last part by Newton's method.
const CORRECTIONS: u32 = 5;

/// Part of a step at which the logarithm of 1 − β·Y has come so far, and its derivative, given 1 − β·Y at the end.
fn part_at(v: f64, ahead: f64) -> (f64, f64) {
    let change = ahead - 1.0;
    if change.abs() < SMALL_CHANGE {
        return (v, 1.0);
    }
    let log = libm::log(ahead);
    let power = libm::exp(v * log);
    ((power - 1.0) / change, power * log / change)
}

/// Coordinate time, in the unit of length, that a step of length `h` from `start` takes.
pub(crate) fn elapsed_in_field<F: IndexField>(
    field: &F,
    start: &FieldRays<1>,
    step: &FieldStep<1>,
    h: f64,
) -> f64 {
    let (mut here, mut time) = (*start, 0.0);
    for i in 0..PARTS {
        let [(from, _), (to, _)] =
            [i, i + 1].map(|i| part_at(f64::from(i) / f64::from(PARTS), step.ahead[0]));
        // τ counts from each start.
        let ahead = 1.0 + from * (step.ahead[0] - 1.0);
        let mut h = h * (to - from) / (ahead * ahead);
        let mut part = FieldStep::new::<3>(field, &Dop853, &here, &[h]);
        for _ in 0..if i + 1 == PARTS { CORRECTIONS } else { 0 } {
            // To where the step ends, |dx/dτ| being n/(1 − β·Y)².
            let p = lane(&part.end.p, 0);
            let left = (lane(&step.end.x, 0) - lane(&part.end.x, 0)).dot(p) / p.length_squared();
            h += left * part.ahead[0] * part.ahead[0];
            part = FieldStep::new::<3>(field, &Dop853, &here, &[h]);
        }
        time += elapsed(field, &here, &part, h);
        here = part.end;
    }
    time
}

/// Coordinate time along a part.
fn elapsed(field: &impl IndexField, start: &FieldRays<1>, step: &FieldStep<1>, h: f64) -> f64 {
    let middle = field.middle();
    let along = |rays: &FieldRays<1>| (lane(&rays.x, 0) - middle).dot(lane(&rays.p, 0));
    let integral = mean(|v| {
        let (part, slope) = part_at(v, step.ahead[0]);
        let part = FieldStep::new::<3>(field, &Dop853, start, &[part * h]);
        let pull = (lane(&part.end.x, 0) - middle).dot(lane(&part.end.force, 0));
        pull * slope / (part.ahead[0] * part.ahead[0])
    });
    along(&step.end) - along(start) - h * integral
}
