//! The direction of dependencies between the folders of `src/`, read from the sources themselves.

use std::fs;
use std::path::{Path, PathBuf};

/// Each folder with the others that it may use: cli → study → plot → film, trace → scene → asset → light → shade →
/// geometry → geodesic → spacetime → math; `text` is for all that says something.
const ALLOWED: [(&str, &[&str]); 13] = [
    ("math", &[]),
    ("spacetime", &["math"]),
    ("geodesic", &["spacetime", "math"]),
    ("geometry", &["geodesic", "spacetime", "math"]),
    ("shade", &["geometry", "math"]),
    ("light", &["shade", "geometry", "geodesic", "spacetime", "math"]),
    ("asset", &["light", "geometry", "shade", "math", "text"]),
    ("film", &["asset", "spacetime", "math", "text"]),
    ("scene", &["asset", "light", "shade", "geometry", "geodesic", "spacetime", "math", "text"]),
    ("trace", &["scene", "film", "light", "shade", "geometry", "geodesic", "spacetime", "math"]),
    ("plot", &["film"]),
    (
        "study",
        &[
            "trace",
            "scene",
            "film",
            "plot",
            "light",
            "shade",
            "geometry",
            "geodesic",
            "spacetime",
            "math",
            "text",
        ],
    ),
    (
        "cli",
        &[
            "study",
            "trace",
            "scene",
            "film",
            "plot",
            "asset",
            "light",
            "shade",
            "geometry",
            "spacetime",
            "math",
            "text",
        ],
    ),
];

/// Rust files in a folder and its subfolders, in order.
pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// The folders that a line of code names after `crate::`; `crate::{a, b::c}` names `a` and `b`.
fn named(line: &str) -> Vec<&str> {
    let code = line.split("//").next().unwrap_or_default();
    let mut names = Vec::new();
    for (at, marker) in code.match_indices("crate::") {
        // `$crate::` in a macro is a path of this crate too.
        let rest = &code[at + marker.len()..];
        let word = |text: &str| text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
        match rest.strip_prefix('{').and_then(|rest| rest.split_once('}')) {
            Some((list, _)) => {
                names.extend(list.split(',').map(|item| &item.trim()[..word(item.trim())]));
            }
            None => names.push(&rest[..word(rest)]),
        }
    }
    names
}

#[test]
fn dependencies_between_folders_point_one_way() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    for (folder, allowed) in ALLOWED {
        for file in sources(&root.join(folder)) {
            let text = fs::read_to_string(&file).unwrap();
            for (number, line) in text.lines().enumerate() {
                for name in named(line) {
                    if name != folder && !allowed.contains(&name) {
                        let place = file.strip_prefix(&root).unwrap_or(&file).display();
                        wrong.push(format!("src/{place}:{}: {folder} must not use {name}", number + 1));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_folder_of_the_sources_has_its_place_in_the_order() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for entry in fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let known = !path.is_dir() || ALLOWED.iter().any(|(folder, _)| *folder == name);
        assert!(known, "src/{name} is missing from the table in tests/it/project/layers.rs");
    }
}
