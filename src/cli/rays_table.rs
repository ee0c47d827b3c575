//! Tables of rays: a CSV file with a ray per row.

use std::fs::File;
use std::io;
use std::path::Path;

use clap::ValueEnum;
use csv::{ByteRecord, ReaderBuilder, Trim};
use glam::DVec3;

use super::failure::Failure;
use super::units::plural;
use crate::scene::SpacetimeKind;
use crate::study::free::{Fault, FreeRay, Input};
use crate::trace::Progress;

/// A spacetime by its name; what describes it is in the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Spacetime {
    /// A hole of Schwarzschild radius `rs` at the origin; isotropic coordinates
    Schwarzschild,
    /// No hole: straight rays
    Flat,
}

impl Spacetime {
    /// Columns that describe it.
    fn parameters(self) -> &'static [&'static str] {
        match self {
            Spacetime::Schwarzschild => &["rs"],
            Spacetime::Flat => &[],
        }
    }

    /// The spacetime of a row, given the numbers in these columns.
    fn of(self, parameters: &[f64]) -> SpacetimeKind {
        match (self, parameters) {
            (Spacetime::Schwarzschild, &[schwarzschild_radius, ..]) => {
                SpacetimeKind::Schwarzschild { center: DVec3::ZERO, schwarzschild_radius }
            }
            _ => SpacetimeKind::Flat,
        }
    }
}

/// Columns that are copied where there are any.
const LABELS: [&str; 2] = ["id", "kind"];
/// Columns that describe a ray.
const RAY: [&str; 7] = ["x0", "y0", "z0", "dx0", "dy0", "dz0", "r_out"];
/// Rows in memory at a time.
const CHUNK: usize = 8192;

/// A table, being read.
pub(super) struct Table {
    reader: csv::Reader<File>,
    /// Bytes.
    size: u64,
    pub(super) columns: Columns,
}

impl Table {
    pub(super) fn open(path: &Path, spacetime: Spacetime) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let unreadable = |error: io::Error| {
            Failure::new(format!("cannot read `{name}`: {error}")).help("name a CSV file with a ray per row")
        };
        let file = File::open(path).map_err(unreadable)?;
        let size = file.metadata().map_err(unreadable)?.len();
        let mut reader = ReaderBuilder::new().comment(Some(b'#')).trim(Trim::All).from_reader(file);
        let header = reader.byte_headers().map_err(|error| explain(&name, &error))?.clone();
        Ok(Self { columns: Columns::find(&name, spacetime, header)?, reader, size })
    }

    /// The next rows; none at the end.
    pub(super) fn chunk(&mut self) -> Result<Vec<ByteRecord>, Failure> {
        let rows = self.reader.byte_records().take(CHUNK);
        rows.map(|row| row.map_err(|error| explain(&self.columns.table, &error))).collect()
    }

    /// Bytes read.
    pub(super) fn progress(&self) -> Progress {
        Progress { done: self.reader.position().byte(), total: self.size }
    }
}

/// Why a table cannot be read on.
fn explain(table: &str, error: &csv::Error) -> Failure {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            let cells = plural(*len as usize, "cell", "cells");
            Failure::new(format!("`{table}`, line {line}: {cells}, but there are {expected_len} columns"))
                .help("give every row as many cells as there are column names; cells may be empty")
        }
        _ => {
            Failure::new(format!("cannot read `{table}`: {error}")).help("name a CSV file with a ray per row")
        }
    }
}

/// The line of a row.
pub(super) fn line(row: &ByteRecord) -> u64 {
    row.position().map_or(0, csv::Position::line)
}

/// Which columns of a table are read, and where they are.
pub(super) struct Columns {
    /// The table's name.
    table: String,
    pub(super) spacetime: Spacetime,
    header: ByteRecord,
    /// Those that are copied: labels, then numbers.
    all: Vec<(&'static str, usize)>,
    /// How many are labels.
    labels: usize,
}

impl Columns {
    fn find(table: &str, spacetime: Spacetime, header: ByteRecord) -> Result<Self, Failure> {
        let mut columns = Self { table: table.to_owned(), spacetime, header, all: Vec::new(), labels: 0 };
        for label in LABELS {
            let place = columns.place(label)?;
            columns.all.extend(place.map(|place| (label, place)));
        }
        columns.labels = columns.all.len();
        let needed: Vec<&str> = spacetime.parameters().iter().chain(&RAY).copied().collect();
        for &name in &needed {
            let place = columns.place(name)?.ok_or_else(|| {
                Failure::new(format!("`{table}` has no column `{name}`"))
                    .help(format!("name the columns in the first line: {}", needed.join(",")))
            })?;
            columns.all.push((name, place));
        }
        Ok(columns)
    }

    /// Where the column `name` is, if there is one.
    pub(super) fn place(&self, name: &str) -> Result<Option<usize>, Failure> {
        let mut places = self.header.iter().enumerate().filter(|(_, found)| *found == name.as_bytes());
        let first = places.next().map(|(place, _)| place);
        match places.next() {
            Some(_) => Err(Failure::new(format!("`{}` has two columns `{name}`", self.table))
                .help("give every column a name of its own")),
            None => Ok(first),
        }
    }

    /// Where all of `names` are; none if not one of them is there.
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

    /// Names of the columns that are copied.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.all.iter().map(|(name, _)| *name)
    }

    /// The cells that are copied.
    pub(super) fn inputs<'a>(&self, row: &'a ByteRecord) -> impl Iterator<Item = &'a [u8]> {
        self.all.iter().map(|&(_, place)| row.get(place).unwrap_or_default())
    }

    /// The number in the column `name` at `place`.
    pub(super) fn number(&self, row: &ByteRecord, name: &str, place: usize) -> Result<f64, Failure> {
        let text = String::from_utf8_lossy(row.get(place).unwrap_or_default());
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| {
            let cause =
                if text.is_empty() { "no number".to_owned() } else { format!("`{text}` is not a number") };
            self.at(line(row), &format!("column `{name}`"), &cause)
                .help("give a finite number, such as 0.5 or 1e-3")
        })
    }

    /// What is wrong in a line.
    pub(super) fn at(&self, line: u64, place: &str, cause: &str) -> Failure {
        Failure::new(format!("`{}`, line {line}, {place}: {cause}", self.table))
    }

    /// The ray of a row.
    pub(super) fn ray(&self, row: &ByteRecord) -> Result<(SpacetimeKind, FreeRay), Failure> {
        let mut numbers = Vec::with_capacity(self.all.len());
        for &(name, place) in &self.all[self.labels..] {
            numbers.push(self.number(row, name, place)?);
        }
        let (parameters, ray) = numbers.split_at(self.spacetime.parameters().len());
        let ray = FreeRay {
            start: DVec3::from_slice(&ray[0..3]),
            direction: DVec3::from_slice(&ray[3..6]),
            r_out: ray[6],
        };
        Ok((self.spacetime.of(parameters), ray))
    }

    /// Why the ray in a line cannot be followed.
    pub(super) fn refuse(&self, line: u64, fault: &Fault) -> Failure {
        let column = match fault.input {
            Input::SchwarzschildRadius => "column `rs`",
            Input::Start => "columns `x0`, `y0`, `z0`",
            Input::Direction => "columns `dx0`, `dy0`, `dz0`",
            Input::Sphere => "column `r_out`",
            Input::Stepper => "--stepper",
        };
        self.at(line, column, &fault.cause).help(&fault.remedy)
    }
}
