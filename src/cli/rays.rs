//! `warpfront rays`.

use std::path::Path;

use glam::DVec3;

use super::args::RaysArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::overwrite;
use super::say::{note_stepper, say, say_remarks};
use super::units::plural;
use crate::film::atomic::Output;
use crate::plot::Format;
use crate::scene;
use crate::study::{Fan, FanError, FanOptions};

/// Traces a fan of rays and draws it.
pub(super) fn run(args: &RaysArgs) -> Result<Completion, Failure> {
    let _ends_the_process = Interrupt::install();
    let output = Output::create(&args.output)?;
    let options = args.scene.options()?;
    let mut scene = scene::load_with(&args.scene.path, &options)?;
    overwrite::refuse([args.output.as_path()], &options.files.inputs())?;
    args.accuracy.apply(&mut scene.settings);
    note_stepper(&mut scene);
    say_remarks(&scene);
    let options = FanOptions {
        count: args.count,
        angle: args.fan.map(f64::to_radians),
        from: args.from.map(DVec3::from),
        up: args.up.map(DVec3::from),
    };
    let fan = Fan::trace(&scene, &options)?;
    match Format::of(&args.output) {
        Some(format) => output.commit(|out| fan.figure(&title(&args.scene.path)).write(format, out))?,
        None => output.commit(|out| fan.write_csv(out))?,
    }
    let fates: Vec<String> = fan.fates().into_iter().map(|(fate, count)| format!("{count} {fate}")).collect();
    let rays = plural(args.count as usize, "ray", "rays");
    say(format!("{rays}: {}; wrote {}", fates.join(", "), args.output.display()));
    Ok(Completion::Good)
}

/// A scene's name without its folder.
fn title(scene: &Path) -> String {
    let name = scene.file_stem().unwrap_or_default().to_string_lossy();
    format!("Rays in {name}")
}

impl From<FanError> for Failure {
    fn from(error: FanError) -> Self {
        let remedy = match error {
            FanError::InsideHorizon => {
                "give a --from outside the hole; `warpfront info` tells where its horizon is"
            }
            FanError::InErgosphere => "give a --from outside the ergosphere",
            FanError::UpAlongPlane => {
                "give an --up that is not 0 and does not point from the start of the fan to the hole"
            }
            FanError::NoFieldOfView => "give the angle of the fan by --fan, in degrees",
            FanError::BehindNearPlane => "give a smaller --fan, or --from",
        };
        Self::new(error.to_string()).help(remedy)
    }
}
