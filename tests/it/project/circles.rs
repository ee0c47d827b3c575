//! Circles of files in `src/` that use each other, read from the sources themselves.
//!
//! A file uses the files that define the items it names after `crate::`, `super::`, `self::`, a child module or an
//! imported one, in code that is no test. Items are followed through `use`: what a `mod.rs` re-exports is not its own,
//! and to declare or to re-export a child is not to use it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::layers::sources;

/// Path of a module from the root of the crate.
type Module = Vec<String>;

/// A file of `src/`, as far as paths are concerned.
#[derive(Default)]
struct Source {
    /// Its place in `src/`.
    file: String,
    /// Imported names, with the paths they stand for.
    imports: BTreeMap<String, Vec<String>>,
    /// Paths of items that it names.
    paths: BTreeSet<Vec<String>>,
}

/// Text of Rust code, without comments, strings, characters and tests.
fn code(text: &str) -> String {
    let mut kept = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let raw = rest.strip_prefix('r').map(|rest| rest.trim_start_matches('#'));
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if raw.is_some_and(|raw| raw.starts_with('"')) && !kept.ends_with(char::is_alphanumeric) {
            let hashes = rest[1..].find('"').unwrap_or(0);
            let (start, end) = (2 + hashes, format!("\"{}", "#".repeat(hashes)));
            rest[start..].find(&end).map_or(rest.len(), |at| start + at + end.len())
        } else if first == '"' {
            let mut escaped = true;
            let end = rest.char_indices().find(|&(_, c)| {
                let is_end = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                is_end
            });
            end.map_or(rest.len(), |(at, _)| at + 1)
        } else if first == '\'' {
            let mut chars = rest.char_indices().skip(1);
            match (chars.next(), chars.next()) {
                (Some((_, '\\')), Some((at, _))) => {
                    rest[at + 1..].find('\'').map_or(rest.len(), |end| at + end + 2)
                }
                (_, Some((at, '\''))) => at + 1,
                _ => 0,
            }
        } else {
            0
        };
        if skipped == 0 {
            kept.push(first);
            rest = &rest[first.len_utf8()..];
        } else {
            kept.push(' ');
            rest = &rest[skipped..];
        }
    }
    without_tests(&kept)
}

/// Drops what stands under `#[cfg(test)]`: up to the end of a block, or of a statement without one.
fn without_tests(code: &str) -> String {
    let mut kept = String::new();
    let mut rest = code;
    while let Some((before, after)) = rest.split_once("#[cfg(test)]") {
        kept.push_str(before);
        let mut depth = 0;
        let end = after.char_indices().find(|&(_, c)| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            depth == 0 && matches!(c, '}' | ';')
        });
        rest = end.map_or("", |(at, _)| &after[at + 1..]);
    }
    kept + rest
}

fn tokens(code: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let mut chars = code.chars().peekable();
    while let Some(c) = chars.next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let mut token = String::from(c);
        if is_word(c) {
            while let Some(&next) = chars.peek().filter(|c| is_word(**c)) {
                token.push(next);
                chars.next();
            }
        } else if c == ':' && chars.peek() == Some(&':') {
            token.push(':');
            chars.next();
        }
        if !c.is_whitespace() {
            tokens.push(token);
        }
    }
    tokens
}

/// The names that a tree of a `use` brings in, and their paths, from the token `at` on; returns the token after the
/// tree.
fn import(
    tokens: &[String],
    mut at: usize,
    path: &[String],
    found: &mut Vec<(String, Vec<String>)>,
) -> usize {
    let mut path = path.to_vec();
    while let Some(token) = tokens.get(at) {
        at += 1;
        match token.as_str() {
            "::" => {}
            "{" => {
                while tokens.get(at).is_some_and(|token| token != "}") {
                    at = import(tokens, at, &path, found);
                    at += usize::from(tokens.get(at).is_some_and(|token| token == ","));
                }
                return at + 1;
            }
            "," | ";" | "}" => {
                at -= 1;
                break;
            }
            "as" => {
                found.push((tokens.get(at).cloned().unwrap_or_default(), path));
                return at + 1;
            }
            "self" if !path.is_empty() => {}
            name => path.push(name.to_owned()),
        }
    }
    found.push((path.last().cloned().unwrap_or_default(), path));
    at
}

fn read(file: &str, text: &str) -> Source {
    let tokens = tokens(&code(text));
    let mut source = Source { file: file.to_owned(), ..Source::default() };
    let mut exported = Vec::new();
    let mut words = BTreeSet::new();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at] == "use" {
            // `pub use` or `pub(crate) use`.
            let is_exported = at > 0 && matches!(tokens[at - 1].as_str(), "pub" | ")");
            let mut found = Vec::new();
            at = import(&tokens, at + 1, &[], &mut found);
            if is_exported {
                exported.extend(found.clone());
            } else {
                source.paths.extend(found.iter().map(|(_, path)| path.clone()));
            }
            source.imports.extend(found);
            continue;
        }
        let mut path = vec![tokens[at].clone()];
        at += 1;
        while tokens.get(at).is_some_and(|token| token == "::")
            && tokens.get(at + 1).is_some_and(|token| token.starts_with(|c: char| c.is_alphabetic()))
        {
            path.push(tokens[at + 1].clone());
            at += 2;
        }
        words.insert(path[0].clone());
        if path.len() > 1 {
            source.paths.insert(path);
        }
    }
    // What is re-exported and named as well is used.
    let used = exported.into_iter().filter(|(name, _)| words.contains(name));
    source.paths.extend(used.map(|(_, path)| path));
    source
}

/// Files with the files that they use, and a path by which they do.
type Uses<'a> = BTreeMap<&'a str, BTreeMap<&'a str, String>>;

/// Files that a file uses, by way of others or not.
fn reached<'a>(uses: &Uses<'a>, from: &'a str) -> BTreeSet<&'a str> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(file) = open.pop() {
        open.extend(uses[file].keys().copied().filter(|file| reached.insert(*file)));
    }
    reached
}

/// All files by their modules.
struct Tree(BTreeMap<Module, Source>);

impl Tree {
    fn new<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let module = |file: &str| -> Module {
            let parts = file.trim_end_matches(".rs").split('/');
            parts.filter(|part| !matches!(*part, "mod" | "lib")).map(str::to_owned).collect()
        };
        Self(files.into_iter().map(|(file, text)| (module(file), read(file, text))).collect())
    }

    /// The module whose file defines the item that `path` names in `module`; `None` if it is of another crate, or a
    /// module.
    fn definition(&self, module: &Module, path: &[String], patience: usize) -> Option<Module> {
        let mut at = module.clone();
        let mut is_inside = false;
        for (number, name) in path.iter().enumerate() {
            match name.as_str() {
                "crate" => at.clear(),
                "super" => drop(at.pop()),
                "self" => {}
                name => {
                    let child = [at.as_slice(), &[name.to_owned()]].concat();
                    let imported = self.0.get(&at).and_then(|source| source.imports.get(name));
                    // A path to itself is a macro's: `pub(crate) use columns`.
                    let imported = imported.filter(|import| import.len() > 1);
                    if self.0.contains_key(&child) {
                        at = child;
                    } else if let Some(import) = imported.filter(|_| patience > 0) {
                        let whole = [import.as_slice(), &path[number + 1..]].concat();
                        return self.definition(&at, &whole, patience - 1);
                    } else {
                        return is_inside.then_some(at);
                    }
                }
            }
            is_inside = true;
        }
        None
    }

    fn uses(&self) -> Uses<'_> {
        let mut uses = Uses::new();
        for (module, source) in &self.0 {
            let used = uses.entry(&source.file).or_default();
            for path in &source.paths {
                let definition = self.definition(module, path, 8).filter(|definition| definition != module);
                if let Some(other) = definition.and_then(|definition| self.0.get(&definition)) {
                    used.entry(&other.file).or_insert_with(|| path.join("::"));
                }
            }
        }
        uses
    }

    /// Sets of files of which each uses each, by way of others or not: the strongly connected components.
    fn circles(&self) -> Vec<Vec<&str>> {
        let uses = self.uses();
        let reach: BTreeMap<&str, BTreeSet<&str>> =
            uses.keys().map(|&file| (file, reached(&uses, file))).collect();
        let circle = |file: &str| -> Vec<&str> {
            reach[file].iter().copied().filter(|other| reach[other].contains(file)).collect()
        };
        let circles: BTreeSet<Vec<&str>> = uses.keys().map(|file| circle(file)).collect();
        circles.into_iter().filter(|circle| !circle.is_empty()).collect()
    }
}

#[test]
fn no_files_use_each_other_in_circles() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let texts: Vec<(String, String)> = sources(&root)
        .iter()
        .map(|path| {
            let file = path.strip_prefix(&root).unwrap_or(path).to_string_lossy().replace('\\', "/");
            (file, fs::read_to_string(path).unwrap())
        })
        .collect();
    let tree = Tree::new(texts.iter().map(|(file, text)| (file.as_str(), text.as_str())));
    let (circles, uses) = (tree.circles(), tree.uses());
    let mut list = String::new();
    for circle in &circles {
        writeln!(list, "circle of {} files:", circle.len()).unwrap();
        for file in circle {
            for (other, path) in uses[file].iter().filter(|(other, _)| circle.contains(other)) {
                writeln!(list, "    {file} uses {other}: {path}").unwrap();
            }
        }
    }
    assert!(circles.is_empty(), "\n{list}");
}

#[test]
fn a_circle_is_seen_through_re_exports_inline_paths_and_children_but_not_through_tests() {
    let circles = |files: &[(&str, &str)]| {
        Tree::new(files.iter().copied())
            .circles()
            .into_iter()
            .map(|circle| circle.into_iter().map(str::to_owned).collect())
            .collect::<Vec<Vec<String>>>()
    };
    let declared = ("a/mod.rs", "mod b;\nmod c;\npub use b::B;\npub use c::C;");
    let b = ("a/b.rs", "use super::C;\npub struct B(C);");
    assert!(circles(&[declared, b, ("a/c.rs", "pub struct C; // crate::a::B")]).is_empty());
    let by_re_export = ("a/c.rs", "pub struct C;\nfn f(_: &crate::a::B) {}");
    assert_eq!(circles(&[declared, b, by_re_export]), [["a/b.rs", "a/c.rs"]]);
    let by_module = ("a/c.rs", "use super::b;\npub struct C;\nfn f(_: &b::B) {}");
    assert_eq!(circles(&[declared, b, by_module]), [["a/b.rs", "a/c.rs"]]);
    let by_test = ("a/c.rs", "pub struct C;\n#[cfg(test)]\nmod tests { use crate::a::B; }");
    assert!(circles(&[declared, b, by_test]).is_empty());
    let parent = ("a/mod.rs", "mod b;\nuse b::B;\npub struct A(B);");
    assert!(circles(&[parent, ("a/b.rs", "pub struct B;")]).is_empty());
    assert_eq!(circles(&[parent, ("a/b.rs", "use super::A;\npub struct B;")]), [["a/b.rs", "a/mod.rs"]]);
}
