//! Names and parameters of a spacetime: its side of the table in `kind.rs`.

use super::conformally_flat::ConformallyFlat;
use super::parameter::Parameter;

/// A static, spherical spacetime that scenes, tables of rays and commands know by name.
pub trait Named: ConformallyFlat {
    /// Name in scene files and on the command line.
    const NAME: &'static str;
    /// Name in descriptions.
    const TITLE: &'static str;
    /// One line for the command line's help.
    const SUMMARY: &'static str;
    /// Parameters in the order of [`Self::new`]'s values.
    const PARAMETERS: &'static [Parameter];

    /// The spacetime with these parameters; of values out of their ranges nothing is promised.
    fn new(values: &[f64]) -> Self;

    /// Values of the parameters.
    fn values(&self) -> Vec<f64>;
}
