//! `warpfront bench`.

use std::io::Write;
use std::path::Path;

use super::bench_args::BenchArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::measure;
use super::parse::Baseline;
use super::prefixed::{StudyFiles, with_suffix};
use super::progress::Meter;
use super::say::{print, say, say_remarks};
use super::shared_args::distinct;
use super::units::plural;
use super::{memory, overwrite};
use crate::asset::Files;
use crate::film::atomic::Output;
use crate::scene::{self, Baked, LoadOptions};
use crate::study::bench::{Bench, BenchRecord, Contender, Point, Previous, Race, Vary, VaryError, report};

/// Races the wavefront against its baselines, prints what was found, and writes it if asked to.
pub(super) fn run(args: &BenchArgs) -> Result<Completion, Failure> {
    let _ends_the_process = Interrupt::install();
    args.check()?;
    let outputs = args.output.as_deref().map(|prefix| -> Result<_, Failure> {
        Ok((StudyFiles::open(prefix)?, Output::create(&with_suffix(prefix, "json"))?))
    });
    let outputs = outputs.transpose()?;
    let path = &args.scene.path;
    let meter = Meter::new(args.meter.progress, format!("loading {}", path.display()), "renders");
    let options = LoadOptions { size: Some(args.size), ..args.scene.options()? };
    let mut scene = scene::load_with(path, &options)?;
    let previous = previous(args, &options.files)?;
    if let Some((files, json)) = &outputs {
        overwrite::refuse(files.paths().chain([json.path()]), &options.files.inputs())?;
    }
    say_remarks(&scene);
    args.apply(&mut scene.settings);
    memory::check_kept((scene.settings.width, scene.settings.height), &options.files.memory())?;
    let contenders = contenders(args, &scene)?;
    let base = Point::of(&scene, &args.run());
    let (scenes, points) = match args.sweep {
        Some(sweep) => sweep.points(&args.values, &base, scene)?,
        None => (vec![scene], vec![base]),
    };

    for previous in &previous {
        previous.check(&path.display().to_string(), &points)?;
    }
    meter.enter("rendering");
    let races = measure::run(Bench::new(scenes, points, contenders), args.rounds, meter)?;
    let report = report(args.sweep, &races, &previous);
    print(&format!("{}\n\n{}", conditions(args, &races), report.text))?;
    if let Some((files, json)) = outputs {
        let names = format!("{}, {}", files.names(), json.path().display());
        let name = path.display().to_string();
        let record = BenchRecord::new(&name, args.sweep, &races);
        json.commit(|out| {
            serde_json::to_writer_pretty(&mut *out, &record)?;
            out.write_all(b"\n")
        })?;
        files.write(&report)?;
        say(format!("wrote {names}"));
    }
    Ok(Completion::Good)
}

/// Contenders of the race, the wavefront first.
fn contenders(args: &BenchArgs, scene: &Baked) -> Result<Vec<Contender>, Failure> {
    let rendering: Vec<Contender> = args.baseline.iter().filter_map(Baseline::contender).collect();
    let contenders = [&[Contender::Wavefront][..], &distinct(&rendering)].concat();
    if let Some(contender) = contenders.iter().find(|contender| contender.needs_a_hole())
        && scene.spacetime.is_flat()
    {
        let message = format!("--baseline {} needs a hole, and the scene is flat", contender.name());
        return Err(Failure::new(message).help("give a scene with a hole, or --black-hole"));
    }
    Ok(contenders)
}

/// Records of builds before this one.
fn previous(args: &BenchArgs, files: &Files) -> Result<Vec<Previous>, Failure> {
    let read = |path: &Path| {
        let name = path.display().to_string();
        let bytes =
            files.read(path).map_err(|error| Failure::new(format!("cannot read `{name}`: {error}")))?;
        Ok(Previous::read(&name, &bytes)?)
    };
    args.baseline.iter().filter_map(Baseline::record).map(read).collect()
}

/// Conditions of the race, in words, but for what is swept.
fn conditions(args: &BenchArgs, races: &[Race]) -> String {
    let Point { settings, batch, .. } = &races[0].point;
    let threads = races[0].runs[0].rounds[0].threads;
    let parts = [
        (Vary::Pixels, format!("{}x{} pixels", settings.width, settings.height)),
        (Vary::Spp, format!("{} spp", settings.spp)),
        (Vary::Threads, plural(threads, "thread", "threads")),
        (Vary::Batch, format!("batches of {batch}")),
    ];
    let parts: Vec<String> =
        parts.into_iter().filter(|(what, _)| args.sweep != Some(*what)).map(|(_, part)| part).collect();
    let names: Vec<String> = races[0].runs.iter().map(|runs| runs.contender.name()).collect();
    let room = match args.sweep {
        Some(Vary::Triangles) => " (camera and hole, in a room built for this)",
        _ => "",
    };
    format!(
        "{}{room}: {}; {} after one render each to warm up, all in turn: {}",
        args.scene.path.display(),
        parts.join(", "),
        plural(args.rounds as usize, "round", "rounds"),
        names.join(", ")
    )
}

impl From<VaryError> for Failure {
    fn from(refusal: VaryError) -> Self {
        Self::new(refusal.cause).help(refusal.remedy)
    }
}
