//! `warpfront study`.

use std::path::Path;

use super::args::StudyArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::measure::{self, distinct_or};
use super::prefixed::StudyFiles;
use super::progress::Meter;
use super::say::say_remarks;
use super::shared_args::distinct;
use super::{light_study, memory, overwrite, ray_study};
use crate::scene::{self, Baked, LoadOptions, StepperKind};
use crate::study::camera_rays::CameraRays;
use crate::study::way::Way;

/// Tolerances on a scene.
const TOLERANCES: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];

/// Measures ways to integrate rays, or to look for lights, and writes what was found.
pub(super) fn run(args: &StudyArgs) -> Result<Completion, Failure> {
    let _ends_the_process = Interrupt::install();
    let files = StudyFiles::open(&args.output)?;
    match (&args.rays, &args.scene) {
        (Some(rays), _) => ray_study::run(args, rays, files),
        (None, Some(path)) if !args.light_sampling.is_empty() => {
            light_study::run(args, load(args, path, &files)?, path, files)
        }
        (None, Some(path)) => of_scene(args, load(args, path, &files)?, files),
        (None, None) => Err(Failure::new("nothing to study").help("give a SCENE, or --rays RAYS.csv")),
    }
}

/// Studies the camera rays of a scene.
fn of_scene(args: &StudyArgs, mut scene: Baked, files: StudyFiles) -> Result<Completion, Failure> {
    scene.settings.arc_tolerance = args.arc_tolerance.or(scene.settings.arc_tolerance);
    let settings = Way::grid(
        &distinct_or(&args.steppers, &[&StepperKind::OF_ORBITS[..], &[StepperKind::Rk4Paper]].concat()),
        &distinct(&args.precisions),
        &distinct_or(&args.tolerances, &TOLERANCES),
        &distinct_or(&args.schedules, &[scene.settings.schedule]),
    );
    measure::check_some(&settings)?;
    let meter = Meter::new(args.meter.progress, "following rays", "runs");
    let study = CameraRays::new(scene, settings, args.spp, args.threads);
    let report = measure::run(study, args.rounds, meter).unwrap_or_else(|never| match never {});
    measure::publish(&report, files, "")
}

/// The scene in the size of the study; says what is wrong with it.
fn load(args: &StudyArgs, path: &Path, outputs: &StudyFiles) -> Result<Baked, Failure> {
    let options = LoadOptions { size: Some(args.size), ..args.changes.options(args.reads.files(path)?) };
    let mut scene = scene::load_with(path, &options)?;
    overwrite::refuse(outputs.paths(), &options.files.inputs())?;
    memory::check_kept(args.size, &options.files.memory())?;
    say_remarks(&scene);
    (scene.settings.width, scene.settings.height) = args.size;
    Ok(scene)
}
