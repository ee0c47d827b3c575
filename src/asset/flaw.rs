//! Flaws inside a file.

/// Something wrong inside a file, before the file's name is attached.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw {
    /// Problem, and where in the file.
    pub problem: String,
    /// Remedy.
    pub help: String,
}

impl Flaw {
    /// A flaw from its two sentences.
    pub fn new(problem: impl Into<String>, help: impl Into<String>) -> Self {
        Self { problem: problem.into(), help: help.into() }
    }

    /// Puts the place in the file in front of the problem.
    pub fn at(self, place: impl std::fmt::Display) -> Self {
        Self { problem: format!("{place}: {}", self.problem), ..self }
    }
}
