//! Combinations of ways to follow rays that are worth a measurement.

use super::free::Accuracy;
use crate::geodesic::Control;
use crate::scene::{Precision, StepperKind};

/// Those of `tolerances` to which rays in numbers of `precision` can be held.
pub(super) fn tolerances_for(precision: Precision, tolerances: &[f64]) -> impl Iterator<Item = f64> {
    let least = match precision {
        Precision::F32 => Control::<f32>::least_tolerance(),
        Precision::F64 => Control::<f64>::least_tolerance(),
    };
    tolerances.iter().copied().filter(move |&tolerance| tolerance >= least)
}

/// All combinations, but only tolerances that a precision has; none of the paper's stepper, which knows neither.
pub fn grid(steppers: &[StepperKind], precisions: &[Precision], tolerances: &[f64]) -> Vec<Accuracy> {
    let mut ways = Vec::new();
    for &stepper in steppers.iter().filter(|&&stepper| stepper != StepperKind::Rk4Paper) {
        for &precision in precisions {
            let tolerances = tolerances_for(precision, tolerances);
            ways.extend(tolerances.map(|tolerance| Accuracy { stepper, tolerance, precision }));
        }
    }
    ways
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_has_no_fine_tolerances() {
        let grid = grid(
            &[StepperKind::Rkn6, StepperKind::Rk4Paper],
            &[Precision::F64, Precision::F32],
            &[1e-4, 1e-5, 1e-6],
        );
        let tolerances = |precision| {
            let of = grid.iter().filter(|setting| setting.precision == precision);
            of.map(|setting| setting.tolerance).collect::<Vec<_>>()
        };
        assert_eq!(tolerances(Precision::F64), [1e-4, 1e-5, 1e-6]);
        assert_eq!(tolerances(Precision::F32), [1e-4]);
    }
}
