//! `warpfront study`.

use std::path::Path;

use clap::ValueEnum;
use csv::ByteRecord;
use glam::DVec3;
use rayon::prelude::*;

use super::args::StudyArgs;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::light_study;
use super::prefixed::{Files, names};
use super::progress::Meter;
use super::rays_table::Columns;
use super::shared_args::distinct;
use super::table::{Table, line};
use super::units::plural;
use super::{Outcome, memory, overwrite, print, say, say_remarks};
use crate::scene::{self, Baked, LoadOptions, StepperKind};
use crate::study::ends::{self, Case, Crossing, Exact};
use crate::study::free::Status;
use crate::study::report;
use crate::study::sweep::{Plan, Setting, sweep};
use crate::trace::Progress;

/// Tolerances on a scene.
const TOLERANCES: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
/// More of them for rays by themselves.
const FINER: [f64; 4] = [1e-9, 1e-10, 1e-11, 1e-12];
/// Columns of the table of rays that say how they end.
const ENDS: [&str; 8] = ["status", "x1", "y1", "z1", "dx1", "dy1", "dz1", "sens"];

/// Measures ways to integrate rays and writes what was found.
pub(super) fn run(args: &StudyArgs) -> Result<Outcome, Failure> {
    let _ends_the_process = Interrupt::install();
    match (&args.rays, &args.scene) {
        (Some(rays), _) => free(args, rays, Files::open(&args.output)?),
        (None, Some(path)) if !args.light_sampling.is_empty() => {
            let files = Files::open(&args.output)?;
            light_study::run(args, load(args, path, &files)?, path, files)
        }
        (None, Some(scene)) => of_scene(args, scene, Files::open(&args.output)?),
        (None, None) => Err(Failure::new("nothing to study").help("give a SCENE, or --rays RAYS.csv")),
    }
}

/// Studies the camera rays of a scene.
fn of_scene(args: &StudyArgs, path: &Path, files: Files) -> Result<Outcome, Failure> {
    let mut scene = load(args, path, &files)?;
    scene.settings.arc_tolerance = args.arc_tolerance.or(scene.settings.arc_tolerance);

    let all = StepperKind::value_variants();
    let steppers = if args.steppers.is_empty() { all } else { &args.steppers };
    let tolerances = if args.tolerances.is_empty() { &TOLERANCES[..] } else { &args.tolerances };
    let schedules =
        if args.schedules.is_empty() { vec![scene.settings.schedule] } else { args.schedules.clone() };
    let settings = Setting::grid(
        &distinct(steppers),
        &distinct(&args.precisions),
        &distinct(tolerances),
        &distinct(&schedules),
    );
    some(&settings)?;
    let plan = Plan { settings, rounds: args.rounds, spp: args.spp, threads: args.threads };

    let meter = Meter::new(args.meter.progress, "following rays", "runs");
    let progress = |done, total| meter.update(Progress { done: done as u64, total: total as u64 });
    let measurements = sweep(scene, &plan, &progress);
    meter.finish();
    files.write(|out| report::scene::write_csv(&measurements, out), &report::scene::figure(&measurements))?;
    print(&report::scene::table(&measurements))?;
    say(format!("{}; wrote {}", plural(measurements.len(), "setting", "settings"), names(&args.output)));
    Ok(Outcome::Good)
}

/// The scene in the size of the study; says what is wrong with it.
fn load(args: &StudyArgs, path: &Path, outputs: &Files) -> Result<Baked, Failure> {
    let options = LoadOptions { size: Some(args.size), ..args.changes.options(args.reads.files(path)?) };
    let mut scene = scene::load_with(path, &options)?;
    overwrite::refuse(outputs.paths(), &options.files.inputs())?;
    memory::check_kept(args.size, &options.files.memory())?;
    say_remarks(&scene);
    (scene.settings.width, scene.settings.height) = args.size;
    Ok(scene)
}

/// Studies the rays of a table.
fn free(args: &StudyArgs, rays: &Path, files: Files) -> Result<Outcome, Failure> {
    let has_orbits = |stepper: &StepperKind| *stepper != StepperKind::Rk4Paper;
    if !args.steppers.iter().all(has_orbits) {
        return Err(Failure::new("the stepper rk4-paper runs in renders only")
            .help("leave it out of --steppers, or study a SCENE"));
    }
    let all = StepperKind::value_variants();
    let steppers = if args.steppers.is_empty() { all } else { &args.steppers };
    let finer = [&TOLERANCES[..], &FINER].concat();
    let tolerances = if args.tolerances.is_empty() { &finer } else { &args.tolerances };
    let settings = ends::grid(&distinct(steppers), &distinct(&args.precisions), &distinct(tolerances));
    some(&settings)?;

    overwrite::refuse(files.paths(), &[rays.to_owned()])?;
    let mut table = Table::open(rays, "ray")?;
    let columns = Columns::find(&table.header, args.spacetime)?;
    let ends = columns.header.places(ENDS)?;
    let (mut cases, mut lines) = (Vec::new(), Vec::new());
    loop {
        let rows = table.chunk()?;
        if rows.is_empty() {
            break;
        }
        let read: Result<Vec<Case>, Failure> =
            rows.par_iter().map(|row| case(&columns, ends.as_ref(), row)).collect();
        cases.extend(read?);
        lines.extend(rows.iter().map(line));
    }
    if cases.is_empty() {
        return Err(Failure::new(format!("`{}` has no rays", rays.display())).help("give a ray per row"));
    }

    let plan = ends::Plan { settings, rounds: args.rounds, threads: args.threads };
    let meter = Meter::new(args.meter.progress, "following rays", "runs");
    let progress = |done, total| meter.update(Progress { done: done as u64, total: total as u64 });
    let measured = ends::sweep(&cases, &plan, &progress);
    meter.finish();
    let measurements = measured.map_err(|refusal| columns.refuse(lines[refusal.index], &refusal.fault))?;
    files.write(|out| report::ends::write_csv(&measurements, out), &report::ends::figure(&measurements))?;
    print(&report::ends::table(&measurements))?;
    say(format!(
        "{} on {}; wrote {}",
        plural(measurements.len(), "setting", "settings"),
        plural(cases.len(), "ray", "rays"),
        names(&args.output)
    ));
    Ok(Outcome::Good)
}

/// The ray of a row and its end, which is in the columns `ends` or else followed.
fn case(columns: &Columns, ends: Option<&[usize; ENDS.len()]>, row: &ByteRecord) -> Result<Case, Failure> {
    let (spacetime, ray) = columns.ray(row)?;
    let exact = match ends {
        Some(places) => given(columns, places, row)?,
        None => {
            let exact =
                Exact::followed(spacetime, &ray).map_err(|fault| columns.refuse(line(row), &fault))?;
            if exact.status.is_lost() {
                let cause = format!("the reference itself is lost: {}", exact.status.name());
                return Err(columns.header.at(line(row), "the ray", &cause).help("take the row out"));
            }
            exact
        }
    };
    Ok(Case { spacetime, ray, exact })
}

/// The end that the columns of a row give.
fn given(columns: &Columns, places: &[usize; ENDS.len()], row: &ByteRecord) -> Result<Exact, Failure> {
    let text = String::from_utf8_lossy(row.get(places[0]).unwrap_or_default());
    let status = Status::ALL.into_iter().find(|status| status.name() == text && !status.is_lost());
    let status = status.ok_or_else(|| {
        columns
            .header
            .at(line(row), "column `status`", &format!("`{text}` is no end"))
            .help("give escaped, captured or missed")
    })?;
    if status != Status::Escaped {
        return Ok(Exact { status, crossing: None });
    }
    let mut numbers = [0.0; ENDS.len()];
    for index in 1..ENDS.len() {
        numbers[index] = columns.header.number(row, ENDS[index], places[index])?;
    }
    let [_, x, y, z, dx, dy, dz, sens] = numbers;
    let (position, direction) = (DVec3::new(x, y, z), DVec3::new(dx, dy, dz));
    if sens <= 0.0 {
        let cause = format!("a sensitivity of {sens}");
        return Err(columns.header.at(line(row), "column `sens`", &cause).help("give a number above 0"));
    }
    let direction = direction.try_normalize().ok_or_else(|| {
        columns
            .header
            .at(line(row), "columns `dx1`, `dy1`, `dz1`", "no direction")
            .help("give a direction of length 1")
    })?;
    Ok(Exact { status, crossing: Some(Crossing { position, direction, sens }) })
}

/// Refuses to measure nothing.
fn some<T>(settings: &[T]) -> Result<(), Failure> {
    if settings.is_empty() {
        return Err(Failure::new(
            "there is nothing to measure: all --tolerances are finer than the --precisions",
        )
        .help("give tolerances from 1.2e-5 up for f32, from 2.3e-14 up for f64"));
    }
    Ok(())
}
