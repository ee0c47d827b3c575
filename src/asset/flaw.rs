//! What can be wrong inside a file.

/// Something wrong inside a file, before the file's name is attached.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw {
    /// What is wrong, and where in the file.
    pub problem: String,
    /// What to do about it.
    pub help: String,
}

impl Flaw {
    /// A flaw from its two sentences.
    pub fn new(problem: impl Into<String>, help: impl Into<String>) -> Self {
        Self { problem: problem.into(), help: help.into() }
    }

    /// The same flaw, with the place in the file in front.
    pub fn at(self, place: impl std::fmt::Display) -> Self {
        Self { problem: format!("{place}: {}", self.problem), ..self }
    }
}
