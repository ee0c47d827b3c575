//! Messages of commands on stderr and their output on stdout, fit for a terminal.

use std::fmt::Display;
use std::io::{self, Write};

use serde::Serialize;

use super::failure::Failure;
use crate::scene::{Baked, Settings, flag_name};
use crate::text;

/// Lines on stderr, fit for a terminal; unlike `eprintln!` it does not panic when nobody reads them.
pub(super) fn say(lines: impl Display) {
    let _ = writeln!(io::stderr(), "{}", text::lines(&lines.to_string()));
}

/// Notes that another stepper stands for the one that is set, where the spacetime does not have that.
pub(super) fn note_stepper(scene: &mut Baked) {
    let wanted = scene.settings.stepper;
    let used = wanted.around(&scene.spacetime);
    if used != wanted && wanted != Settings::default().stepper {
        let [used, wanted] = [used, wanted].map(flag_name);
        scene.notes.push(format!("the stepper is {used}: a spacetime of this kind does not have {wanted}"));
    }
}

/// Says what was decided about a scene, and what its files were not understood to the letter for, one line each.
pub(super) fn say_remarks(scene: &Baked) {
    shown(&scene.notes).for_each(|note| say(format!("note: {note}")));
    shown(&scene.warnings).for_each(|warning| say(format!("warning: {warning}")));
}

/// Warnings, each on one line; of very many the first ones and how many more there are.
pub(super) fn shown(warnings: &[String]) -> impl Iterator<Item = String> {
    /// Warnings in full.
    const MOST: usize = 60;
    let more = warnings.len().saturating_sub(MOST);
    let more = (more > 0).then(|| format!("and {more} more warnings"));
    warnings.iter().take(MOST).map(|warning| text::line(warning).into_owned()).chain(more)
}

/// Prints the result of a command on stdout, fit for a terminal.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    write_stdout(&text::lines(text))
}

/// Prints a record on stdout.
pub(super) fn print_json(record: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(record);
    let json = json.map_err(|error| Failure::new(format!("cannot express the result as JSON: {error}")))?;
    write_stdout(&format!("{}\n", escaped(&json)))
}

/// A reader that has gone away, as `head` does, is no failure.
pub(super) fn write_stdout(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// JSON with the control characters that JSON itself lets pass written as escapes.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' => escaped.push(c),
            c if text::is_control(c) => escaped.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped_in_json() {
        assert_eq!(escaped("\"\u{9b}\u{7f}\"\n"), "\"\\u009b\\u007f\"\n");
    }
}
