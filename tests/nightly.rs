//! Long tests run at night: `.ci/nightly` lists each test that is ignored by default, and nothing else.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Files and names of the ignored tests in `tests/`.
fn ignored(folder: &Path) -> BTreeSet<(String, String)> {
    let mut tests = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let Some(file) = path.file_name().unwrap().to_str().unwrap().strip_suffix(".rs") else { continue };
        let text = fs::read_to_string(&path).unwrap();
        for after in text.split("\n#[ignore").skip(1) {
            let function = after.split_once("\nfn ").expect("a function after #[ignore]").1;
            let name = function.split_once('(').unwrap().0;
            tests.insert((file.to_owned(), name.to_owned()));
        }
    }
    tests
}

#[test]
fn every_ignored_test_runs_at_night() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let script = fs::read_to_string(root.join(".ci/nightly")).unwrap();
    let list = script.split_once("\ntests=\"\n").unwrap().1.split_once("\n\"").unwrap().0;
    let listed = list.lines().map(|line| {
        let [file, name, _minutes] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
        (file.to_owned(), name.to_owned())
    });
    assert_eq!(listed.collect::<BTreeSet<_>>(), ignored(&root.join("tests")));
}
