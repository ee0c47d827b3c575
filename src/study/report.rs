//! Reports of studies: what is printed, the rows behind it, and their diagrams.

use clap::ValueEnum;

use super::table::Table;
use crate::plot::{Figure, Style};

/// All that a study says.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Tables for people, in Markdown.
    pub text: String,
    /// A row for each setting, for programs.
    pub table: Table,
    /// Diagrams.
    pub figure: Figure,
}

/// The style of a value of a flag, whatever other values are drawn.
pub(super) fn style_of<T: ValueEnum + PartialEq>(value: &T) -> Style {
    Style::nth(T::value_variants().iter().position(|other| other == value).unwrap_or(0))
}
