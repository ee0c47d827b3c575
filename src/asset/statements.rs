//! Statements of OBJ and MTL files as people have them: lines that end with LF, CR LF or CR and go on after a
//! backslash, a byte order mark, comments, text in whatever encoding. No file is held in memory.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use super::error::AssetError;
use super::files::Files;

/// Bytes read from disk at once.
const CHUNK: usize = 1 << 18;
/// Byte order marks.
const UTF8: [u8; 3] = [0xef, 0xbb, 0xbf];
const UTF16: [[u8; 2]; 2] = [[0xff, 0xfe], [0xfe, 0xff]];

/// Reads a file statement by statement; what is not UTF-8 is replaced.
pub(super) struct Statements<R> {
    inner: R,
    /// The last line read, without its end.
    line: Vec<u8>,
    /// Its number, from 1.
    number: usize,
    /// True if it ended with a CR, to which an LF may belong.
    ended_with_cr: bool,
    /// The last statement.
    text: String,
}

/// A keyword and what follows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Statement<'a> {
    /// Number of the line on which it begins, from 1.
    pub line: usize,
    /// First word.
    pub keyword: &'a str,
    /// All after the keyword, where a `#` may be part of a name.
    pub name: &'a str,
}

impl Statements<BufReader<File>> {
    /// Opens a file.
    pub fn open(path: &Path, files: &Files) -> Result<Self, AssetError> {
        let file = files.open(path).map_err(|source| AssetError::Read { path: path.to_owned(), source })?;
        Ok(Self::new(BufReader::with_capacity(CHUNK, file)))
    }
}

impl<R: BufRead> Statements<R> {
    /// The statements of what `inner` gives.
    pub fn new(inner: R) -> Self {
        Self { inner, line: Vec::new(), number: 0, ended_with_cr: false, text: String::new() }
    }

    /// The next statement; comments and empty lines are none.
    ///
    /// # Errors
    /// Errors of the operating system, or [`io::ErrorKind::InvalidData`] if the text is UTF-16.
    pub fn next(&mut self) -> io::Result<Option<Statement<'_>>> {
        let mut first;
        loop {
            if !self.next_line()? {
                return Ok(None);
            }
            first = self.number;
            self.text.clear();
            while self.take_line() && self.next_line()? {}
            if !matches!(self.text.trim_start().bytes().next(), None | Some(b'#')) {
                break;
            }
        }
        let text = self.text.trim();
        let (keyword, name) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        Ok(Some(Statement { line: first, keyword, name: name.trim_start() }))
    }

    /// Adds the line to the statement; whether the statement goes on in the next one.
    fn take_line(&mut self) -> bool {
        let start = self.text.len();
        self.text.push_str(&String::from_utf8_lossy(&self.line));
        let added = self.text.get(start..).unwrap_or_default();
        // A folder's name may end a comment.
        match added.trim_end().strip_suffix('\\').filter(|added| comment(added).is_none()) {
            None => false,
            Some(kept) => {
                let end = start + kept.len();
                self.text.truncate(end);
                self.text.push(' ');
                true
            }
        }
    }

    /// Reads a line; whether there was one.
    fn next_line(&mut self) -> io::Result<bool> {
        self.line.clear();
        loop {
            let buffer = match self.inner.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                buffer => buffer?,
            };
            let skipped =
                usize::from(std::mem::take(&mut self.ended_with_cr) && buffer.first() == Some(&b'\n'));
            let rest = buffer.get(skipped..).unwrap_or_default();
            let end = memchr::memchr2(b'\n', b'\r', rest);
            self.line.extend_from_slice(rest.get(..end.unwrap_or(rest.len())).unwrap_or_default());
            self.ended_with_cr = end.is_some_and(|end| rest.get(end) == Some(&b'\r'));
            let (read, is_end_of_file) = (skipped + end.map_or(rest.len(), |end| end + 1), buffer.is_empty());
            self.inner.consume(read);
            if end.is_some() || (is_end_of_file && !self.line.is_empty()) {
                break;
            }
            if is_end_of_file {
                return Ok(false);
            }
        }
        if self.number == 0 {
            self.strip_mark()?;
        }
        self.number += 1;
        Ok(true)
    }

    fn strip_mark(&mut self) -> io::Result<()> {
        if UTF16.iter().any(|mark| self.line.starts_with(mark)) {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "its text is UTF-16, not UTF-8"));
        }
        if self.line.starts_with(&UTF8) {
            self.line.drain(..UTF8.len());
        }
        Ok(())
    }
}

impl<'a> Statement<'a> {
    /// Text after the keyword, without a comment.
    pub fn values(&self) -> &'a str {
        self.name.get(..comment(self.name).unwrap_or(self.name.len())).unwrap_or_default().trim_end()
    }
}

/// Start of a comment; the `#` of `-1.#IND` and `1.#QNAN`, as Microsoft's library writes numbers, begins none.
fn comment(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let is_number = |at: usize| {
        at.checked_sub(1).and_then(|before| bytes.get(before)) == Some(&b'.')
            && matches!(bytes.get(at + 1), Some(b'I' | b'Q' | b'S' | b'N'))
    };
    text.match_indices('#').map(|(at, _)| at).find(|at| !is_number(*at))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Line, keyword, name and values of each statement.
    fn all(bytes: &[u8]) -> Vec<(usize, String, String, String)> {
        // A reader that gives few bytes at once.
        let mut statements = Statements::new(BufReader::with_capacity(3, bytes));
        let mut all = Vec::new();
        while let Some(statement) = statements.next().unwrap() {
            let texts = [statement.keyword, statement.name, statement.values()].map(str::to_owned);
            let [keyword, name, values] = texts;
            all.push((statement.line, keyword, name, values));
        }
        all
    }

    fn values(bytes: &[u8]) -> Vec<(usize, String)> {
        all(bytes)
            .into_iter()
            .map(|(line, keyword, _, values)| (line, format!("{keyword} {values}")))
            .collect()
    }

    #[test]
    fn lines_end_with_lf_cr_lf_or_cr() {
        let expected = [(1, "v 1".to_owned()), (3, "v 2".to_owned()), (4, "f 3".to_owned())];
        for bytes in [
            "v 1\n\nv 2\nf 3",
            "v 1\r\n\r\nv 2\r\nf 3\r\n",
            "v 1\r\rv 2\rf 3\r",
            "\u{feff}v 1\n\r\n v 2 \r\tf  3",
        ] {
            assert_eq!(values(bytes.as_bytes()), expected, "{bytes:?}");
        }
    }

    #[test]
    fn a_statement_goes_on_after_a_backslash() {
        for end in ["\n", "\r\n", "\r", " \n"] {
            let text = format!("f 1 2 \\{end} 3\\{end}\\{end}4\nv 1");
            assert_eq!(values(text.as_bytes()), [(1, "f 1 2   3  4".into()), (5, "v 1".into())], "{end:?}");
        }
        assert_eq!(values(b"f 1 \\"), [(1, "f 1".into())]);
        assert_eq!(
            values(b"# from C:\\models\\\nv 1 # in C:\\\nv 2"),
            [(2, "v 1".into()), (3, "v 2".into())]
        );
    }

    #[test]
    fn comments_end_values_but_not_names_and_numbers() {
        let read = all(b"usemtl Material #25 \nv 1 2 3#end\nvt -1.#IND 1.#QNAN # odd\n  # f\n#f");
        let [name, vertex, coordinate] = read.as_slice() else { panic!("{read:?}") };
        assert_eq!((name.2.as_str(), name.3.as_str()), ("Material #25", "Material"));
        assert_eq!(vertex.3, "1 2 3");
        assert_eq!(coordinate.3, "-1.#IND 1.#QNAN");
    }

    #[test]
    fn what_is_not_utf8_is_replaced_and_utf16_is_said() {
        assert_eq!(values(b"o caf\xe9\r\n"), [(1, "o caf\u{fffd}".into())]);
        let error = Statements::new(&b"\xff\xfev\0"[..]).next().unwrap_err();
        assert!(error.to_string().contains("UTF-16"), "{error}");
    }

    #[test]
    fn many_continued_lines_take_time_in_proportion() {
        let text = format!("f{}", " 1 \\\n".repeat(300_000));
        assert_eq!(values(text.as_bytes())[0].1.split_whitespace().count(), 300_001);
    }
}
