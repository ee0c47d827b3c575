//! `warpfront trace`.

use std::f64::consts::TAU;
use std::io::{self, Write};
use std::time::Instant;

use csv::ByteRecord;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::args::TraceArgs;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::outputs::same_file;
use super::progress::Bar;
use super::rays_table::{Columns, Table, line};
use super::units::{decimal, plural};
use super::{Outcome, say};
use crate::film::atomic::Output;
use crate::scene::flag_name;
use crate::study::free::{self, Accuracy, Crossing, Exit, Status};

/// Columns that are written.
const RESULTS: [&str; 17] = [
    "status", "x1", "y1", "z1", "dx1", "dy1", "dz1", "t", "phi", "revs", "b", "eps", "r_min", "sens",
    "drift_h", "drift_l", "steps",
];

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
        writer.write_record(table.columns.names().chain(RESULTS)).map_err(plain)?;
        let mut tally = Tally::default();
        loop {
            let rows = match table.chunk() {
                Ok(rows) if rows.is_empty() => break,
                Ok(rows) => rows,
                Err(failure) => return Ok(Err(failure)),
            };
            let columns = &table.columns;
            let end = |row| follow(columns, row, &self.accuracy).map(|exit| (exit.status, results(&exit)));
            let all = || rows.par_iter().map(end).collect();
            let ends: Vec<Result<_, Failure>> = match &self.pool {
                Some(pool) => pool.install(all),
                None => all(),
            };
            for (row, end) in rows.iter().zip(ends) {
                let (status, results) = match end {
                    Ok(end) => end,
                    Err(failure) => return Ok(Err(failure)),
                };
                columns.inputs(row).try_for_each(|cell| writer.write_field(cell)).map_err(plain)?;
                writer.write_record(results).map_err(plain)?;
                tally.count(status);
            }
            bar.update(table.progress());
        }
        writer.flush()?;
        Ok(Ok(tally))
    }
}

/// The error of the file, of its own kind and not of "other", as which `From` would have it.
fn plain(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

/// Follows the ray of a row.
fn follow(columns: &Columns, row: &ByteRecord, accuracy: &Accuracy) -> Result<Exit, Failure> {
    let (spacetime, ray) = columns.ray(row)?;
    free::trace(spacetime, &ray, accuracy).map_err(|fault| columns.refuse(line(row), &fault))
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
