//! Models by themselves, as the scene files that they stand for.

use std::path::Path;

/// The scene file that a model by itself stands for.
pub(super) fn bare_scene(path: &Path, component: &str) -> String {
    format!("[[entity]]\n{component} = {}\n", toml_edit::Value::from(bare_name(path)))
}

/// Name of the model in that scene file; not always its file name itself, which may not be text.
pub(super) fn bare_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
