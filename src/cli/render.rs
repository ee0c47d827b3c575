//! `warpfront render`.

use super::args::RenderArgs;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::outputs::Outputs;
use super::progress::Bar;
use super::{Outcome, memory, overwrite, say, say_remarks, summary};
use crate::scene::{self, LoadOptions};
use crate::trace;

/// Renders a scene and writes the files.
pub(super) fn run(args: &RenderArgs) -> Result<Outcome, Failure> {
    let interrupt = Interrupt::install();
    let outputs = Outputs::open(&args.output, &args.scene.path)?;
    let options = LoadOptions { size: args.settings.size(), ..args.scene.options()? };
    let mut scene = scene::load_with(&args.scene.path, &options)?;
    overwrite::refuse(outputs.paths(), &options.files.opened())?;
    args.settings.apply(&mut scene.settings);
    let run = args.run.resolve(scene.settings.width, scene.settings.height)?;
    memory::check(&scene.settings, &run, &options.files.memory())?;
    say_remarks(&scene);

    let bar = Bar::new("paths");
    interrupt.render_begins();
    let rendered = trace::render(&scene, &run, interrupt.flag(), &|progress| bar.update(progress));
    bar.finish();

    let asked_spp = scene.settings.spp;
    let losses = summary::losses(&rendered, asked_spp, interrupt.happened());
    losses.iter().for_each(|loss| say(format!("warning: {loss}")));
    let names = outputs.names();
    outputs.write(&rendered, &scene.settings, &args.scene.path)?;
    say(format!("{}; wrote {names}", summary::line(&rendered, asked_spp)));
    let complete = losses.is_empty() && scene.warnings.is_empty();
    Ok(if args.strict && !complete { Outcome::Lost } else { Outcome::Good })
}
