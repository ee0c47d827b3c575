//! Text files in whatever encoding, line by line: what is not UTF-8 is replaced, lines can be left out by their first
//! word, and no file is held in memory.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use crate::asset::error::AssetError;
use crate::asset::files::Files;

/// Bytes read from disk at once.
const CHUNK: usize = 1 << 18;

/// A reader of UTF-8.
pub(super) struct Lossy<R> {
    inner: R,
    line: Vec<u8>,
    /// Bytes of the line that have been read.
    read: usize,
    /// First word of the lines that are left out.
    unwanted: Option<&'static str>,
}

impl Lossy<BufReader<File>> {
    /// Opens a file.
    pub fn open(path: &Path, files: &Files) -> Result<Self, AssetError> {
        let file = files.open(path).map_err(|source| AssetError::Read { path: path.to_owned(), source })?;
        Ok(Self::new(BufReader::with_capacity(CHUNK, file)))
    }
}

impl<R: BufRead> Lossy<R> {
    /// A reader of what `inner` gives.
    pub fn new(inner: R) -> Self {
        Self { inner, line: Vec::new(), read: 0, unwanted: None }
    }

    /// A reader without the lines that begin with a word.
    pub fn without(self, word: &'static str) -> Self {
        Self { unwanted: Some(word), ..self }
    }

    /// Takes the next line; whether it is wanted.
    fn next_line(&mut self) -> io::Result<bool> {
        self.line.clear();
        self.read = 0;
        self.inner.read_until(b'\n', &mut self.line)?;
        let text = String::from_utf8_lossy(&self.line);
        let is_wanted = self.unwanted.is_none_or(|word| text.split_whitespace().next() != Some(word));
        if let Cow::Owned(text) = text {
            self.line = text.into_bytes();
        }
        Ok(is_wanted)
    }
}

impl<R: BufRead> Read for Lossy<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Lossy<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.read == self.line.len() {
            while !self.next_line()? {}
        }
        Ok(&self.line[self.read..])
    }

    fn consume(&mut self, count: usize) {
        self.read += count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_utf8_is_replaced_and_the_rest_stays() {
        let bytes = b"o caf\xe9\r\nv 1\n\nend";
        let lines: Vec<String> = Lossy::new(&bytes[..]).lines().map(Result::unwrap).collect();
        assert_eq!(lines, ["o caf\u{fffd}", "v 1", "", "end"]);
    }

    #[test]
    fn lines_are_left_out_by_their_first_word() {
        let bytes = b"l 1 2\nlong l\n\tl 2\n\nl\nl";
        let lines: Vec<String> = Lossy::new(&bytes[..]).without("l").lines().map(Result::unwrap).collect();
        assert_eq!(lines, ["long l", ""]);
    }
}
