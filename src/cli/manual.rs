//! `warpfront man` and `warpfront completions`.

use clap::CommandFactory;
use clap_mangen::Man;

use super::args::{Cli, CompletionsArgs, ManArgs};
use super::completion::Completion;
use super::failure::Failure;
use super::say::{say, write_stdout};
use super::units::plural;
use crate::film::atomic::Output;

/// Writes all manual pages to a folder, or prints one.
pub(super) fn man(args: &ManArgs) -> Result<Completion, Failure> {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    if let Some(folder) = &args.output {
        let pages: Vec<Man> =
            std::iter::once(&program).chain(program.get_subcommands()).cloned().map(Man::new).collect();
        for page in &pages {
            Output::create(&folder.join(page.get_filename()))?.commit(|out| page.render(out))?;
        }
        say(format!("wrote {} to {}", plural(pages.len(), "page", "pages"), folder.display()));
        return Ok(Completion::Good);
    }
    let chosen = match &args.command {
        None => &program,
        Some(name) => program.find_subcommand(name).ok_or_else(|| {
            let names: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
            Failure::new(format!("there is no subcommand `{name}`"))
                .help(format!("it is one of {}", names.join(", ")))
        })?,
    };
    let mut page = Vec::new();
    let written = Man::new(chosen.clone()).render(&mut page);
    written.map_err(|error| Failure::new(format!("cannot write the manual page: {error}")))?;
    write_stdout(&String::from_utf8_lossy(&page))?;
    Ok(Completion::Good)
}

/// Prints a shell's completions.
pub(super) fn completions(args: &CompletionsArgs) -> Result<Completion, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "warpfront", &mut script);
    write_stdout(&String::from_utf8_lossy(&script))?;
    Ok(Completion::Good)
}
