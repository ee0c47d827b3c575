//! Arguments → options, one file per subcommand.
//!
#![doc = include_str!("tables.md")]

mod args;
mod bench;
mod bench_args;
mod compare;
mod completion;
mod connect;
mod cost;
mod csv_text;
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
mod say;
mod shared_args;
mod stages;
mod study;
mod summary;
mod table;
mod trace;
mod units;

use std::env;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use crate::math::simd;
use crate::text;
use args::{Cli, Command};
use completion::Completion;
use failure::Failure;
use say::say;

/// Runs the command line; 0 good, 1 pixels without samples, or something was lost or differs and a flag minds, 2 bad
/// input.
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
        Ok(Completion::Good) => ExitCode::SUCCESS,
        Ok(Completion::Lost | Completion::Incomplete | Completion::Differ) => ExitCode::from(1),
        Err(failure) => {
            say(failure);
            ExitCode::from(2)
        }
    }
}

fn run(cli: &Cli) -> Result<Completion, Failure> {
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
