//! Outputs that would replace an input.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::outputs::same_file;

/// Refuses `outputs` of which one is a file that the scene names.
pub(super) fn refuse<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: &[PathBuf],
) -> Result<(), Failure> {
    for output in outputs {
        if let Some(input) = inputs.iter().find(|input| same_file(output, input)) {
            let (output, input) = (output.display(), input.display());
            return Err(Failure::new(format!("`{output}` would replace `{input}`, which the scene needs"))
                .help("name another file for the output"));
        }
    }
    Ok(())
}
