//! Long tests run at night: `.ci/nightly` lists each test that is ignored by default, and nothing else.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Module paths of the ignored tests in the files of `folder`, which is the module `module`.
fn ignored(folder: &Path, module: &str) -> BTreeSet<String> {
    let mut tests = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let module =
            if name == "mod" || name == "main" { module.to_owned() } else { format!("{module}{name}::") };
        if path.is_dir() {
            tests.extend(ignored(&path, &module));
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        for after in text.split("\n#[ignore").skip(1) {
            let function = after.split_once("\nfn ").expect("a function after #[ignore]").1;
            tests.insert(module.clone() + function.split_once('(').unwrap().0);
        }
    }
    tests
}

#[test]
fn every_ignored_test_runs_at_night() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let script = fs::read_to_string(root.join(".ci/nightly")).unwrap();
    let list = script.split_once("\ntests=\"\n").unwrap().1.split_once("\n\"").unwrap().0;
    let listed =
        list.lines().map(|line| line.split_once(' ').unwrap_or_else(|| panic!("{line}")).0.to_owned());
    assert_eq!(listed.collect::<BTreeSet<_>>(), ignored(&root.join("tests/it"), ""));
}
