//! `warpfront study`.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::args::StudyArgs;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::progress::Bar;
use super::units::plural;
use super::{Outcome, print, say};
use crate::film::atomic::Output;
use crate::plot::Format;
use crate::scene::{self, StepperKind};
use crate::study::report;
use crate::study::sweep::{Plan, Setting, sweep};
use crate::trace::Progress;

/// Measures ways to integrate rays and writes what was found.
pub(super) fn run(args: &StudyArgs) -> Result<Outcome, Failure> {
    let _ends_the_process = Interrupt::install();
    let open = |extension| Output::create(&with_suffix(&args.output, extension)).map_err(Failure::from);
    let (csv, svg, png) = (open("csv")?, open("svg")?, open("png")?);
    let mut scene = scene::load_with_hole(&args.scene.path, &args.scene.overrides, args.scene.black_hole)?;
    for warning in &scene.warnings {
        say(format!("warning: {warning}"));
    }
    (scene.settings.width, scene.settings.height) = args.size;
    scene.settings.arc_tolerance = args.arc_tolerance.or(scene.settings.arc_tolerance);

    let all = StepperKind::value_variants();
    let steppers = if args.steppers.is_empty() { all } else { &args.steppers };
    let schedules =
        if args.schedules.is_empty() { vec![scene.settings.schedule] } else { args.schedules.clone() };
    let settings = Setting::grid(&distinct(steppers), &distinct(&args.tolerances), &distinct(&schedules));
    let plan = Plan { settings, rounds: args.rounds, spp: args.spp, threads: args.threads };

    let bar = Bar::new("runs");
    let progress = |done, total| bar.update(Progress { done: done as u64, total: total as u64 });
    let measurements = sweep(scene, &plan, &progress);
    bar.finish();

    let figure = report::figure(&measurements);
    csv.commit(|out| report::write_csv(&measurements, out))?;
    svg.commit(|out| figure.write(Format::Svg, out))?;
    png.commit(|out| figure.write(Format::Png, out))?;
    print(&report::table(&measurements))?;
    let names =
        ["csv", "svg", "png"].map(|extension| with_suffix(&args.output, extension).display().to_string());
    let settings = plural(measurements.len(), "setting", "settings");
    say(format!("{settings}; wrote {}", names.join(", ")));
    Ok(Outcome::Good)
}

/// `prefix.extension`, whatever dots the prefix has.
fn with_suffix(prefix: &Path, extension: &str) -> PathBuf {
    let mut name = prefix.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}

/// The values without repetitions, in order.
fn distinct<T: Copy + PartialEq>(values: &[T]) -> Vec<T> {
    let mut distinct = Vec::new();
    for &value in values {
        if !distinct.contains(&value) {
            distinct.push(value);
        }
    }
    distinct
}
