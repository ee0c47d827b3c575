//! One name, one thing: no two types of `src/` share a name, tests' helpers included.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::layers::sources;

#[test]
fn type_names_are_unique() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for path in sources(&root) {
        let text = fs::read_to_string(&path).unwrap();
        for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
            let mut words =
                line.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|w| !w.is_empty());
            let is_visibility = |word: &&str| !matches!(*word, "pub" | "crate" | "super" | "in");
            let kind = words.find(is_visibility);
            if let (Some("struct" | "enum" | "trait" | "union"), Some(name)) = (kind, words.next()) {
                let file = path.strip_prefix(&root).unwrap_or(&path).display().to_string();
                files.entry(name.to_owned()).or_default().push(file);
            }
        }
    }
    assert!(files.len() > 100, "only {} types found", files.len());
    files.retain(|_, files| files.len() > 1);
    assert!(files.is_empty(), "names of several types: {files:#?}");
}
