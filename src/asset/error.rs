//! Errors of an asset file.

use std::io;
use std::path::{Path, PathBuf};

use super::files::Files;
use super::flaw::Flaw;
use crate::text;

/// An asset file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum AssetError {
    /// The file cannot be read from disk.
    #[error(
        "{}: cannot be read: {source}\n   = help: check that the file exists; paths in a scene file are relative to that file",
        name(path)
    )]
    Read {
        /// The file.
        path: PathBuf,
        /// Error from the operating system.
        source: io::Error,
    },
    /// The file was read, but its content cannot be used.
    #[error("{}: {}\n   = help: {}", name(path), text::line(problem), text::line(help))]
    Content {
        /// The file.
        path: PathBuf,
        /// Problem, and where in the file.
        problem: String,
        /// Remedy.
        help: String,
    },
}

/// A path as a message shows it.
fn name(path: &Path) -> String {
    text::quoted(&path.display().to_string()).into_owned()
}

impl AssetError {
    /// An error in the content of the file at `path`.
    pub fn content(path: &Path, flaw: Flaw) -> Self {
        AssetError::Content { path: path.to_owned(), problem: flaw.problem, help: flaw.help }
    }

    /// Reads a file whole.
    pub(super) fn read(path: &Path, files: &Files) -> Result<Vec<u8>, Self> {
        files.read(path).map_err(|source| AssetError::Read { path: path.to_owned(), source })
    }
}
