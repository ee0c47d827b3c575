//! Outcome of a command.

/// Outcome of a command that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Completion {
    /// All is there.
    Good,
    /// Something was lost, and `--strict` was given.
    Lost,
    /// Some pixels have no sample.
    Incomplete,
    /// Pictures differ by more than a flag allows.
    Differ,
}
