//! Errors of a scene. Every message names the file, the place and the remedy.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::asset::AssetError;
use crate::text;

/// A scene that cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read from disk.
    #[error("{}: cannot be read: {source}\n   = help: check the path", name(path))]
    Read {
        /// The file.
        path: PathBuf,
        /// Error from the operating system.
        source: io::Error,
    },
    /// The file's extension is not that of a scene.
    #[error("{}: {problem}\n   = help: {help}", name(path))]
    UnknownType {
        /// The file.
        path: PathBuf,
        /// Problem: the kind of file, if known.
        problem: String,
        /// Remedy: how to make a scene of it.
        help: &'static str,
    },
    /// A place in the scene file is wrong.
    #[error("{}:{diagnostic}\n   = help: {}", name(path), text::lines(help))]
    Located {
        /// The scene file.
        path: PathBuf,
        /// Line, column and problem.
        diagnostic: Box<Diagnostic>,
        /// Remedy.
        help: String,
    },
    /// The scene as a whole is wrong.
    #[error("{}: {}\n   = help: {}", name(path), text::line(problem), text::line(help))]
    Whole {
        /// The scene file.
        path: PathBuf,
        /// Problem, in words.
        problem: String,
        /// Remedy.
        help: String,
    },
    /// An override is malformed or leads nowhere.
    #[error("--set {}: {}\n   = help: {}", text::quoted(text), text::line(problem), text::line(help))]
    Override {
        /// The override as given.
        text: String,
        /// Problem, in words.
        problem: String,
        /// Remedy.
        help: String,
    },
    /// A geometry or image file is wrong.
    #[error(transparent)]
    Asset(#[from] AssetError),
}

/// A path as a message shows it.
fn name(path: &Path) -> String {
    text::quoted(&path.display().to_string()).into_owned()
}

/// A problem at a place of a text file; displays as the position, the problem, and the source line with a caret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Problem, in words.
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

impl Diagnostic {
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

/// Characters of a line that are shown before and after the start of its caret.
const BEFORE_CARET: usize = 80;
const AFTER_CARET: usize = 120;

impl Diagnostic {
    /// The line around the caret, and the caret's column in it and width, in characters as they are shown.
    fn window(&self) -> (String, usize, usize) {
        let start = self.column - 1;
        let first = start.saturating_sub(BEFORE_CARET);
        let characters = self.source_line.chars().skip(first);
        let (mut window, mut column, mut width) = (String::new(), 0, 0);
        if first > 0 {
            window.push('…');
            column += 1;
        }
        for (index, c) in (first..).zip(characters) {
            if index == start + AFTER_CARET {
                window.push('…');
                break;
            }
            let shown: String = if c == '\t' { ' '.to_string() } else { text::shown(c).collect() };
            let cells = shown.chars().count();
            column += if index < start { cells } else { 0 };
            width += if (start..start + self.width).contains(&index) { cells } else { 0 };
            window.push_str(&shown);
        }
        (window, column, width.max(1))
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let gutter = self.line.to_string().len();
        let (window, column, width) = self.window();
        writeln!(f, "{}:{}: {}", self.line, self.column, text::line(&self.problem))?;
        writeln!(f, "{:gutter$} |", "")?;
        writeln!(f, "{} | {window}", self.line)?;
        write!(f, "{:gutter$} | {:column$}{}", "", "", "^".repeat(width))
    }
}

/// Something wrong with a scene, before the file and the line are attached.
#[derive(Debug)]
pub(super) enum Fault {
    /// A value that makes no sense.
    Value {
        /// Byte range in the scene file, if the fault has a place there.
        span: Option<Range<usize>>,
        /// Problem, in words.
        problem: String,
        /// Remedy.
        help: String,
    },
    /// An asset that the scene file names at `span`.
    Asset {
        /// Byte range in the scene file.
        span: Range<usize>,
        /// Error of the asset.
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
        let diagnostic = Box::new(Diagnostic::new(self.text, span, problem));
        let written =
            self.on_disk.is_some_and(|text| text.lines().any(|line| line == diagnostic.source_line));
        let help = if written { help } else { format!("{help}\n   = note: --set put this line there") };
        SceneError::Located { path, diagnostic, help }
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
        let diagnostic = Diagnostic::new("a = 1\nβ = -2\n", 11..13, "must be positive".into());
        assert_eq!(diagnostic.to_string(), "2:5: must be positive\n  |\n2 | β = -2\n  |     ^^");
    }

    #[test]
    fn a_place_in_a_long_line_shows_what_is_around_the_caret() {
        let text = format!("{}\tkey\u{1b}{}\n", "a".repeat(1_000_000), "b".repeat(1_000_000));
        let shown = Diagnostic::new(&text, 1_000_001..1_000_005, "odd\nname".into()).to_string();
        let lines: Vec<&str> = shown.lines().collect();
        assert_eq!(lines[0], "1:1000002: odd\\nname");
        assert!(lines[2].starts_with("1 | …aaa") && lines[2].ends_with("bbb…"), "{shown}");
        assert!(lines.iter().all(|line| line.chars().count() < 250), "{shown}");
        let caret = |line: &str| line.chars().take_while(|c| *c != '^').count();
        let key = lines[2].chars().skip(caret(lines[3])).take(9);
        assert_eq!(key.collect::<String>(), "key\\u{1b}");
        assert_eq!(lines[3].matches('^').count(), 9);
    }

    #[test]
    fn a_place_beyond_the_text_does_not_panic() {
        let diagnostic = Diagnostic::new("é", 1..99, "odd".into());
        assert_eq!((diagnostic.line, diagnostic.column, diagnostic.width), (1, 1, 1));
        Diagnostic::new("", 3..7, "empty".into());
    }

    #[test]
    fn only_near_words_are_suggested() {
        assert_eq!(suggestion("albdo", ["name", "albedo"]), Some("did you mean `albedo`?".into()));
        assert_eq!(suggestion("zzz", ["name", "albedo"]), None);
    }
}
