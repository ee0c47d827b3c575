//! Failure of a command to give a result, as the user reads it.

use std::error::Error;
use std::fmt;

use crate::film::ReadError;
use crate::film::atomic::OutputError;
use crate::scene::SceneError;
use crate::study::compare::Mismatch;

/// One line `error: …`, then indented lines that say more.
#[derive(Debug)]
pub(super) struct Failure {
    message: String,
    details: Vec<String>,
}

impl Failure {
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), details: Vec::new() }
    }

    /// Adds what the user can do about it.
    pub(super) fn help(mut self, remedy: impl fmt::Display) -> Self {
        self.details.push(format!("help: {remedy}"));
        self
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.message)?;
        self.details.iter().flat_map(|detail| detail.lines()).try_for_each(|line| write!(f, "\n  {line}"))
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::new(error.to_string()).help(error.remedy)
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Self::new(error.to_string()).help(error.flaw.help)
    }
}

impl From<Mismatch> for Failure {
    fn from(error: Mismatch) -> Self {
        Self::new(error.cause).help(error.remedy)
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        let text = error.to_string();
        let mut lines = text.lines();
        let message = lines.next().unwrap_or_default().to_owned();
        let mut details: Vec<String> = lines.map(|line| line.trim_start().to_owned()).collect();
        let mut cause = error.source();
        while let Some(error) = cause {
            // Many errors quote their source in their own text; once is enough.
            let said = error.to_string();
            if !text.contains(&said) {
                details.push(said);
            }
            cause = error.source();
        }
        Self { message, details }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn details_are_indented_below_the_message() {
        let failure = Failure::new("no picture").help("take one\nor two");
        assert_eq!(failure.to_string(), "error: no picture\n  help: take one\n  or two");
    }
}
