//! A table in, a table out: rows are read a chunk at a time, worked on by all threads and answered in their order.

use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

use csv::ByteRecord;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::completion::Completion;
use super::csv_text::CsvText;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::outputs::same_file;
use super::progress::{Meter, Show};
use super::say::say;
use super::table::{InputTable, TableHeader};
use crate::film::atomic::Output;

/// Rows that a thread takes at once.
const GRAIN: usize = 64;

/// Work of a command on the rows of a table.
pub(super) trait RowWise: Sync {
    /// Task read from a row.
    type Task: Sync;
    /// Counts of answers.
    type Counts: Default + Send;

    /// Settings, which follow the program's name in the comment above the results.
    fn settings(&self) -> String;

    /// Columns that are written.
    fn names(&self) -> Vec<&'static str>;

    /// Reads a row; none if there is nothing to be done about it.
    fn read(&mut self, row: &ByteRecord) -> Result<Option<Self::Task>, Failure>;

    /// Works on a row, on any thread, and adds the rows that answer it.
    fn answer(
        &self,
        row: &ByteRecord,
        task: &Self::Task,
        out: &mut CsvText,
        counts: &mut Self::Counts,
    ) -> Result<(), Failure>;

    /// Adds counts to those so far.
    fn count(&mut self, counts: Self::Counts);

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
    let mut names = CsvText::default();
    job.names().iter().for_each(|name| names.text(name.as_bytes()));
    names.end_row();
    out.write_all(names.bytes())?;
    loop {
        let rows = match table.chunk() {
            Ok([]) => break,
            Ok(rows) => rows,
            Err(failure) => return Ok(Err(failure)),
        };
        let tasks: Result<Vec<_>, Failure> =
            rows.iter().filter_map(|row| Some(job.read(row).transpose()?.map(|task| (row, task)))).collect();
        let tasks = match tasks {
            Ok(tasks) => tasks,
            Err(failure) => return Ok(Err(failure)),
        };
        let all = || tasks.par_chunks(GRAIN).map(|tasks| answers(job, tasks)).collect();
        let answers: Vec<_> = match pool {
            Some(pool) => pool.install(all),
            None => all(),
        };
        for (text, counts, done) in answers {
            out.write_all(text.bytes())?;
            job.count(counts);
            if let Err(failure) = done {
                return Ok(Err(failure));
            }
        }
        meter.update(table.progress());
    }
    out.flush()?;
    Ok(Ok(()))
}

/// The rows that answer some tasks and their counts, up to the first that fails.
fn answers<J: RowWise>(
    job: &J,
    tasks: &[(&ByteRecord, J::Task)],
) -> (CsvText, J::Counts, Result<(), Failure>) {
    let (mut text, mut counts) = (CsvText::default(), J::Counts::default());
    let done = tasks.iter().try_for_each(|(row, task)| job.answer(row, task, &mut text, &mut counts));
    (text, counts, done)
}
