//! `warpfront trace`.

use std::io::Write;

use csv::ByteRecord;

use super::args::TraceArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::rays_table::RayColumns;
use super::rowwise::{RowWise, Setup};
use super::table::line;
use super::units::{decimal, plural};
use crate::scene::flag_name;
use crate::study::free::{Accuracy, FreeRayEnd, TableForm, Traced};

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
    type Task = ByteRecord;
    type Answer = Traced;

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

    fn read(&mut self, row: ByteRecord) -> Result<Option<ByteRecord>, Failure> {
        Ok(Some(row))
    }

    fn answer(&self, row: &ByteRecord) -> Result<Traced, Failure> {
        let RayColumns { header, form, .. } = &self.columns;
        let (spacetime, ray) = self.columns.ray(row)?;
        (form.trace)(&spacetime, &ray, &self.accuracy).map_err(|error| header.refuse(line(row), &error))
    }

    fn write(
        &mut self,
        row: &ByteRecord,
        ray: &Traced,
        out: &mut csv::Writer<impl Write>,
    ) -> csv::Result<()> {
        self.columns.inputs(row).try_for_each(|cell| out.write_field(cell))?;
        out.write_field(ray.status.name())?;
        ray.cells.iter().try_for_each(|cell| out.write_field(cell))?;
        out.write_record([ray.steps.to_string()])?;
        self.tally.count(ray.status);
        Ok(())
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
