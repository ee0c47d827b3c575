//! Warnings, gathered so that each kind becomes one line with the names it concerns.

use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::text;

/// Kinds listed before a line says how many more there are.
const KINDS_SHOWN: usize = 20;
/// Names listed in full before a line says "and N more".
const NAMES_SHOWN: usize = 6;
/// Characters of names after which none is added to a list.
const NAMES_LENGTH: usize = 300;
/// Most characters of a kind.
const KIND_LENGTH: usize = 300;

/// Warnings by kind, in the order in which the kinds first came up; of what is not going to be shown it keeps hashes.
#[derive(Debug, Default)]
pub(super) struct Notes {
    kinds: Vec<Kind>,
    /// Index in `kinds` of each kind that is shown, by hash; `None` of the others.
    known: HashMap<u64, Option<usize>>,
}

#[derive(Debug)]
struct Kind {
    text: String,
    /// The names that are shown, and the number of their characters.
    shown: Vec<String>,
    length: usize,
    /// Hashes of all names.
    names: HashSet<u64>,
}

impl Notes {
    /// Notes that `kind` concerns `name`.
    pub fn add(&mut self, kind: impl AsRef<str>, name: impl AsRef<str>) {
        let kinds = &mut self.kinds;
        let place = self.known.entry(hash(kind.as_ref())).or_insert_with(|| {
            (kinds.len() < KINDS_SHOWN).then(|| {
                kinds.push(Kind::new(kind.as_ref()));
                kinds.len() - 1
            })
        });
        if let Some(kind) = place.and_then(|index| kinds.get_mut(index)) {
            kind.add(name.as_ref());
        }
    }

    /// One line per kind, each with `file` in front.
    pub fn into_lines(self, file: &str) -> Vec<String> {
        let file = text::quoted(file);
        let more = self.known.len() - self.kinds.len();
        let mut lines: Vec<String> = self.kinds.iter().map(|kind| format!("{file}: {kind}")).collect();
        if more > 0 {
            lines.push(format!("{file}: and {more} more kinds of warnings"));
        }
        lines
    }
}

impl Kind {
    fn new(text: &str) -> Self {
        let text = text::cut(text, KIND_LENGTH).into_owned();
        Self { text, shown: Vec::new(), length: 0, names: HashSet::new() }
    }

    fn add(&mut self, name: &str) {
        let is_new = self.names.insert(hash(name));
        if is_new && self.shown.len() < NAMES_SHOWN && self.length < NAMES_LENGTH {
            let name = text::quoted(name).into_owned();
            self.length += name.chars().count();
            self.shown.push(name);
        }
    }
}

impl std::fmt::Display for Kind {
    /// `kind: a, b, c and 4 more`.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}: {}", self.text, self.shown.join(", "))?;
        match self.names.len() - self.shown.len() {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}

fn hash(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_one_line_and_long_lists_are_cut() {
        let mut notes = Notes::default();
        for i in 0..9 {
            notes.add("texture ignored", format!("m{i}"));
            notes.add("texture ignored", "m0");
        }
        notes.add("animation ignored", "walk");
        assert_eq!(
            notes.into_lines("a.glb"),
            ["a.glb: texture ignored: m0, m1, m2, m3, m4, m5 and 3 more", "a.glb: animation ignored: walk"]
        );
    }

    #[test]
    fn of_many_kinds_the_first_are_shown_and_the_others_counted() {
        let mut notes = Notes::default();
        for i in 0..100_000 {
            notes.add(format!("`k{i}` is ignored, in material"), "a");
        }
        let lines = notes.into_lines("a.mtl");
        assert_eq!(lines.len(), KINDS_SHOWN + 1);
        assert_eq!(lines[1], "a.mtl: `k1` is ignored, in material: a");
        assert_eq!(lines[KINDS_SHOWN], "a.mtl: and 99980 more kinds of warnings");
    }

    #[test]
    fn long_names_and_control_characters_are_not_repeated() {
        let mut notes = Notes::default();
        for i in 0..5 {
            notes.add("ignored", format!("{i}\u{1b}{}", "a".repeat(1_000_000)));
        }
        let lines = notes.into_lines(&"path".repeat(1000));
        assert!(lines[0].ends_with(" and 3 more"), "{}", lines[0]);
        assert!(lines[0].contains("0\\u{1b}aaa") && lines[0].chars().count() < 900, "{}", lines[0]);
    }
}
