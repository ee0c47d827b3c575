//! `warpfront trace`.

use std::f64::consts::TAU;
use std::io::Write;

use csv::ByteRecord;

use super::args::TraceArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::rays_table::RayColumns;
use super::rowwise::{self, RowWise, Setup};
use super::table::line;
use super::units::{decimal, plural};
use crate::scene::flag_name;
use crate::study::free::{self, Accuracy, Crossing, Exit, FreeRayEnd};

/// Columns that are written.
const RESULTS: [&str; 17] = [
    "status", "x1", "y1", "z1", "dx1", "dy1", "dz1", "t", "phi", "revs", "b", "eps", "r_min", "sens",
    "drift_h", "drift_l", "steps",
];

/// Follows the rays of a table and writes how they end.
pub(super) fn run(args: &TraceArgs) -> Result<Completion, Failure> {
    let accuracy = args.accuracy();
    accuracy.check().map_err(|fault| Failure::new(fault.cause).help(fault.remedy))?;
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
    type Answer = Exit;

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
        self.columns.names().chain(RESULTS).collect()
    }

    fn read(&mut self, row: ByteRecord) -> Result<Option<ByteRecord>, Failure> {
        Ok(Some(row))
    }

    fn answer(&self, row: &ByteRecord) -> Result<Exit, Failure> {
        let (spacetime, ray) = self.columns.ray(row)?;
        free::trace(&spacetime, &ray, &self.accuracy)
            .map_err(|fault| self.columns.header.refuse(line(row), &fault))
    }

    fn write(&mut self, row: &ByteRecord, exit: &Exit, out: &mut csv::Writer<impl Write>) -> csv::Result<()> {
        self.columns.inputs(row).try_for_each(|cell| out.write_field(cell))?;
        out.write_record(results(exit))?;
        self.tally.count(exit.status);
        Ok(())
    }

    fn summary(&self, seconds: f64) -> String {
        self.tally.line(seconds)
    }

    fn lost(&self) -> usize {
        self.tally.of(FreeRayEnd::is_lost)
    }
}

/// The cells of [`RESULTS`]; numbers read back exactly.
fn results(exit: &Exit) -> [String; RESULTS.len()] {
    let cell = |number: Option<f64>| number.map_or_else(String::new, rowwise::cell);
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
