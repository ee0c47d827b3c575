//! Rows of a CSV file as text, written by many threads and put together later.

use crate::study::table::Cell;

/// Rows as text.
#[derive(Default)]
pub(super) struct CsvText(Vec<u8>);

impl CsvText {
    /// Adds a cell of text, in quotes if it needs them.
    pub(super) fn text(&mut self, text: &[u8]) {
        if text.iter().any(|byte| matches!(byte, b',' | b'"' | b'\r' | b'\n')) {
            self.0.push(b'"');
            for &byte in text {
                self.0.extend_from_slice(if byte == b'"' { b"\"\"" } else { std::slice::from_ref(&byte) });
            }
            self.0.push(b'"');
        } else {
            self.0.extend_from_slice(text);
        }
        self.0.push(b',');
    }

    /// Adds a cell.
    pub(super) fn cell(&mut self, cell: Cell) {
        match cell {
            Cell::Empty => {}
            Cell::Number(number) => {
                self.0.extend_from_slice(zmij::Buffer::new().format(number).as_bytes());
            }
            Cell::Integer(number) => self.0.extend_from_slice(number.to_string().as_bytes()),
        }
        self.0.push(b',');
    }

    /// Ends a row, which has cells.
    pub(super) fn end_row(&mut self) {
        self.0.pop();
        self.0.push(b'\n');
    }

    /// All of it.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_read_back_as_they_were_written() {
        let mut text = CsvText::default();
        for label in ["plain", "a, b", "\"quoted\"", "two\nlines", ""] {
            text.text(label.as_bytes());
            [Cell::Number(0.1), Cell::Empty, Cell::Integer(-7)].into_iter().for_each(|cell| text.cell(cell));
            text.end_row();
        }
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.bytes());
        let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 5);
        assert_eq!(rows[1].iter().collect::<Vec<_>>(), ["a, b", "0.1", "", "-7"]);
        assert_eq!(&rows[2][0], "\"quoted\"");
        assert_eq!(&rows[3][0], "two\nlines");
    }
}
