//! Names in OBJ and MTL files, of files and of materials, as programs write them.

use std::path::{Path, PathBuf};

/// The names on a `mtllib` line: all of it if there is such a file, else files with blanks in their names that end with
/// `.mtl`, else words.
pub fn library_names<'a>(line: &'a str, folder: &Path) -> Vec<&'a str> {
    let is_file = |name: &str| is_file(&find(folder, name));
    if is_file(line) {
        return vec![line];
    }
    let line = without_comment(line);
    let (mut names, mut start) = (Vec::new(), 0);
    let is_suffix = |end: usize| {
        let suffix = end.checked_sub(4).and_then(|at| line.get(at..end));
        suffix.is_some_and(|suffix| suffix.eq_ignore_ascii_case(".mtl"))
    };
    let ends = line.match_indices(char::is_whitespace).map(|(at, _)| at).chain([line.len()]);
    for end in ends.filter(|end| is_suffix(*end) || *end == line.len()) {
        let name = line.get(start..end).unwrap_or_default().trim_start();
        if is_file(name) {
            names.push(name);
        } else {
            names.extend(name.split_whitespace());
        }
        start = end;
    }
    names
}

/// Path of a file of this name: in the folder, by a path of Windows, or by its name alone; the first if nowhere.
pub fn find(folder: &Path, name: &str) -> PathBuf {
    let name = name.trim_matches('"');
    let slashes = name.replace('\\', "/");
    let alone = slashes.rsplit('/').next().unwrap_or_default();
    let places = [name, &slashes, alone].map(|name| folder.join(name));
    let found = places.iter().find(|path| is_file(path));
    found.or(places.first()).cloned().unwrap_or_default()
}

/// True if there is something by this name that is no folder.
fn is_file(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|file| !file.is_dir())
}

/// A name up to a blank and a `#`.
pub fn without_comment(name: &str) -> &str {
    let mut before = name.match_indices('#').map(|(at, _)| name.get(..at).unwrap_or_default());
    before.find(|before| before.ends_with(char::is_whitespace)).map_or(name, str::trim_end)
}
