//! Arguments → options, one file per subcommand.

mod args;
mod bench;
mod bench_args;
mod compare;
mod connect;
mod cost;
mod failure;
mod info;
mod interrupt;
mod light_study;
mod memory;
mod outputs;
mod parse;
mod prefixed;
mod progress;
mod quality;
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

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

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
        Err(error) => {
            // The help or message could not be printed: there is nobody to tell.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    let outcome = match &cli.command {
        Command::Render(args) => render::run(args),
        Command::Info(args) => info::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Rays(args) => rays::run(args),
        Command::Study(args) => study::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Trace(args) => trace::run(args),
        Command::Connect(args) => connect::run(args),
    };
    match outcome {
        Ok(Outcome::Good) => ExitCode::SUCCESS,
        Ok(Outcome::Lost | Outcome::Incomplete | Outcome::Differ) => ExitCode::from(1),
        Err(failure) => {
            say(failure);
            ExitCode::from(2)
        }
    }
}

/// A line on stderr; unlike `eprintln!` it does not panic when nobody reads it.
fn say(line: impl Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Prints the result of a command on stdout; a reader that has gone away, as `head` does, is no failure.
fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}
