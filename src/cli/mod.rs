//! Arguments → options, one file per subcommand.

use std::process::ExitCode;

/// Runs the command line; 0 good, 1 something was lost under `--strict`, 2 bad input.
pub fn main() -> ExitCode {
    ExitCode::SUCCESS
}
