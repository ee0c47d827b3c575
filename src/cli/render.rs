//! `warpfront render`.

use super::args::RenderArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::outputs::Outputs;
use super::progress::Meter;
use super::say::{note_stepper, say, say_remarks};
use super::{memory, overwrite, summary};
use crate::scene::{self, LoadOptions};
use crate::trace;

/// Renders a scene and writes the files.
pub(super) fn run(args: &RenderArgs) -> Result<Completion, Failure> {
    let interrupt = Interrupt::install();
    let outputs = Outputs::open(&args.output, &args.scene.path)?;
    let meter = Meter::new(args.meter.progress, format!("loading {}", args.scene.path.display()), "paths");
    let options = LoadOptions { size: args.settings.size(), ..args.scene.options()? };
    let mut scene = scene::load_with(&args.scene.path, &options)?;
    overwrite::refuse(outputs.paths(), &options.files.inputs())?;
    args.settings.apply(&mut scene.settings);
    note_stepper(&mut scene);
    let run = args.run.resolve(scene.settings.width, scene.settings.height)?;
    memory::check(&scene.settings, &run, &options.files.memory())?;
    say_remarks(&scene);

    let asked_spp = scene.settings.spp;
    meter.render(asked_spp, run.time_limit);
    let rendered = trace::render(&scene, &run, interrupt.flag(), &|progress| {
        meter.update(progress);
        if progress.done > 0 {
            interrupt.has_picture();
        }
    });
    meter.finish();

    if rendered.unsampled == rendered.pixels() {
        say(no_sample());
        return Ok(Completion::Incomplete);
    }
    let losses = summary::losses(&rendered, asked_spp, interrupt.happened());
    losses.iter().for_each(|loss| say(format!("warning: {loss}")));
    let names = outputs.names();
    outputs.write(&rendered, &scene.settings, &args.scene.path)?;
    say(format!("{}; wrote {names}", summary::line(&rendered, asked_spp)));
    interrupt.resume();
    let complete = losses.is_empty() && scene.warnings.is_empty();
    Ok(match rendered.unsampled {
        0 if args.strict && !complete => Completion::Lost,
        0 => Completion::Good,
        _ => Completion::Incomplete,
    })
}

/// Failure of a render in which no pixel has a sample.
fn no_sample() -> Failure {
    Failure::new("the time limit was over before any pixel had a sample: nothing is written")
        .help("give a longer --time-limit, a smaller --max-depth or coarser tolerances")
}
