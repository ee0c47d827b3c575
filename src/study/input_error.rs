//! Error of a study's input: rays that cannot be followed, points that no ray can join.

/// Error: a ray cannot be followed, or two points cannot be joined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{cause}")]
pub struct InputError {
    /// Input at fault.
    pub input: Input,
    /// Problem, in words.
    pub cause: String,
    /// Remedy.
    pub remedy: String,
}

/// Quantity that describes a ray or a pair of points, or how the ray is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// The parameter of the spacetime that tables have in this column.
    Parameter(&'static str),
    /// The columns of these names.
    Columns(&'static [&'static str]),
    /// The spacetime.
    Spacetime,
    /// The stepper.
    Stepper,
    /// Numbers that the ray is followed in.
    Precision,
    /// Position of a pair's points relative to each other.
    Both,
}
