//! The `warpfront` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    warpfront::cli::main()
}
