//! Ways to follow rays, and combinations of them that are worth a measurement.

use super::free::Accuracy;
use super::table::{NONE, TableRow};
use crate::geodesic::Control;
use crate::scene::{Precision, Schedule, Settings, StepperKind, flag_name};

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

/// A way to follow rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// The stepper.
    pub stepper: StepperKind,
    /// Numbers that orbits are followed in.
    pub precision: Precision,
    /// Its tolerance, radians; `None` for a stepper that knows none.
    pub tolerance: Option<f64>,
    /// The schedule; `None` where rays are not rendered.
    pub schedule: Option<Schedule>,
}

impl From<Accuracy> for Way {
    fn from(Accuracy { stepper, tolerance, precision }: Accuracy) -> Self {
        Self { stepper, precision, tolerance: Some(tolerance), schedule: None }
    }
}

impl Way {
    /// All combinations, but only tolerances that a precision has, and for the paper's stepper, which knows neither,
    /// one setting per schedule.
    pub fn grid(
        steppers: &[StepperKind],
        precisions: &[Precision],
        tolerances: &[f64],
        schedules: &[Schedule],
    ) -> Vec<Self> {
        let mut ways = Vec::new();
        for &schedule in schedules {
            for &stepper in steppers {
                if stepper == StepperKind::Rk4Paper {
                    let precision = Precision::F64;
                    ways.push(Self { stepper, precision, tolerance: None, schedule: Some(schedule) });
                }
                let accuracies = grid(&[stepper], precisions, tolerances).into_iter();
                ways.extend(accuracies.map(|accuracy| Self { schedule: Some(schedule), ..accuracy.into() }));
            }
        }
        ways
    }

    /// `base` with this way in it.
    pub(super) fn over(&self, base: &Settings) -> Settings {
        let Self { stepper, precision, .. } = *self;
        let tolerance = self.tolerance.unwrap_or(base.tolerance);
        let schedule = self.schedule.unwrap_or(base.schedule);
        Settings { stepper, tolerance, precision, schedule, ..base.clone() }
    }

    /// Adds the cells that people read.
    pub(super) fn printed(&self, row: TableRow) -> TableRow {
        let tolerance = self.tolerance.map_or(NONE.to_owned(), |tolerance| format!("{tolerance:e}"));
        self.cells(row, tolerance)
    }

    /// Adds the cells that programs read.
    pub(super) fn row(&self, row: TableRow) -> TableRow {
        self.cells(row, self.tolerance.map_or_else(String::new, |tolerance| tolerance.to_string()))
    }

    fn cells(&self, row: TableRow, tolerance: String) -> TableRow {
        let row = row
            .cell("stepper", flag_name(self.stepper))
            .cell("precision", flag_name(self.precision))
            .cell("tolerance", tolerance);
        match self.schedule {
            Some(schedule) => row.cell("schedule", flag_name(schedule)),
            None => row,
        }
    }
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

    #[test]
    fn a_stepper_without_tolerance_is_measured_once_per_schedule() {
        let grid = Way::grid(
            &[StepperKind::Rkn6, StepperKind::Rk4Paper],
            &[Precision::F64, Precision::F32],
            &[1e-2, 1e-6],
            &[Schedule::Wavefront, Schedule::PerPixel],
        );
        assert_eq!(grid.len(), 8);
        assert_eq!(grid.iter().filter(|setting| setting.tolerance.is_none()).count(), 2);
        assert_eq!(grid.iter().filter(|setting| setting.precision == Precision::F32).count(), 2);
    }
}
