//! The command in a folder of its own, and what it says.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

use super::{Row, table};

/// A folder in which the command runs.
pub struct Folder(TempDir);

impl Folder {
    /// With files of these names and texts in it.
    pub fn with(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        Self(folder)
    }

    /// The folder itself.
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    /// The path of a file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The text of a file in it.
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// The rows of a table in it.
    pub fn rows(&self, name: &str) -> Vec<Row> {
        table(self.path(name).to_str().unwrap())
    }

    /// Names of all files in it, sorted.
    pub fn files(&self) -> Vec<String> {
        names(self.folder())
    }

    /// Names of all files in it but `known` ones, sorted.
    pub fn files_but(&self, known: &str) -> Vec<String> {
        self.files().into_iter().filter(|name| name != known).collect()
    }

    /// The command, about to run.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_warpfront"));
        command.current_dir(self.0.path()).args(arguments).stdin(Stdio::null());
        command
    }

    /// Runs the command to its end.
    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }
}

/// Names of all files in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// What the command says.
pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What the command prints.
pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Asserts the exit code.
pub fn assert_code(output: &Output, code: i32) {
    assert_eq!(output.status.code(), Some(code), "{}{}", stdout(output), stderr(output));
}

/// Asserts that all went well.
pub fn assert_good(output: &Output) {
    assert_code(output, 0);
}

/// Bad input: exit code 2, an `error:` line, everything in `said`, no panic, no result.
pub fn assert_refused(output: &Output, said: &[&str]) {
    assert_code(output, 2);
    let text = stderr(output);
    assert!(text.starts_with("error: ") && !text.contains("panicked"), "{text}");
    assert!(output.stdout.is_empty(), "{}", stdout(output));
    for part in said {
        assert!(text.contains(part), "{text}\nlacks {part:?}");
    }
}
