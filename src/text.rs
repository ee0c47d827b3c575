//! Text in messages: control characters of files are shown, not sent to the terminal, long lines are cut, and bytes are
//! counted in binary multiples.

use std::borrow::Cow;

/// Most characters of a name, a path or a statement of a file in a message.
const QUOTED: usize = 200;
/// Most characters of a line of a message.
const LINE: usize = 900;

/// Binary multiple of a byte: `1.50 GiB`.
pub fn bytes(count: u64) -> String {
    const PREFIXES: [&str; 7] = ["", "Ki", "Mi", "Gi", "Ti", "Pi", "Ei"];
    let power = count.checked_ilog2().unwrap_or(0) / 10;
    if power == 0 {
        return format!("{count} B");
    }
    format!("{:.2} {}B", count as f64 / (1u64 << (10 * power)) as f64, PREFIXES[power as usize])
}

/// A name, a path or a statement as a message quotes it: one line of at most 200 characters.
pub fn quoted(text: &str) -> Cow<'_, str> {
    cut(text, QUOTED)
}

/// A message of one line: at most 900 characters, line ends are shown as `\n`.
pub fn line(text: &str) -> Cow<'_, str> {
    cut(text, LINE)
}

/// A message of several lines, each at most 900 characters long.
pub fn lines(text: &str) -> String {
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// At most `most` characters of a text, control characters shown as in Rust; a longer text loses its middle.
pub fn cut(text: &str, most: usize) -> Cow<'_, str> {
    if text.len() <= most && !text.contains(is_control) {
        return Cow::Borrowed(text);
    }
    let start: String = text.chars().flat_map(shown).take(most + 1).collect();
    if start.chars().count() <= most {
        return Cow::Owned(start);
    }
    let side = most.saturating_sub(1) / 2;
    let from = text.char_indices().rev().nth(side.saturating_sub(1)).map_or(0, |(at, _)| at);
    let end: Vec<char> = text.get(from..).unwrap_or_default().chars().flat_map(shown).collect();
    let end = end.get(end.len().saturating_sub(side)..).unwrap_or_default();
    Cow::Owned(start.chars().take(side).chain(std::iter::once('…')).chain(end.iter().copied()).collect())
}

/// A character as it is shown.
pub fn shown(c: char) -> impl Iterator<Item = char> {
    let escaped = is_control(c).then(|| c.escape_default());
    let plain = escaped.is_none().then_some(c);
    plain.into_iter().chain(escaped.into_iter().flatten())
}

/// True if a character moves the cursor, ends a line, changes the direction of writing or commands a terminal.
///
/// All of them are below U+10000.
pub fn is_control(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown() {
        assert_eq!(quoted("owned\u{1b}[2J\u{7}"), "owned\\u{1b}[2J\\u{7}");
        assert_eq!(line("a\nb\tc\r"), "a\\nb\\tc\\r");
        assert_eq!(line("\u{9b}1m \u{7f} \u{202e}txt \u{2028}"), "\\u{9b}1m \\u{7f} \\u{202e}txt \\u{2028}");
        assert_eq!(line("Café – 黒い穴 \u{1f573}"), "Café – 黒い穴 \u{1f573}");
        assert_eq!(lines("a\u{1b}\nb"), "a\\u{1b}\nb");
    }

    #[test]
    fn long_lines_lose_their_middle() {
        let long = format!("start{}end", "é".repeat(1_000_000));
        let shown = quoted(&long);
        assert!(shown.starts_with("start") && shown.ends_with("end") && shown.contains('…'), "{shown}");
        assert!(shown.chars().count() <= 200);
        assert_eq!(quoted(&"a".repeat(200)), "a".repeat(200));
        let escapes = "\u{1b}".repeat(5000);
        assert!(line(&escapes).chars().count() <= 900);
        assert!(lines(&format!("{long}\n{escapes}")).lines().all(|line| line.chars().count() <= 900));
    }
}
