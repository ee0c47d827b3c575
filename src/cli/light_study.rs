//! `warpfront study --light-sampling`.

use std::path::Path;

use super::args::StudyArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::measure::{self, distinct_or};
use super::prefixed::StudyFiles;
use super::progress::Meter;
use super::say::say;
use super::shared_args::distinct;
use crate::asset::Files as AssetFiles;
use crate::film::read_exr_with;
use crate::light::Lights;
use crate::scene::Baked;
use crate::study::light_sampling::{LightStudy, Plan, ReferenceSource};
use crate::study::reference::Reference;
use crate::study::rounds;

/// Samples per pixel.
const SPPS: [u32; 4] = [1, 4, 16, 64];
/// Samples of the reference for each of the largest picture.
const REFERENCE: u32 = 16;

/// Measures ways to look for lights and writes what was found.
pub(super) fn run(
    args: &StudyArgs,
    scene: Baked,
    path: &Path,
    files: StudyFiles,
) -> Result<Completion, Failure> {
    lit(&scene, path)?;
    let plan = Plan {
        ways: distinct(&args.light_sampling),
        spps: distinct_or(&args.spps, &SPPS),
        rounds: args.rounds,
        threads: args.threads,
    };
    let largest = plan.spps.iter().copied().max().unwrap_or(1);
    let source = match &args.reference {
        Some(path) => ReferenceSource::Given(given(args, path)?),
        None => ReferenceSource::Rendered(args.reference_spp.unwrap_or(largest.saturating_mul(REFERENCE))),
    };

    let meter = Meter::new(args.meter.progress, "learning of lights", "paths");
    let progress = |progress| meter.update(progress);
    // Renders tell how far they have come themselves.
    let report = rounds::run(LightStudy::new(scene, plan, source, &progress), args.rounds, &|_| {});
    meter.finish();
    measure::publish(&report?, files, "")
}

/// The reference at `path`, for pictures of the study's size.
fn given(args: &StudyArgs, path: &Path) -> Result<Reference, Failure> {
    let name = path.display().to_string();
    let image = read_exr_with(path, &AssetFiles::within(args.reads.memory()))?;
    let reference = Reference::given(image, &name, args.size)?;
    if reference.noise.is_none() {
        say(format!("warning: `{name}` has no variances (--aov variance): its noise counts as error"));
    }
    Ok(reference)
}

/// Refuses a scene in which there is nothing to find.
fn lit(scene: &Baked, path: &Path) -> Result<(), Failure> {
    let Baked { geometry, materials, textures, environment, punctual, .. } = scene;
    let path = path.display();
    if Lights::new(geometry, (materials, textures), environment, punctual, 0.0).is_empty() {
        return Err(Failure::new(format!("`{path}` has no lights that could be sampled"))
            .help("give a scene with an emission, a light, or a picture as its environment"));
    }
    if scene.settings.max_depth < 2 || !materials.iter().any(|material| material.spreads_light()) {
        return Err(Failure::new(format!("no surface of `{path}` is lit: light sampling has nothing to do"))
            .help("give a scene with a diffuse material, and a max_depth of 2 or more"));
    }
    Ok(())
}
