//! `warpfront trace`.

use csv::ByteRecord;

use super::args::TraceArgs;
use super::completion::Completion;
use super::csv_text::CsvText;
use super::failure::Failure;
use super::rays_table::RayColumns;
use super::rowwise::{RowWise, Setup};
use super::table::line;
use super::units::{decimal, plural};
use crate::scene::flag_name;
use crate::study::free::{Accuracy, FreeRayEnd, TableForm, Traced};
use crate::study::table::Cell;

/// Follows the rays of a table and writes how they end.
pub(super) fn run(args: &TraceArgs) -> Result<Completion, Failure> {
    let form = TableForm::of(args.spacetime);
    let accuracy = args.accuracy(form.stepper);
    form.check(accuracy.stepper).map_err(|error| Failure::new(error.cause).help(error.remedy))?;
    let setup = Setup {
        input: &args.rays,
        what: ["ray", "rays"],
        output: args.output.as_deref(),
        threads: args.threads,
        progress: args.meter.progress,
        strict: args.strict,
    };
    setup.run(|header| {
        Ok(TraceJob { columns: RayColumns::find(header, args.spacetime)?, accuracy, tally: Tally::default() })
    })
}

/// Columns and accuracy of the rays, and a tally of their ends so far.
struct TraceJob {
    columns: RayColumns,
    accuracy: Accuracy,
    tally: Tally,
}

impl RowWise for TraceJob {
    type Task = ();
    type Counts = Tally;

    fn settings(&self) -> String {
        let Accuracy { stepper, tolerance, precision } = self.accuracy;
        format!(
            "trace --spacetime {} --stepper {} --tolerance {tolerance:e} --precision {}",
            self.columns.spacetime.name(),
            flag_name(stepper),
            flag_name(precision),
        )
    }

    fn names(&self) -> Vec<&'static str> {
        self.columns
            .names()
            .chain(["status"])
            .chain(self.columns.form.results.iter().copied())
            .chain(["steps"])
            .collect()
    }

    fn read(&mut self, _: &ByteRecord) -> Result<Option<()>, Failure> {
        Ok(Some(()))
    }

    fn answer(&self, row: &ByteRecord, _: &(), out: &mut CsvText, tally: &mut Tally) -> Result<(), Failure> {
        let RayColumns { header, form, .. } = &self.columns;
        let (spacetime, ray) = self.columns.ray(row)?;
        let Traced { status, cells, steps, .. } = (form.trace)(&spacetime, &ray, &self.accuracy)
            .map_err(|error| header.refuse(line(row), &error))?;
        self.columns.inputs(row).for_each(|cell| out.text(cell));
        out.text(status.name().as_bytes());
        cells.into_iter().for_each(|cell| out.cell(cell));
        out.cell(Cell::Integer(steps.into()));
        out.end_row();
        tally.count(status);
        Ok(())
    }

    fn count(&mut self, Tally(counts): Tally) {
        for (sum, count) in self.tally.0.iter_mut().zip(counts) {
            *sum += count;
        }
    }

    fn summary(&self, seconds: f64) -> String {
        self.tally.line(seconds)
    }

    fn lost(&self) -> usize {
        self.tally.of(FreeRayEnd::is_lost)
    }
}

/// Number of rays by status.
#[derive(Default)]
struct Tally([usize; FreeRayEnd::ALL.len()]);

impl Tally {
    fn count(&mut self, status: FreeRayEnd) {
        self.0[status as usize] += 1;
    }

    fn of(&self, wanted: impl Fn(FreeRayEnd) -> bool) -> usize {
        FreeRayEnd::ALL
            .iter()
            .zip(&self.0)
            .filter(|(status, _)| wanted(**status))
            .map(|(_, count)| count)
            .sum()
    }

    /// Counts and speed, on one line.
    fn line(&self, seconds: f64) -> String {
        let rays = self.of(|_| true);
        let found = FreeRayEnd::ALL.iter().zip(&self.0).filter(|(_, count)| **count > 0);
        let counts: Vec<String> = found.map(|(status, count)| format!("{count} {}", status.name())).collect();
        let counts = if counts.is_empty() { String::new() } else { format!(": {}", counts.join(", ")) };
        let rate = decimal(rays as f64 / seconds.max(1e-6));
        format!("{}{counts}; {seconds:.2} s, {rate} rays/s", plural(rays, "ray", "rays"))
    }
}
