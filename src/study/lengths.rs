//! Lengths that the numbers of a precision can square.

use super::input_error::{Input, InputError};
use crate::scene::Precision;
use crate::spacetime::{Range, SpacetimeKind};

/// Lengths whose products with each other have squares that are numbers.
pub(super) struct Lengths {
    least: f64,
    most: f64,
}

impl Lengths {
    pub(super) fn of(precision: Precision) -> Self {
        match precision {
            Precision::F32 => Self { least: 1e-15, most: 1e15 },
            Precision::F64 => Self { least: 1e-70, most: 1e70 },
        }
    }

    /// Refuses the `length` of `what` that is out of bounds.
    pub(super) fn check(&self, input: Input, what: &str, length: f64) -> Result<(), InputError> {
        let Self { least, most } = *self;
        if (least..=most).contains(&length) {
            return Ok(());
        }
        let remedy = format!("give a length above 0, from {least:e} to {most:e}");
        Err(InputError { input, cause: format!("{what} is {length}"), remedy })
    }

    /// Refuses values that the parameters of a spacetime may not have.
    pub(super) fn check_parameters(&self, spacetime: &SpacetimeKind) -> Result<(), InputError> {
        for (parameter, value) in spacetime.parameters() {
            let input = Input::Parameter(parameter.column);
            if let Some((cause, remedy)) = parameter.out_of_bounds(value) {
                return Err(InputError { input, cause, remedy });
            }
            if parameter.range == Range::Length {
                self.check(input, parameter.noun, value).map_err(|error| InputError {
                    remedy: error.remedy + ", or 0 for flat space",
                    ..error
                })?;
            }
        }
        Ok(())
    }
}

/// Refuses parameters of a spacetime that may not have their values together.
pub(super) fn check_together(spacetime: &SpacetimeKind, input: Input) -> Result<(), InputError> {
    let values: Vec<f64> = spacetime.parameters().map(|(_, value)| value).collect();
    match spacetime.entry().conflict(&values) {
        Some((cause, remedy)) => Err(InputError { input, cause, remedy }),
        None => Ok(()),
    }
}
