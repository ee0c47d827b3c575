//! What can be wrong with a scene. Every message names the file, the place and the remedy.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::asset::AssetError;

/// A scene that cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read from disk.
    #[error("{}: cannot be read: {source}\n   = help: check the path", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file's extension is not that of a scene.
    #[error("{}: not a scene file\n   = help: a scene is a .toml, .gltf, .glb or .obj file", path.display())]
    UnknownType {
        /// The file.
        path: PathBuf,
    },
    /// A place in the scene file is wrong.
    #[error("{}:{place}\n   = help: {help}", path.display())]
    Located {
        /// The scene file.
        path: PathBuf,
        /// Line, column and problem.
        place: Box<Place>,
        /// What to do about it.
        help: String,
    },
    /// The scene as a whole is wrong.
    #[error("{}: {problem}\n   = help: {help}", path.display())]
    Whole {
        /// The scene file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        help: String,
    },
    /// An override is malformed or leads nowhere.
    #[error("--set {text}: {problem}\n   = help: {help}")]
    Override {
        /// The override as given.
        text: String,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        help: String,
    },
    /// A geometry or image file is wrong.
    #[error(transparent)]
    Asset(#[from] AssetError),
}

/// A problem at a place of a text file; displays as the position, the problem, and the source line with a caret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// What is wrong.
    pub problem: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The line itself.
    pub source_line: String,
    /// Number of characters that the caret underlines, ≥ 1.
    pub width: usize,
}

impl Place {
    fn new(text: &str, span: Range<usize>, problem: String) -> Self {
        let start = floor_boundary(text, span.start);
        let before = text.get(..start).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let source_line = text.get(line_start..).unwrap_or_default().lines().next().unwrap_or_default();
        let column = before.get(line_start..).unwrap_or_default().chars().count();
        let on_line = source_line.chars().count().saturating_sub(column);
        let end = floor_boundary(text, span.end.max(start));
        let spanned = text.get(start..end).unwrap_or_default().chars().count();
        Self {
            problem,
            line: before.matches('\n').count() + 1,
            column: column + 1,
            source_line: source_line.to_owned(),
            width: spanned.min(on_line).max(1),
        }
    }
}

/// The largest character boundary of `text` that is not after `index`.
fn floor_boundary(text: &str, index: usize) -> usize {
    (0..=index.min(text.len())).rev().find(|&index| text.is_char_boundary(index)).unwrap_or(0)
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let gutter = self.line.to_string().len();
        writeln!(f, "{}:{}: {}", self.line, self.column, self.problem)?;
        writeln!(f, "{:gutter$} |", "")?;
        writeln!(f, "{} | {}", self.line, self.source_line)?;
        write!(f, "{:gutter$} | {:pad$}{}", "", "", "^".repeat(self.width), pad = self.column - 1)
    }
}

/// Something wrong with a scene, before the file and the line are attached.
#[derive(Debug)]
pub(super) enum Fault {
    /// A value that makes no sense.
    Value {
        /// Byte range in the scene file, if the fault has a place there.
        span: Option<Range<usize>>,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        help: String,
    },
    /// An asset that the scene file names at `span`.
    Asset {
        /// Byte range in the scene file.
        span: Range<usize>,
        /// What is wrong with the asset.
        error: AssetError,
    },
}

impl Fault {
    /// A fault at a byte range of the scene file.
    pub fn at(span: Range<usize>, problem: impl Into<String>, help: impl Into<String>) -> Self {
        Self::maybe_at(Some(span), problem, help)
    }

    /// A fault of the scene as a whole.
    pub fn whole(problem: impl Into<String>, help: impl Into<String>) -> Self {
        Self::maybe_at(None, problem, help)
    }

    /// A fault that may have a place.
    pub fn maybe_at(span: Option<Range<usize>>, problem: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Value { span, problem: problem.into(), help: help.into() }
    }
}

/// The text of a scene file as it is deserialised, to turn byte ranges into places.
pub(super) struct SourceText<'a> {
    /// The scene file.
    pub path: &'a Path,
    /// Its text, overrides applied.
    pub text: &'a str,
    /// Its text on disk; `None` for a bare model, whose scene text is made up.
    pub on_disk: Option<&'a str>,
}

impl SourceText<'_> {
    /// Attaches file and line.
    pub fn locate(&self, fault: Fault) -> SceneError {
        let (span, problem, help) = match fault {
            Fault::Asset { error, .. } if self.on_disk.is_none() => return SceneError::Asset(error),
            Fault::Asset { span, error } => {
                let message = error.to_string();
                let (problem, help) = message.split_once("\n   = help: ").unwrap_or((&message, ""));
                (Some(span), problem.to_owned(), help.to_owned())
            }
            Fault::Value { span, problem, help } => (span, problem, help),
        };
        let path = self.path.to_owned();
        let Some(span) = span else {
            return SceneError::Whole { path, problem, help };
        };
        let place = Box::new(Place::new(self.text, span, problem));
        let written = self.on_disk.is_some_and(|text| text.lines().any(|line| line == place.source_line));
        let help = if written { help } else { format!("{help}\n   = note: --set put this line there") };
        SceneError::Located { path, place, help }
    }
}

/// `did you mean ...?` for the candidate nearest to `word`, if one is near.
pub(super) fn suggestion<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    /// Below this Jaro–Winkler similarity a suggestion would only puzzle.
    const NEAR: f64 = 0.7;
    let scored = candidates.into_iter().map(|candidate| (strsim::jaro_winkler(word, candidate), candidate));
    let (score, best) = scored.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (score >= NEAR).then(|| format!("did you mean `{best}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_shows_its_line_with_a_caret() {
        let place = Place::new("a = 1\nβ = -2\n", 11..13, "must be positive".into());
        assert_eq!(place.to_string(), "2:5: must be positive\n  |\n2 | β = -2\n  |     ^^");
    }

    #[test]
    fn a_place_beyond_the_text_does_not_panic() {
        let place = Place::new("é", 1..99, "odd".into());
        assert_eq!((place.line, place.column, place.width), (1, 1, 1));
        Place::new("", 3..7, "empty".into());
    }

    #[test]
    fn only_near_words_are_suggested() {
        assert_eq!(suggestion("albdo", ["name", "albedo"]), Some("did you mean `albedo`?".into()));
        assert_eq!(suggestion("zzz", ["name", "albedo"]), None);
    }
}
