//! An OBJ file as `tobj` reads it without stumbling: the vertices, normals and faces of a file that was surveyed, and a
//! group for each section, named by its number.

use std::io::{self, BufRead, Read, Write};

use super::numbers::{finite_numbers, has_usable_weight};
use super::survey::Survey;
use crate::asset::statements::{Statement, Statements};

/// A reader of the cleaned text.
pub(super) struct Cleaned<'a, R> {
    statements: Statements<R>,
    survey: &'a Survey,
    /// Section that begins next.
    section: usize,
    text: Vec<u8>,
    /// Bytes of the text that have been read.
    read: usize,
}

impl<'a, R: BufRead> Cleaned<'a, R> {
    /// Reads the file whose survey is given.
    pub fn new(statements: Statements<R>, survey: &'a Survey) -> Self {
        Self { statements, survey, section: 1, text: b"g 0\n".to_vec(), read: 0 }
    }
}

/// Writes the statement if it is wanted.
fn write(text: &mut Vec<u8>, statement: &Statement, survey: &Survey, section: &mut usize) -> io::Result<()> {
    let values = statement.values();
    match statement.keyword {
        "v" if survey.has_long_vertices => writeln!(text, "v {}", place(values)),
        "vn" if survey.has_odd_normals && finite_numbers::<3>(values).is_none() => writeln!(text, "vn 0 0 0"),
        "vt" if survey.reads_textures() => {
            let [u, v] = finite_numbers(values).unwrap_or_default();
            writeln!(text, "vt {u} {v}")
        }
        keyword @ ("v" | "vn" | "f") => {
            text.extend_from_slice(keyword.as_bytes());
            text.push(b' ');
            text.extend_from_slice(values.as_bytes());
            text.push(b'\n');
            Ok(())
        }
        _ if survey.sections.get(*section).is_some_and(|next| next.line == statement.line) => {
            writeln!(text, "g {section}")?;
            *section += 1;
            Ok(())
        }
        _ => Ok(()),
    }
}

/// The coordinates of a vertex and its weight, by which `tobj` divides them, without a colour.
fn place(values: &str) -> String {
    let words: Vec<&str> = values.split_whitespace().take(5).collect();
    let kept = if has_usable_weight(&words) { 4 } else { 3 };
    words.get(..kept).unwrap_or(&words).join(" ")
}

impl<R: BufRead> Read for Cleaned<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Cleaned<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.read == self.text.len() {
            self.text.clear();
            self.read = 0;
            match self.statements.next()? {
                Some(statement) => write(&mut self.text, &statement, self.survey, &mut self.section)?,
                None => break,
            }
        }
        Ok(self.text.get(self.read..).unwrap_or_default())
    }

    fn consume(&mut self, count: usize) {
        self.read += count;
    }
}
