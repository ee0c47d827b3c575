//! Warnings, gathered so that each kind becomes one line with the names it concerns.

use std::collections::HashSet;

/// Names listed in full before a line says "and N more".
const NAMES_SHOWN: usize = 6;

/// Warnings by kind, in the order in which the kinds first came up.
#[derive(Debug, Default)]
pub(super) struct Notes {
    kinds: Vec<(String, Vec<String>)>,
    seen: HashSet<(String, String)>,
}

impl Notes {
    /// Notes that `kind` concerns `name`.
    pub fn add(&mut self, kind: impl Into<String>, name: impl Into<String>) {
        let (kind, name) = (kind.into(), name.into());
        if !self.seen.insert((kind.clone(), name.clone())) {
            return;
        }
        match self.kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, names)) => names.push(name),
            None => self.kinds.push((kind, vec![name])),
        }
    }

    /// One line per kind, each with `file` in front.
    pub fn into_lines(self, file: &str) -> Vec<String> {
        self.kinds.into_iter().map(|(kind, names)| format!("{file}: {kind}: {}", listed(&names))).collect()
    }
}

/// `a, b, c and 4 more`.
fn listed(names: &[String]) -> String {
    let shown = names.iter().take(NAMES_SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    match names.len().checked_sub(NAMES_SHOWN) {
        None | Some(0) => shown,
        Some(more) => format!("{shown} and {more} more"),
    }
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
}
