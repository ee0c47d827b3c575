//! Names and parameters of a spacetime: its side of the table in `kind.rs`.

use super::parameter::Parameter;

/// A spacetime that scenes, tables of rays and commands know by name.
pub trait Named: Sized {
    /// Name in scene files and on the command line.
    const NAME: &'static str;
    /// Name in descriptions.
    const TITLE: &'static str;
    /// One line for the command line's help.
    const SUMMARY: &'static str;
    /// Parameters in the order of [`Self::new`]'s values.
    const PARAMETERS: &'static [Parameter];

    /// Problem with values that are each within bounds but not together, and its remedy.
    fn conflict(_values: &[f64]) -> Option<(String, String)> {
        None
    }

    /// The spacetime with these parameters; of values out of their ranges nothing is promised.
    fn new(values: &[f64]) -> Self;

    /// Values of the parameters.
    fn values(&self) -> Vec<f64>;
}
