//! Tables of results: rows of named cells, printed as Markdown or written as CSV.

use std::io::{self, Write};

use super::errors::{Part, Spread};
use super::estimate::Estimate;

/// Text of a printed cell without a value.
pub const NONE: &str = "–";

/// The cell of a number, which reads back exactly.
pub fn number_cell(number: f64) -> String {
    zmij::Buffer::new().format(number).to_owned()
}

/// Cell of a result, as programs read it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// Nothing in it.
    Empty,
    /// Number, which reads back exactly.
    Number(f64),
    /// Whole number.
    Integer(i64),
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.map_or(Self::Empty, Self::Number)
    }
}

/// A row: the name of each column and the cell in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableRow(Vec<(String, String)>);

impl TableRow {
    /// Adds a cell.
    #[must_use]
    pub fn cell(mut self, column: impl Into<String>, cell: impl ToString) -> Self {
        self.0.push((column.into(), cell.to_string()));
        self
    }

    /// Adds a cell that is empty without a value.
    #[must_use]
    pub fn maybe(self, column: impl Into<String>, cell: Option<impl ToString>) -> Self {
        self.cell(column, cell.map_or_else(String::new, |cell| cell.to_string()))
    }

    /// Adds cells for some `parts` of a spread, empty without one.
    #[must_use]
    pub fn spread(self, column: &str, spread: Option<Spread>, parts: [Part; 3]) -> Self {
        parts.into_iter().fold(self, |row, (name, value)| {
            row.maybe(format!("{column}_{name}"), spread.as_ref().map(value))
        })
    }

    /// Adds a cell for a value and one for its standard error.
    #[must_use]
    pub fn estimate(self, column: &str, estimate: Option<Estimate>) -> Self {
        self.maybe(column, estimate.map(|estimate| estimate.value))
            .maybe(format!("{column}_error"), estimate.and_then(|estimate| estimate.error))
    }
}

/// Rows with the same columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(Vec<TableRow>);

impl Table {
    /// A table of `rows`, of which the first one names the columns.
    pub fn of(rows: impl IntoIterator<Item = TableRow>) -> Self {
        Self(rows.into_iter().collect())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.0.len()
    }

    /// The names of the columns, then the cells of each row.
    fn lines(&self) -> impl Iterator<Item = Vec<&str>> {
        let names = self.0.first().map(|row| row.0.iter().map(|(name, _)| name.as_str()).collect());
        let cells = self.0.iter().map(|row| row.0.iter().map(|(_, cell)| cell.as_str()).collect());
        names.into_iter().chain(cells)
    }

    /// The table in Markdown, its columns aligned to the right.
    pub fn markdown(&self) -> String {
        let lines: Vec<Vec<&str>> = self.lines().collect();
        let columns = lines.first().map_or(0, Vec::len);
        let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let framed = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let aligned = |line: &Vec<&str>| {
            framed(line.iter().zip(&widths).map(|(cell, &width)| format!("{cell:>width$}")).collect())
        };
        let mut text: Vec<String> = lines.iter().map(aligned).collect();
        let rule = framed(widths.iter().map(|&width| format!("{}:", "-".repeat(width - 1))).collect());
        text.insert(text.len().min(1), rule);
        text.concat()
    }

    /// Writes the table as CSV.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(out);
        self.lines().try_for_each(|line| writer.write_record(line)).map_err(io_error)?;
        writer.flush()
    }
}

/// The error of the file, of its own kind and not of "other", as which `From` would have it.
pub fn io_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

/// A share in percent.
pub fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// A value with so many digits after the first one.
pub fn scientific(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| NONE.to_owned(), |value| format!("{value:.digits$e}"))
}

/// `0.6703 ± 0.0052`: two digits of the error, or three of a value without one.
pub fn with_error(estimate: Option<Estimate>) -> String {
    let Some(Estimate { value, error }) = estimate else { return NONE.to_owned() };
    let decimals =
        |number: f64, digits: f64| (digits - 1.0 - libm::log10(number.abs()).floor()).clamp(0.0, 9.0);
    match error {
        Some(error) if error > 0.0 => {
            let decimals = decimals(error, 2.0) as usize;
            format!("{value:.decimals$} ± {error:.decimals$}")
        }
        _ => format!("{value:.0$}", decimals(value, 3.0) as usize),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_digits_that_their_errors_leave() {
        let text = |value, error| with_error(Some(Estimate { value, error }));
        assert_eq!(text(0.670_34, Some(0.005_21)), "0.6703 ± 0.0052");
        assert_eq!(text(1234.5, Some(120.0)), "1234 ± 120");
        assert_eq!(text(12.345, None), "12.3");
        assert_eq!(text(1.0, Some(0.0)), "1.00");
        assert_eq!(with_error(None), "–");
    }

    #[test]
    fn a_table_reads_the_same_in_markdown_and_csv() {
        let row = |name: &str, value| TableRow::default().cell("name", name).maybe("value", value);
        let table = Table::of([row("a, b", Some(0.5)), row("c", None)]);
        assert_eq!(
            table.markdown(),
            "| name | value |\n| ---: | ----: |\n| a, b |   0.5 |\n|    c |       |\n"
        );
        let mut csv = Vec::new();
        table.write_csv(&mut csv).unwrap();
        assert_eq!(String::from_utf8(csv).unwrap(), "name,value\n\"a, b\",0.5\nc,\n");
    }
}
