//! `warpfront trace`.

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

use clap::ValueEnum;
use csv::{ByteRecord, ReaderBuilder, Trim};
use glam::DVec3;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::args::TraceArgs;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::outputs::same_file;
use super::progress::Bar;
use super::stages::flag_name;
use super::units::{decimal, plural};
use super::{Outcome, say};
use crate::film::atomic::Output;
use crate::scene::SpacetimeKind;
use crate::study::free::{self, Accuracy, Crossing, Exit, FreeRay, Input, Status};
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
/// Columns that are written.
const RESULTS: [&str; 17] = [
    "status", "x1", "y1", "z1", "dx1", "dy1", "dz1", "t", "phi", "revs", "b", "eps", "r_min", "sens",
    "drift_h", "drift_l", "steps",
];
/// Rows in memory at a time.
const CHUNK: usize = 8192;

/// Follows the rays of a table and writes how they end.
pub(super) fn run(args: &TraceArgs) -> Result<Outcome, Failure> {
    // Without a result to keep, Ctrl-C ends the process and removes the unfinished file.
    Interrupt::install();
    let accuracy = args.accuracy();
    accuracy.check().map_err(|fault| Failure::new(fault.cause).help(fault.remedy))?;
    let started = Instant::now();
    let mut table = Table::open(&args.rays, args.spacetime)?;
    let job = Job { accuracy, pool: ThreadPoolBuilder::new().num_threads(args.threads).build().ok() };
    let (tally, wrote) = match &args.output {
        Some(path) => {
            if same_file(path, &args.rays) {
                let message = format!("`{}` is the table of rays itself", path.display());
                return Err(Failure::new(message).help("name another file for the results"));
            }
            (job.write(&mut table, Output::create(path)?)?, format!("; wrote {}", path.display()))
        }
        None => match job.stream(&mut table, io::stdout().lock()) {
            Ok(tally) => (tally?, String::new()),
            // A reader that has gone away, as `head` does, is no failure.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(Outcome::Good),
            Err(error) => return Err(Failure::new(format!("cannot write to standard output: {error}"))),
        },
    };
    say(format!("{}{wrote}", tally.line(started.elapsed().as_secs_f64())));
    Ok(if args.strict && tally.lost() > 0 { Outcome::Lost } else { Outcome::Good })
}

/// How rays are followed.
struct Job {
    accuracy: Accuracy,
    /// Without one the command shares rayon's.
    pool: Option<ThreadPool>,
}

impl Job {
    /// Writes a file, whole or not at all.
    fn write(&self, table: &mut Table, output: Output) -> Result<Tally, Failure> {
        let mut tally = Ok(Tally::default());
        let committed = output.commit(|out| {
            tally = self.stream(table, out)?;
            if tally.is_err() { Err(io::ErrorKind::InvalidData.into()) } else { Ok(()) }
        });
        let tally = tally?;
        committed?;
        Ok(tally)
    }

    /// Follows all rays, a chunk at a time, and writes their ends in the order of the rays. The outer error is one of
    /// `out`, the inner one of the table.
    fn stream(&self, table: &mut Table, mut out: impl Write) -> io::Result<Result<Tally, Failure>> {
        let bar = Bar::new("bytes");
        let tally = self.chunks(table, &mut out, &bar);
        bar.finish();
        tally
    }

    fn chunks(
        &self,
        table: &mut Table,
        out: &mut impl Write,
        bar: &Bar,
    ) -> io::Result<Result<Tally, Failure>> {
        let Accuracy { stepper, tolerance, precision } = self.accuracy;
        writeln!(
            out,
            "# warpfront {} trace --spacetime {} --stepper {} --tolerance {tolerance:e} --precision {}",
            env!("CARGO_PKG_VERSION"),
            flag_name(table.columns.spacetime),
            flag_name(stepper),
            flag_name(precision),
        )?;
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(table.columns.names())?;
        let mut tally = Tally::default();
        loop {
            let rows = match table.chunk() {
                Ok(rows) if rows.is_empty() => break,
                Ok(rows) => rows,
                Err(failure) => return Ok(Err(failure)),
            };
            let columns = &table.columns;
            let end = |row| columns.follow(row, &self.accuracy).map(|exit| (exit.status, results(&exit)));
            let follow = || rows.par_iter().map(end).collect();
            let ends: Vec<Result<_, Failure>> = match &self.pool {
                Some(pool) => pool.install(follow),
                None => follow(),
            };
            for (row, end) in rows.iter().zip(ends) {
                let (status, results) = match end {
                    Ok(end) => end,
                    Err(failure) => return Ok(Err(failure)),
                };
                columns.inputs(row).try_for_each(|cell| writer.write_field(cell))?;
                writer.write_record(results)?;
                tally.count(status);
            }
            bar.update(Progress { done: table.reader.position().byte(), total: table.size });
        }
        writer.flush()?;
        Ok(Ok(tally))
    }
}

/// The table of rays, being read.
struct Table {
    reader: csv::Reader<File>,
    /// Bytes.
    size: u64,
    columns: Columns,
}

impl Table {
    fn open(path: &Path, spacetime: Spacetime) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let unreadable = |error: io::Error| {
            Failure::new(format!("cannot read `{name}`: {error}")).help("name a CSV file with a ray per row")
        };
        let file = File::open(path).map_err(unreadable)?;
        let size = file.metadata().map_err(unreadable)?.len();
        let mut reader = ReaderBuilder::new().comment(Some(b'#')).trim(Trim::All).from_reader(file);
        let header = reader.byte_headers().map_err(|error| explain(&name, &error))?.clone();
        Ok(Self { columns: Columns::find(&name, spacetime, &header)?, reader, size })
    }

    /// The next rows; none at the end.
    fn chunk(&mut self) -> Result<Vec<ByteRecord>, Failure> {
        let rows = self.reader.byte_records().take(CHUNK);
        rows.map(|row| row.map_err(|error| explain(&self.columns.table, &error))).collect()
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

/// Which columns of a table are read, and where they are.
struct Columns {
    /// The table's name.
    table: String,
    spacetime: Spacetime,
    /// Those that are copied: labels, then numbers.
    all: Vec<(&'static str, usize)>,
    /// How many are labels.
    labels: usize,
}

impl Columns {
    fn find(table: &str, spacetime: Spacetime, header: &ByteRecord) -> Result<Self, Failure> {
        let numbers = || spacetime.parameters().iter().chain(&RAY).copied();
        let place = |name: &'static str| {
            let mut places = header.iter().enumerate().filter(|(_, found)| *found == name.as_bytes());
            let first = places.next().map(|(place, _)| (name, place));
            match places.next() {
                Some(_) => Err(Failure::new(format!("`{table}` has two columns `{name}`"))
                    .help("give every column a name of its own")),
                None => Ok(first),
            }
        };
        let mut all = Vec::new();
        for label in LABELS {
            all.extend(place(label)?);
        }
        let labels = all.len();
        for name in numbers() {
            all.push(place(name)?.ok_or_else(|| {
                let needed: Vec<&str> = numbers().collect();
                Failure::new(format!("`{table}` has no column `{name}`"))
                    .help(format!("name the columns in the first line: {}", needed.join(",")))
            })?);
        }
        Ok(Self { table: table.to_owned(), spacetime, all, labels })
    }

    /// Names of the columns that are written.
    fn names(&self) -> impl Iterator<Item = &'static str> {
        self.all.iter().map(|(name, _)| *name).chain(RESULTS)
    }

    /// The cells that are copied.
    fn inputs<'a>(&self, row: &'a ByteRecord) -> impl Iterator<Item = &'a [u8]> {
        self.all.iter().map(|&(_, place)| row.get(place).unwrap_or_default())
    }

    /// Follows the ray of a row.
    fn follow(&self, row: &ByteRecord, accuracy: &Accuracy) -> Result<Exit, Failure> {
        let place = |column: &str, cause: &str| {
            let line = row.position().map_or(0, csv::Position::line);
            Failure::new(format!("`{}`, line {line}, {column}: {cause}", self.table))
        };
        let mut numbers = Vec::with_capacity(self.all.len());
        for ((name, _), cell) in self.all.iter().zip(self.inputs(row)).skip(self.labels) {
            let text = String::from_utf8_lossy(cell);
            let number = text.parse().ok().filter(|number: &f64| number.is_finite());
            numbers.push(number.ok_or_else(|| {
                let cause = if text.is_empty() {
                    "no number".to_owned()
                } else {
                    format!("`{text}` is not a number")
                };
                place(&format!("column `{name}`"), &cause).help("give a finite number, such as 0.5 or 1e-3")
            })?);
        }
        let (parameters, ray) = numbers.split_at(self.spacetime.parameters().len());
        let ray = FreeRay {
            start: DVec3::from_slice(&ray[0..3]),
            direction: DVec3::from_slice(&ray[3..6]),
            r_out: ray[6],
        };
        free::trace(self.spacetime.of(parameters), &ray, accuracy).map_err(|fault| {
            let column = match fault.input {
                Input::SchwarzschildRadius => "column `rs`",
                Input::Start => "columns `x0`, `y0`, `z0`",
                Input::Direction => "columns `dx0`, `dy0`, `dz0`",
                Input::Sphere => "column `r_out`",
                Input::Stepper => "--stepper",
            };
            place(column, &fault.cause).help(fault.remedy)
        })
    }
}

/// The cells of [`RESULTS`]; numbers read back exactly.
fn results(exit: &Exit) -> [String; RESULTS.len()] {
    let cell = |number: Option<f64>| number.map_or_else(String::new, |number| format!("{number:?}"));
    let crossing = exit.crossing.as_ref();
    let at = |value: fn(&Crossing) -> f64| cell(crossing.map(value));
    [
        exit.status.name().to_owned(),
        at(|c| c.position.x),
        at(|c| c.position.y),
        at(|c| c.position.z),
        at(|c| c.direction.x),
        at(|c| c.direction.y),
        at(|c| c.direction.z),
        at(|c| c.time),
        at(|c| c.swept),
        at(|c| c.swept / TAU),
        cell(Some(exit.b)),
        cell(exit.eps),
        cell(exit.r_min),
        at(|c| c.sens),
        at(|c| c.drift_h),
        cell(crossing.and_then(|c| c.drift_l)),
        exit.steps.to_string(),
    ]
}

/// How many rays ended how.
#[derive(Default)]
struct Tally([usize; Status::ALL.len()]);

impl Tally {
    fn count(&mut self, status: Status) {
        self.0[status as usize] += 1;
    }

    fn of(&self, wanted: impl Fn(Status) -> bool) -> usize {
        Status::ALL.iter().zip(&self.0).filter(|(status, _)| wanted(**status)).map(|(_, count)| count).sum()
    }

    fn lost(&self) -> usize {
        self.of(Status::is_lost)
    }

    /// Counts and speed, on one line.
    fn line(&self, seconds: f64) -> String {
        let rays = self.of(|_| true);
        let found = Status::ALL.iter().zip(&self.0).filter(|(_, count)| **count > 0);
        let counts: Vec<String> = found.map(|(status, count)| format!("{count} {}", status.name())).collect();
        let counts = if counts.is_empty() { String::new() } else { format!(": {}", counts.join(", ")) };
        let rate = decimal(rays as f64 / seconds.max(1e-6));
        format!("{}{counts}; {seconds:.2} s, {rate} rays/s", plural(rays, "ray", "rays"))
    }
}
