//! Tables of rays, by family of spacetimes: which columns describe a ray, which are found, and by what code.

use glam::DVec3;

use super::super::input_error::{Input, InputError};
use super::super::table::Cell;
use super::{Accuracy, FreeRayEnd};
use crate::scene::{StepperKind, flag_name};
use crate::spacetime::SpacetimeKind;

/// Form of the tables of rays of a family of spacetimes.
pub struct TableForm {
    /// Columns that describe a ray and that every table has.
    pub needed: &'static [&'static str],
    /// Columns that describe a ray where a table has them; cells may be empty.
    pub optional: &'static [&'static str],
    /// Columns that are found, between the status of a ray and the number of its steps.
    pub results: &'static [&'static str],
    /// Columns of a ray's crossing of the sphere: position, direction or momentum, sensitivity.
    pub crossing: [&'static str; 7],
    /// Steppers that follow the rays.
    pub steppers: &'static [StepperKind],
    /// Stepper where none is asked for, if not that of the quality.
    pub stepper: Option<StepperKind>,
    /// Radius of a ray's sphere, in the chart.
    pub radius: fn(&SpacetimeKind, &Cells) -> f64,
    /// Follows a ray for all columns that are found.
    pub trace: fn(&SpacetimeKind, &Cells, &Accuracy) -> Result<Traced, InputError>,
    /// Follows a ray for its end only.
    pub arrive: fn(&SpacetimeKind, &Cells, &Accuracy) -> Result<Arrival, InputError>,
}

/// Cells of a row that describe a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Of the columns [`TableForm::needed`].
    pub needed: Vec<f64>,
    /// Of the columns [`TableForm::optional`]; `None` in an empty cell and without the column.
    pub optional: Vec<Option<f64>>,
}

/// A ray, followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// Status at its end.
    pub status: FreeRayEnd,
    /// State on the sphere, if it escaped.
    pub crossing: Option<SphereCrossing>,
    /// Cells of the columns [`TableForm::results`].
    pub cells: Vec<Cell>,
    /// Steps tried.
    pub steps: u32,
}

/// State in which a ray crosses its sphere, in whatever chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereCrossing {
    /// Position, in the chart.
    pub position: DVec3,
    /// Unit vector of the direction of travel, or of the momentum.
    pub direction: DVec3,
    /// Radians there per radian of the starting direction; at least 1.
    pub sens: f64,
}

/// A ray, followed for its end only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Status at its end.
    pub status: FreeRayEnd,
    /// Position of the crossing of the sphere, in the chart, and unit direction there, if it escaped.
    pub crossing: Option<(DVec3, DVec3)>,
    /// Steps tried.
    pub steps: u32,
}

impl Cells {
    /// The last of the needed cells, where that is the radius of the sphere.
    pub(super) fn last(&self) -> f64 {
        self.needed.last().copied().unwrap_or(f64::NAN)
    }
}

impl TableForm {
    /// Checks that a stepper follows the rays.
    ///
    /// # Errors
    /// If it is none of [`Self::steppers`].
    pub fn check(&self, stepper: StepperKind) -> Result<(), InputError> {
        if self.steppers.contains(&stepper) { Ok(()) } else { Err(self.refusal(stepper)) }
    }

    /// Refusal of a stepper that does not follow the rays.
    pub(super) fn refusal(&self, stepper: StepperKind) -> InputError {
        let others: Vec<String> = self.steppers.iter().map(|&stepper| flag_name(stepper)).collect();
        InputError {
            input: Input::Stepper,
            cause: format!("the stepper {} does not follow the rays of such a table", flag_name(stepper)),
            remedy: format!("take another stepper: {}", others.join(", ")),
        }
    }
}

/// Refusal of a ray in coordinates that its spacetime does not have.
pub(in crate::study) fn other_chart(coordinates: &str) -> InputError {
    InputError {
        input: Input::Spacetime,
        cause: format!("the ray is in {coordinates} coordinates, which the spacetime does not have"),
        remedy: "give another --spacetime".to_owned(),
    }
}
