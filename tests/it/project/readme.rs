//! README and the texts of the modules against the program: flags, keys, paths and tests that they name exist.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use warpfront::scene::load;

use crate::support::command::{Folder, assert_good, stdout};
use crate::support::{scene, scene_path};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files of a kind under a folder.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|own| own == extension) {
            found.push(path);
        }
    }
    found
}

/// README and the texts that rustdoc includes, with their names.
fn texts() -> Vec<(String, String)> {
    let mut paths = files(&root().join("src"), "md");
    paths.sort();
    paths.insert(0, root().join("README.md"));
    let name = |path: &Path| path.strip_prefix(root()).unwrap().display().to_string();
    paths.iter().map(|path| (name(path), fs::read_to_string(path).unwrap())).collect()
}

/// Fenced blocks with their languages, and the text without them.
fn fences(text: &str) -> (Vec<(String, String)>, String) {
    let (mut blocks, mut prose) = (Vec::new(), String::new());
    for (index, part) in text.split("```").enumerate() {
        if index % 2 == 0 {
            prose.push_str(part);
        } else {
            let (language, block) = part.split_once('\n').expect("a block of several lines");
            blocks.push((language.to_owned(), block.to_owned()));
        }
    }
    (blocks, prose)
}

/// Code in backticks, and the lines of shell blocks.
fn code(text: &str) -> Vec<String> {
    let (blocks, prose) = fences(text);
    let shell = blocks.iter().filter(|(language, _)| language == "sh").flat_map(|(_, block)| block.lines());
    let spans = prose.split('`').skip(1).step_by(2);
    spans.chain(shell).map(|code| code.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

/// Targets of links.
fn links(text: &str) -> Vec<String> {
    let (_, prose) = fences(text);
    prose.split("](").skip(1).map(|rest| rest.split(')').next().unwrap_or_default().to_owned()).collect()
}

/// Words in capitals stand for something, as NAME and SCENE do.
fn stands_for_something(word: &str) -> bool {
    word.split(|c: char| !c.is_alphabetic())
        .any(|part| part.len() > 1 && part.chars().all(char::is_uppercase))
}

/// Flags of each subcommand, by its own help.
fn flags() -> BTreeMap<String, BTreeSet<String>> {
    let folder = Folder::with(&[]);
    let help = |arguments: &[&str]| {
        let output = folder.run(arguments);
        assert_good(&output);
        stdout(&output)
    };
    let general = help(&["--help"]);
    let commands = general.split_once("Commands:\n").unwrap().1.split_once("\n\n").unwrap().0.to_owned();
    let names = commands.lines().filter_map(|line| line.split_whitespace().next());
    let of = |name: &str| {
        let help = help(&[name, "-h"]);
        // Deeper lines are descriptions.
        let lines =
            help.lines().filter(|line| line.trim_start().starts_with('-') && !line.starts_with("       "));
        let words = lines.flat_map(|line| line.split_whitespace().take(2));
        words.filter(|word| word.starts_with('-')).map(|word| word.trim_end_matches(',').to_owned()).collect()
    };
    names.filter(|name| *name != "help").map(|name| (name.to_owned(), of(name))).collect()
}

/// The arguments of each call of the program in a piece of code: after `warpfront` or `cargo run … --`, or from the
/// subcommand on.
fn calls<'a>(code: &'a str, commands: &BTreeSet<&str>) -> Vec<Vec<&'a str>> {
    let mut calls = Vec::new();
    for part in code.split("; ") {
        let words: Vec<&str> = part.split(' ').skip_while(|word| *word == "do").collect();
        let start = match words[..] {
            ["cargo", "run", ..] => words.iter().position(|word| *word == "--").map(|at| at + 1),
            ["warpfront", ..] => Some(1),
            [first, _, ..] if commands.contains(first) => Some(0),
            _ => None,
        };
        calls.extend(start.map(|start| words[start..].to_vec()).filter(|call| !call.is_empty()));
    }
    calls
}

fn flag(word: &str) -> Option<&str> {
    let name = word.split('=').next()?.trim_end_matches(',');
    (word.starts_with('-') && name.chars().any(char::is_alphabetic) && name.parse::<f64>().is_err())
        .then_some(name)
}

#[test]
fn readme_is_at_most_twenty_kilobytes() {
    let bytes = fs::metadata(root().join("README.md")).unwrap().len();
    assert!(
        bytes <= 20_000,
        "{bytes} bytes: move what is not needed at first sight to a module's documentation"
    );
}

#[test]
fn flags_in_the_texts_are_flags_of_the_program() {
    let flags = flags();
    let commands: BTreeSet<&str> = flags.keys().map(String::as_str).collect();
    let all: BTreeSet<&String> = flags.values().flatten().collect();
    let (mut wrong, mut checked) = (Vec::new(), 0);
    for (name, text) in texts() {
        for code in code(&text) {
            for call in calls(&code, &commands) {
                let Some(known) = flags.get(call[0]) else {
                    let known =
                        stands_for_something(call[0]) || call[0] == "help" || call[0].starts_with('-');
                    if !known {
                        wrong.push(format!("{name}: `{code}`: no subcommand {}", call[0]));
                    }
                    continue;
                };
                for flag in call.iter().filter_map(|word| flag(word)) {
                    checked += 1;
                    if !known.contains(flag) {
                        wrong.push(format!("{name}: `{code}`: {} takes no {flag}", call[0]));
                    }
                }
            }
            let alone = code.starts_with("--").then_some(&code);
            for flag in alone.iter().flat_map(|code| code.split(' ')).filter_map(flag) {
                checked += 1;
                if !all.iter().any(|known| *known == flag) {
                    wrong.push(format!("{name}: `{code}`: no subcommand takes {flag}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(checked > 80, "only {checked} flags were found");
}

#[test]
fn paths_and_links_in_the_texts_lead_to_files() {
    let folders = ["src/", "tests/", "scenes/", "assets/", "benches/", ".ci/"];
    let (mut wrong, mut checked) = (Vec::new(), 0);
    for (name, text) in texts() {
        let words = code(&text)
            .iter()
            .flat_map(|code| code.split(' ').map(str::to_owned).collect::<Vec<_>>())
            .collect::<Vec<_>>();
        let paths = words.into_iter().filter(|word| folders.iter().any(|folder| word.starts_with(folder)));
        let links =
            links(&text).into_iter().filter(|link| !link.starts_with("https://") && !link.starts_with('#'));
        for path in paths.chain(links).filter(|path| !stands_for_something(&path.replace("LICENSE", ""))) {
            checked += 1;
            if !root().join(&path).exists() {
                wrong.push(format!("{name}: {path}"));
            }
        }
    }
    assert!(wrong.is_empty(), "there is no\n{}", wrong.join("\n"));
    assert!(checked > 40, "only {checked} paths were found");
}

#[test]
fn anchors_in_the_readme_are_headings() {
    let text = fs::read_to_string(root().join("README.md")).unwrap();
    let (_, prose) = fences(&text);
    let slug = |heading: &str| {
        let kept: String =
            heading.to_lowercase().chars().filter(|c| c.is_alphanumeric() || " -".contains(*c)).collect();
        kept.replace(' ', "-")
    };
    let headings = prose.lines().filter(|line| line.starts_with('#'));
    let anchors: BTreeSet<String> =
        headings.map(|line| format!("#{}", slug(line.trim_start_matches('#').trim()))).collect();
    for link in links(&text).iter().filter(|link| link.starts_with('#')) {
        assert!(anchors.contains(link), "{link} is none of {anchors:?}");
    }
}

#[test]
fn tests_and_benches_in_the_texts_exist() {
    let tests = root().join("tests/it");
    let mut paths = Vec::new();
    for file in files(&tests, "rs") {
        let module =
            file.strip_prefix(&tests).unwrap().with_extension("").display().to_string().replace('/', "::");
        let text = fs::read_to_string(&file).unwrap();
        let functions = text.split("#[test]").skip(1).filter_map(|after| after.split_once("fn "));
        paths.extend(
            functions.map(|(_, rest)| format!("{module}::{}", rest.split('(').next().unwrap_or_default())),
        );
    }
    let mut checked = 0;
    for (name, text) in texts() {
        for code in code(&text).iter().filter(|code| code.starts_with("cargo ")) {
            let words: Vec<&str> = code.split(' ').collect();
            for pair in words.windows(3) {
                let exists = match *pair {
                    ["--test", "it", word] if word != "--" => paths.iter().any(|path| path.contains(word)),
                    [_, "--test", binary] => binary == "it",
                    [_, "--bench", bench] => root().join("benches").join(bench).with_extension("rs").exists(),
                    _ => continue,
                };
                checked += 1;
                assert!(exists || stands_for_something(pair[2]), "{name}: `{code}`: no {}", pair[2]);
            }
        }
    }
    assert!(checked > 5, "only {checked} were found");
}

#[test]
fn scenes_in_the_texts_load() {
    let mut loaded = 0;
    for (_, text) in texts() {
        for (_, block) in fences(&text).0.iter().filter(|(language, _)| language == "toml") {
            scene(block);
            loaded += 1;
        }
    }
    assert!(loaded > 0, "no scene was found");
}

#[test]
fn values_that_commands_in_the_texts_set_are_keys_of_their_scenes() {
    let mut checked = 0;
    for (name, text) in texts() {
        for code in code(&text) {
            let words: Vec<&str> = code.split(' ').collect();
            let scene = words.iter().find(|word| word.starts_with("scenes/") && root().join(word).is_file());
            let Some(scene) = scene else { continue };
            for pair in words.windows(2).filter(|pair| pair[0] == "--set") {
                checked += 1;
                let loaded = load(&root().join(scene), &[pair[1].to_owned()]);
                assert!(loaded.is_ok(), "{name}: `{code}`: {}", loaded.err().unwrap());
            }
        }
    }
    assert!(checked > 0, "no --set was found");
}

/// Keys that the loader says it takes in a table, when it is given one that it does not know.
fn keys_of_the_loader(table: &str) -> BTreeSet<String> {
    let error = load(&scene_path("cornell_black_hole.toml"), &[format!("{table}.no_such_key=1")]).err();
    let message = error.unwrap_or_else(|| panic!("{table} takes any key")).to_string();
    let list = message.split_once("expected one of ").unwrap_or_else(|| panic!("{message}")).1;
    list.lines().next().unwrap().split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn the_reference_of_scene_files_has_the_keys_that_the_loader_takes_and_no_others() {
    let text = fs::read_to_string(root().join("src/scene/keys.md")).unwrap();
    let mut tables: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let (mut table, mut outer) = (String::new(), String::new());
    for line in text.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<&str> =
            line.trim_matches('|').split(" | ").map(|cell| cell.trim_matches([' ', '|'])).collect();
        if let Some(name) = cells[0].strip_prefix("`[") {
            table = name.trim_matches(['`', '[', ']']).to_owned();
            if name.starts_with('[') {
                table.push_str(".0");
            }
        }
        let keys: Vec<String> = cells[1].split('`').skip(1).step_by(2).map(str::to_owned).collect();
        if table.is_empty() || keys.is_empty() {
            continue;
        }
        if cells[1].starts_with('↳') {
            tables.entry(format!("{table}.{outer}")).or_default().extend(keys);
        } else {
            outer = keys[0].clone();
            tables.entry(table.clone()).or_default().extend(keys);
        }
    }
    // Its rows are kinds, whose keys are values.
    assert!(tables.remove("entity.0.light").is_some());
    assert_eq!(tables.len(), 8, "{tables:?}");
    for (table, keys) in tables {
        assert_eq!(keys, keys_of_the_loader(&table), "keys of {table}: left what the text says");
    }
}
