//! Outputs that would replace an input.

use std::fs;
use std::path::{Path, PathBuf};

use super::failure::Failure;

/// Refuses `outputs` of which one is a file that the scene names.
pub(super) fn refuse<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: &[PathBuf],
) -> Result<(), Failure> {
    for output in outputs {
        // One that is not there replaces nothing.
        let Ok(there) = fs::canonicalize(output) else { continue };
        let is_there = |input: &&PathBuf| fs::canonicalize(input).is_ok_and(|input| input == there);
        if let Some(input) = inputs.iter().find(is_there) {
            let (output, input) = (output.display(), input.display());
            return Err(Failure::new(format!("`{output}` would replace `{input}`, which the scene needs"))
                .help("name another file for the output"));
        }
    }
    Ok(())
}
