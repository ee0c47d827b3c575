//! What `tobj` does not check, line by line: it says what is wrong with a file but not where, and computes with any
//! index that it is given.

use std::io::{self, BufRead};

use crate::asset::error::Flaw;

/// Positions, texture coordinates and normals.
const KEYWORDS: [&str; 3] = ["v", "vt", "vn"];
const NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// A file as far as it has been read.
#[derive(Debug, Default)]
pub(super) struct Checked {
    /// How many positions, texture coordinates and normals there are.
    counts: [i64; 3],
    /// The largest index of each, and its line.
    largest: [(i64, usize); 3],
    /// Corners of faces, and how many of them have a normal.
    corners: usize,
    with_normal: usize,
    /// Line elements.
    pub edges: usize,
}

/// Reads a file to its end; the inner error is what is wrong with it, and where.
pub(super) fn check(mut file: impl BufRead) -> io::Result<Result<Checked, Flaw>> {
    let (mut checked, mut line, mut number) = (Checked::default(), String::new(), 0);
    while file.read_line(&mut line)? > 0 {
        number += 1;
        if let Err(flaw) = checked.line(&line, number) {
            return Ok(Err(flaw.at(format!("line {number}"))));
        }
        line.clear();
    }
    Ok(checked.finish())
}

impl Checked {
    /// Whether there are normals, and corners without one.
    pub fn has_partial_normals(&self) -> bool {
        self.counts[2] > 0 && self.with_normal < self.corners
    }

    fn line(&mut self, line: &str, number: usize) -> Result<(), Flaw> {
        let mut words = line.split_whitespace();
        let word = words.next().unwrap_or_default();
        if let Some(column) = KEYWORDS.iter().position(|known| *known == word) {
            self.counts[column] += 1;
            return words.try_for_each(|word| check_number(word, NAMES[column]));
        }
        self.edges += usize::from(word == "l");
        if word == "f" {
            return words.try_for_each(|corner| self.corner(corner, number));
        }
        Ok(())
    }

    /// Checks a face corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, as far as can be known before the end of the file.
    fn corner(&mut self, corner: &str, number: usize) -> Result<(), Flaw> {
        let malformed = || {
            Flaw::new(
                format!("`{corner}` is not a face corner"),
                "write corners as v, v/vt, v//vn or v/vt/vn",
            )
        };
        self.corners += 1;
        for (column, word) in corner.split('/').enumerate() {
            if word.is_empty() && column > 0 {
                continue;
            }
            let index: i64 = word.parse().map_err(|_| malformed())?;
            let before = *self.counts.get(column).ok_or_else(malformed)?;
            if index == 0 || index < -before {
                return Err(out_of_range(column, index, before));
            }
            self.largest[column] = self.largest[column].max((index, number));
            self.with_normal += usize::from(column == 2);
        }
        Ok(())
    }

    fn finish(self) -> Result<Self, Flaw> {
        for (column, (&(index, number), &count)) in self.largest.iter().zip(&self.counts).enumerate() {
            if index > count {
                return Err(out_of_range(column, index, count).at(format!("line {number}")));
            }
        }
        Ok(self)
    }
}

fn out_of_range(column: usize, index: i64, count: i64) -> Flaw {
    let name = NAMES[column];
    let known = if index > 0 { "the file has" } else { "before it are" };
    Flaw::new(
        format!("{name} index {index} is out of range: {known} {count}"),
        "indices count from 1, or backwards from -1; the file is damaged or cut off",
    )
}

fn check_number(word: &str, what: &str) -> Result<(), Flaw> {
    let number: f32 = word.parse().map_err(|_| {
        Flaw::new(format!("`{word}` is not a number"), "write the coordinates as decimal numbers")
    })?;
    // A normal that is not finite is repaired later; exporters write them for degenerate faces.
    if number.is_finite() || what != NAMES[0] {
        return Ok(());
    }
    Err(Flaw::new(
        format!("the {what} is not finite: `{word}`"),
        "fix the vertex in the modelling program and export again",
    ))
}
