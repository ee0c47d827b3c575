//! Studies as commands: measured in rounds beside a meter, then printed and written.

use super::completion::Completion;
use super::failure::Failure;
use super::prefixed::StudyFiles;
use super::progress::Meter;
use super::say::{print, say};
use super::shared_args::distinct;
use super::units::plural;
use crate::study::report::Report;
use crate::study::rounds::{self, Study};

/// Values that were given, without repetitions, or else the `usual` ones.
pub(super) fn distinct_or<T: Copy + PartialEq>(given: &[T], usual: &[T]) -> Vec<T> {
    distinct(if given.is_empty() { usual } else { given })
}

/// Refuses to measure nothing.
pub(super) fn check_some<T>(settings: &[T]) -> Result<(), Failure> {
    if settings.is_empty() {
        return Err(Failure::new(
            "there is nothing to measure: all --tolerances are finer than the --precisions",
        )
        .help("give tolerances from 1.2e-5 up for f32, from 2.3e-14 up for f64"));
    }
    Ok(())
}

/// Measures all settings of `study` in all rounds.
pub(super) fn run<S: Study>(study: S, rounds: u32, meter: Meter) -> Result<S::Findings, S::Error> {
    let findings = rounds::run(study, rounds, &|progress| meter.update(progress));
    meter.finish();
    findings
}

/// Writes and prints a report, and says on what it is.
pub(super) fn publish(report: &Report, files: StudyFiles, on: &str) -> Result<Completion, Failure> {
    let names = files.names();
    files.write(report)?;
    print(&report.text)?;
    say(format!("{}{on}; wrote {names}", plural(report.table.rows(), "setting", "settings")));
    Ok(Completion::Good)
}
