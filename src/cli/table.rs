//! Tables of numbers: a CSV file with a line of column names and `#` comments, read as it is needed.

use std::fs::File;
use std::io;
use std::path::Path;

use csv::{ByteRecord, ReaderBuilder, Trim};

use super::failure::Failure;
use super::units::plural;
use crate::asset::Files;
use crate::study::input_error::{Input, InputError};
use crate::trace::Progress;

/// Rows in memory at a time.
const CHUNK: usize = 8192;

/// A table, being read.
pub(super) struct InputTable {
    reader: csv::Reader<File>,
    /// Bytes.
    size: u64,
    pub(super) header: TableHeader,
    /// Rows of the chunk in memory, kept for the next.
    rows: Vec<ByteRecord>,
}

impl InputTable {
    /// Opens a table that has a `what` per row, as a remedy calls it.
    pub(super) fn open(path: &Path, what: &'static str) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let unreadable = |error: io::Error| unreadable(&name, what, &error);
        let file = Files::default().open(path).map_err(unreadable)?;
        let size = file.metadata().map_err(unreadable)?.len();
        let mut reader = ReaderBuilder::new().comment(Some(b'#')).trim(Trim::Headers).from_reader(file);
        let names = reader.byte_headers().map_err(|error| explain(&name, what, &error))?.clone();
        Ok(Self { reader, size, header: TableHeader { table: name, what, names }, rows: Vec::new() })
    }

    /// The next rows; none at the end.
    pub(super) fn chunk(&mut self) -> Result<&[ByteRecord], Failure> {
        let TableHeader { table, what, .. } = &self.header;
        self.rows.resize_with(CHUNK, ByteRecord::new);
        let mut count = 0;
        for row in &mut self.rows {
            if !self.reader.read_byte_record(row).map_err(|error| explain(table, what, &error))? {
                break;
            }
            count += 1;
        }
        Ok(&self.rows[..count])
    }

    /// Bytes read.
    pub(super) fn progress(&self) -> Progress {
        Progress { done: self.reader.position().byte(), total: self.size }
    }
}

fn unreadable(table: &str, what: &str, error: &dyn std::error::Error) -> Failure {
    Failure::new(format!("cannot read `{table}`: {error}"))
        .help(format!("name a CSV file with a {what} per row"))
}

/// Failure of reading on in a table.
fn explain(table: &str, what: &str, error: &csv::Error) -> Failure {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            let cells = plural(*len as usize, "cell", "cells");
            Failure::new(format!("`{table}`, line {line}: {cells}, but there are {expected_len} columns"))
                .help("give every row as many cells as there are column names; cells may be empty")
        }
        _ => unreadable(table, what, error),
    }
}

/// The line of a row.
pub(super) fn line(row: &ByteRecord) -> u64 {
    row.position().map_or(0, csv::Position::line)
}

/// The cell of a row at `place`, without the blanks around it; empty without the cell.
pub(super) fn cell(row: &ByteRecord, place: usize) -> &[u8] {
    row.get(place).unwrap_or_default().trim_ascii()
}

/// The name of a table and those of its columns.
#[derive(Clone)]
pub(super) struct TableHeader {
    table: String,
    /// Name of what a row holds.
    what: &'static str,
    names: ByteRecord,
}

impl TableHeader {
    /// Index of the column `name`, if there is one.
    pub(super) fn place(&self, name: &str) -> Result<Option<usize>, Failure> {
        let mut places = self.names.iter().enumerate().filter(|(_, found)| *found == name.as_bytes());
        let first = places.next().map(|(place, _)| place);
        match places.next() {
            Some(_) => Err(Failure::new(format!("`{}` has two columns `{name}`", self.table))
                .help("give every column a name of its own")),
            None => Ok(first),
        }
    }

    /// Names and indices of the `needed` columns.
    pub(super) fn all(&self, needed: &[&'static str]) -> Result<Vec<(&'static str, usize)>, Failure> {
        let place = |&name: &&'static str| {
            let place = self.place(name)?.ok_or_else(|| {
                Failure::new(format!("`{}` has no column `{name}`", self.table))
                    .help(format!("name the columns in the first line: {}", needed.join(",")))
            })?;
            Ok((name, place))
        };
        needed.iter().map(place).collect()
    }

    /// Indices of the columns of all `names`; none if not one of them is there.
    ///
    /// Some without the others are refused.
    pub(super) fn places<const N: usize>(&self, names: [&str; N]) -> Result<Option<[usize; N]>, Failure> {
        let mut places = [0; N];
        let (mut there, mut missing) = (None, None);
        for (place, name) in places.iter_mut().zip(names) {
            match self.place(name)? {
                Some(found) => (*place, there) = (found, Some(name)),
                None => missing = Some(name),
            }
        }
        match (there, missing) {
            (Some(there), Some(missing)) => Err(Failure::new(format!(
                "`{}` has a column `{there}` but no column `{missing}`",
                self.table
            ))
            .help(format!("give all of {}, or none of them", names.join(",")))),
            (there, _) => Ok(there.map(|_| places)),
        }
    }

    /// The number in the column `name` at `place`.
    pub(super) fn number(&self, row: &ByteRecord, name: &str, place: usize) -> Result<f64, Failure> {
        let bytes = cell(row, place);
        let number = std::str::from_utf8(bytes).ok().and_then(|text| text.parse().ok());
        number.filter(|number: &f64| number.is_finite()).ok_or_else(|| {
            let text = String::from_utf8_lossy(bytes);
            let cause =
                if text.is_empty() { "no number".to_owned() } else { format!("`{text}` is not a number") };
            self.at(line(row), &format!("column `{name}`"), &cause)
                .help("give a finite number, such as 0.5 or 1e-3")
        })
    }

    /// The number in the column `name` at `place`; `None` in an empty cell and without the column.
    pub(super) fn maybe(
        &self,
        row: &ByteRecord,
        name: &str,
        place: Option<usize>,
    ) -> Result<Option<f64>, Failure> {
        let filled = place.filter(|&place| !cell(row, place).is_empty());
        filled.map(|place| self.number(row, name, place)).transpose()
    }

    /// Failure of a line whose ray cannot be followed, or whose points cannot be joined.
    pub(super) fn refuse(&self, line: u64, error: &InputError) -> Failure {
        let place = match error.input {
            Input::Parameter(column) => &format!("column `{column}`"),
            Input::Columns(columns) => &named(columns),
            Input::Spacetime => "--spacetime",
            Input::Stepper => "--stepper",
            Input::Precision => "--precision",
            Input::Both => "columns `x0` to `y2`",
        };
        self.at(line, place, &error.cause).help(&error.remedy)
    }

    /// Failure in a line.
    pub(super) fn at(&self, line: u64, place: &str, cause: &str) -> Failure {
        Failure::new(format!("`{}`, line {line}, {place}: {cause}", self.table))
    }
}

/// Names of columns, in words.
fn named(columns: &[&str]) -> String {
    let names: Vec<String> = columns.iter().map(|name| format!("`{name}`")).collect();
    format!("{} {}", if names.len() == 1 { "column" } else { "columns" }, names.join(", "))
}
