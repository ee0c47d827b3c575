//! A table in, a table out: rows are read a chunk at a time, worked on by all threads and answered in their order.

use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

use csv::ByteRecord;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::completion::Completion;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::outputs::same_file;
use super::progress::{Meter, Show};
use super::say::say;
use super::table::{InputTable, TableHeader};
use crate::film::atomic::Output;
use crate::study::table::io_error;

/// Work of a command on the rows of a table.
pub(super) trait RowWise: Sync {
    /// Task read from a row.
    type Task: Sync;
    /// Answer to a task.
    type Answer: Send;

    /// Settings, which follow the program's name in the comment above the results.
    fn settings(&self) -> String;

    /// Columns that are written.
    fn names(&self) -> Vec<&'static str>;

    /// Reads a row; none if there is nothing to be done about it.
    fn read(&mut self, row: ByteRecord) -> Result<Option<Self::Task>, Failure>;

    /// Works on a row, on any thread.
    fn answer(&self, task: &Self::Task) -> Result<Self::Answer, Failure>;

    /// Writes the rows that answer a row.
    fn write(
        &mut self,
        task: &Self::Task,
        answer: &Self::Answer,
        out: &mut csv::Writer<impl Write>,
    ) -> csv::Result<()>;

    /// Summary of what was done in so many seconds, on one line.
    fn summary(&self, seconds: f64) -> String;

    /// Number of lost answers, which `--strict` minds.
    fn lost(&self) -> usize;
}

/// Files, and how they are worked on.
pub(super) struct Setup<'a> {
    /// The table.
    pub(super) input: &'a Path,
    /// Name of what it has in a row, and of what it has in all.
    pub(super) what: [&'static str; 2],
    /// Standard output if there is none.
    pub(super) output: Option<&'a Path>,
    /// 0 means one per core.
    pub(super) threads: usize,
    /// Display of progress.
    pub(super) progress: Show,
    /// True if lost answers count.
    pub(super) strict: bool,
}

impl Setup<'_> {
    /// Does the `job` for a table with such a header, and says at the end what was done and written where; nothing if
    /// the reader of standard output has gone away, as `head` does, which is no failure.
    pub(super) fn run<J: RowWise>(
        &self,
        job: impl FnOnce(&TableHeader) -> Result<J, Failure>,
    ) -> Result<Completion, Failure> {
        // Without a result to keep, Ctrl-C ends the process and removes the unfinished file.
        Interrupt::install();
        let started = Instant::now();
        let mut table = InputTable::open(self.input, self.what[0])?;
        let mut job = job(&table.header)?;
        let Some(wrote) = self.write(&mut table, &mut job)? else { return Ok(Completion::Good) };
        say(format!("{}{wrote}", job.summary(started.elapsed().as_secs_f64())));
        Ok(if self.strict && job.lost() > 0 { Completion::Lost } else { Completion::Good })
    }

    /// Writes the answers, and tells where, in words; none if the reader of standard output has gone away.
    fn write(&self, table: &mut InputTable, job: &mut impl RowWise) -> Result<Option<String>, Failure> {
        let Some(path) = self.output else {
            return match self.stream(table, job, io::stdout().lock()) {
                Ok(done) => done.map(|()| Some(String::new())),
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(None),
                Err(error) => Err(Failure::new(format!("cannot write to standard output: {error}"))),
            };
        };
        if same_file(path, self.input) {
            let message = format!("`{}` is the table of {} itself", path.display(), self.what[1]);
            return Err(Failure::new(message).help("name another file for the results"));
        }
        let mut done = Ok(());
        let committed = Output::create(path)?.commit(|out| {
            done = self.stream(table, job, out)?;
            if done.is_err() { Err(io::ErrorKind::InvalidData.into()) } else { Ok(()) }
        });
        done?;
        committed?;
        Ok(Some(format!("; wrote {}", path.display())))
    }

    /// The outer error is one of `out`, the inner one of the table.
    fn stream(
        &self,
        table: &mut InputTable,
        job: &mut impl RowWise,
        out: impl Write,
    ) -> io::Result<Result<(), Failure>> {
        let meter = Meter::new(self.progress, "reading", "bytes");
        // Without a pool of its own the command shares rayon's.
        let pool = ThreadPoolBuilder::new().num_threads(self.threads).build().ok();
        let done = chunks(table, job, out, pool.as_ref(), &meter);
        meter.finish();
        done
    }
}

fn chunks(
    table: &mut InputTable,
    job: &mut impl RowWise,
    mut out: impl Write,
    pool: Option<&ThreadPool>,
    meter: &Meter,
) -> io::Result<Result<(), Failure>> {
    writeln!(out, "# warpfront {} {}", env!("CARGO_PKG_VERSION"), job.settings())?;
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(job.names()).map_err(io_error)?;
    loop {
        let rows = match table.chunk() {
            Ok(rows) if rows.is_empty() => break,
            Ok(rows) => rows,
            Err(failure) => return Ok(Err(failure)),
        };
        let tasks: Result<Vec<_>, Failure> =
            rows.into_iter().filter_map(|row| job.read(row).transpose()).collect();
        let tasks = match tasks {
            Ok(tasks) => tasks,
            Err(failure) => return Ok(Err(failure)),
        };
        let all = || tasks.par_iter().map(|task| job.answer(task)).collect();
        let answers: Vec<Result<_, Failure>> = match pool {
            Some(pool) => pool.install(all),
            None => all(),
        };
        for (task, answer) in tasks.iter().zip(answers) {
            match answer {
                Ok(answer) => job.write(task, &answer, &mut writer).map_err(io_error)?,
                Err(failure) => return Ok(Err(failure)),
            }
        }
        meter.update(table.progress());
    }
    writer.flush()?;
    Ok(Ok(()))
}
