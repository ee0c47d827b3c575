//! Arguments → options, one file per subcommand.

mod args;
mod bench;
mod bench_args;
mod compare;
mod connect;
mod cost;
mod failure;
mod help;
mod info;
mod interrupt;
mod light_study;
mod manual;
mod measure;
mod memory;
mod misnomers;
mod outputs;
mod overwrite;
mod parse;
mod prefixed;
mod progress;
mod quality;
mod ray_study;
mod rays;
mod rays_table;
mod render;
mod rowwise;
mod shared_args;
mod stages;
mod study;
mod summary;
mod table;
mod trace;
mod units;

use std::env;
use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::{CommandFactory, Parser};
use serde::Serialize;

use crate::math::simd;
use crate::scene::Baked;
use crate::text;
use args::{Cli, Command};
use failure::Failure;

/// How a command that did not fail ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// All is there.
    Good,
    /// Something was lost, and `--strict` was given.
    Lost,
    /// Some pixels have no sample.
    Incomplete,
    /// Pictures differ by more than a flag allows.
    Differ,
}

/// Runs the command line; 0 good, 1 pixels without samples, or something was lost or differs and a flag minds, 2 bad input.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(mut error) => {
            misnomers::advise(&mut error, Cli::command(), &env::args_os().collect::<Vec<_>>());
            print_usage(&error);
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match run(&cli) {
        Ok(Outcome::Good) => ExitCode::SUCCESS,
        Ok(Outcome::Lost | Outcome::Incomplete | Outcome::Differ) => ExitCode::from(1),
        Err(failure) => {
            say(failure);
            ExitCode::from(2)
        }
    }
}

fn run(cli: &Cli) -> Result<Outcome, Failure> {
    simd::choose(cli.simd).map_err(|problem| {
        Failure::new(format!("--simd: {problem}")).help("leave --simd and WARPFRONT_SIMD out")
    })?;
    match &cli.command {
        Command::Render(args) => render::run(args),
        Command::Info(args) => info::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Rays(args) => rays::run(args),
        Command::Study(args) => study::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Trace(args) => trace::run(args),
        Command::Connect(args) => connect::run(args),
        Command::Completions(args) => manual::completions(args),
        Command::Man(args) => manual::man(args),
    }
}

/// Prints help, or what is wrong with the arguments: in colour, unless an argument is not fit for a terminal.
fn print_usage(error: &clap::Error) {
    let plain = error.render().to_string();
    if error.use_stderr() && text::lines(&plain) != plain {
        return say(plain.trim_end());
    }
    // If nobody reads it there is nobody to tell.
    let _ = error.print();
}

/// Lines on stderr, fit for a terminal; unlike `eprintln!` it does not panic when nobody reads them.
fn say(lines: impl Display) {
    let _ = writeln!(io::stderr(), "{}", text::lines(&lines.to_string()));
}

/// Says what was decided about a scene, and what its files were not understood to the letter for, one line each.
fn say_remarks(scene: &Baked) {
    shown(&scene.notes).for_each(|note| say(format!("note: {note}")));
    shown(&scene.warnings).for_each(|warning| say(format!("warning: {warning}")));
}

/// Warnings, each on one line; of very many the first ones and how many more there are.
fn shown(warnings: &[String]) -> impl Iterator<Item = String> {
    /// Warnings in full.
    const MOST: usize = 60;
    let more = warnings.len().saturating_sub(MOST);
    let more = (more > 0).then(|| format!("and {more} more warnings"));
    warnings.iter().take(MOST).map(|warning| text::line(warning).into_owned()).chain(more)
}

/// Prints the result of a command on stdout, fit for a terminal.
fn print(text: &str) -> Result<(), Failure> {
    write_stdout(&text::lines(text))
}

/// Prints a record on stdout.
fn print_json(record: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(record);
    let json = json.map_err(|error| Failure::new(format!("cannot express the result as JSON: {error}")))?;
    write_stdout(&format!("{}\n", text::json(&json)))
}

/// A reader that has gone away, as `head` does, is no failure.
fn write_stdout(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}
