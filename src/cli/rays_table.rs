//! Tables of rays: a CSV file with a ray per row.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use csv::ByteRecord;
use glam::DVec3;

use super::failure::Failure;
use super::table::{TableHeader, cell};
use crate::spacetime::{Entry, LISTED, Listed, Parameter, SPACETIMES, SpacetimeKind};
use crate::study::free::{Cells, TableForm};

/// Reads `--spacetime`: a name from the table of all, or of those whose holes are in the rows.
pub(super) fn spacetime() -> impl TypedValueParser<Value = &'static Entry> {
    let in_rows = LISTED.iter().filter(|entry| entry.listed == Some(Listed::Holes));
    let entries = SPACETIMES.iter().chain(in_rows).copied();
    let value = |entry: &'static Entry| PossibleValue::new(entry.name).help(entry.summary);
    let names = PossibleValuesParser::new(entries.map(value));
    names.try_map(|name| Entry::named(&name).ok_or("not a spacetime"))
}

/// Parameters of the spacetime of a table's rows.
#[derive(Clone)]
pub(super) struct Parameters {
    entry: &'static Entry,
    sources: Vec<ParameterSource>,
}

/// Source of a parameter's values.
#[derive(Clone, Copy)]
enum ParameterSource {
    /// A column: its name and place, and the value where it has 1.
    Column(&'static str, usize, f64),
    /// The value of a parameter whose column is not there.
    Constant(f64),
}

impl Parameters {
    /// Finds the columns; `others` are needed as well, and named where one is missing.
    pub(super) fn find(
        header: &TableHeader,
        entry: &'static Entry,
        others: &[&'static str],
    ) -> Result<Self, Failure> {
        let mut needed = Vec::new();
        for parameter in entry.parameters {
            if parameter.in_tables.is_none() || header.place(parameter.column)?.is_some() {
                needed.push(parameter.column);
            }
        }
        needed.extend(others);
        let places = header.all(&needed)?;
        let source = |parameter: &Parameter| {
            let found = places.iter().find(|(name, _)| *name == parameter.column);
            found
                .map(|&(name, place)| ParameterSource::Column(name, place, parameter.per_column))
                .or(parameter.in_tables.map(ParameterSource::Constant))
        };
        Ok(Self { entry, sources: entry.parameters.iter().filter_map(source).collect() })
    }

    /// Name of the spacetime.
    pub(super) fn name(&self) -> &'static str {
        self.entry.name
    }

    /// Columns that there are.
    pub(super) fn places(&self) -> impl Iterator<Item = (&'static str, usize)> {
        self.sources.iter().filter_map(|source| match *source {
            ParameterSource::Column(name, place, _) => Some((name, place)),
            ParameterSource::Constant(_) => None,
        })
    }

    /// The spacetime of a row, about the origin.
    pub(super) fn of(&self, header: &TableHeader, row: &ByteRecord) -> Result<SpacetimeKind, Failure> {
        let value = |source: &ParameterSource| match *source {
            ParameterSource::Column(name, place, unit) => Ok(unit * header.number(row, name, place)?),
            ParameterSource::Constant(value) => Ok(value),
        };
        let values: Result<Vec<f64>, Failure> = self.sources.iter().map(value).collect();
        Ok(self.entry.with(DVec3::ZERO, &values?))
    }
}

/// Columns that are copied where there are any.
const LABELS: [&str; 2] = ["id", "kind"];
/// Which columns of a table are read, and where they are.
pub(super) struct RayColumns {
    pub(super) header: TableHeader,
    pub(super) spacetime: Parameters,
    pub(super) form: &'static TableForm,
    /// Those that are copied: labels, then numbers.
    all: Vec<(&'static str, usize)>,
    /// Places of the columns that describe a ray: [`TableForm::needed`], and [`TableForm::optional`] where there are any.
    needed: Vec<(&'static str, usize)>,
    optional: Vec<(&'static str, Option<usize>)>,
}

impl RayColumns {
    pub(super) fn find(header: &TableHeader, spacetime: &'static Entry) -> Result<Self, Failure> {
        let form = TableForm::of(spacetime);
        let mut all = Vec::new();
        for label in LABELS {
            all.extend(header.place(label)?.map(|place| (label, place)));
        }
        let spacetime = Parameters::find(header, spacetime, form.needed)?;
        let needed = header.all(form.needed)?;
        let optional = form.optional.iter().map(|&name| Ok((name, header.place(name)?)));
        let optional = optional.collect::<Result<Vec<_>, Failure>>()?;
        all.extend(spacetime.places());
        all.extend(&needed);
        all.extend(optional.iter().filter_map(|&(name, place)| Some((name, place?))));
        Ok(Self { header: header.clone(), spacetime, form, all, needed, optional })
    }

    /// Names of the columns that are copied.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.all.iter().map(|(name, _)| *name)
    }

    /// The cells that are copied.
    pub(super) fn inputs<'a>(&self, row: &'a ByteRecord) -> impl Iterator<Item = &'a [u8]> {
        self.all.iter().map(|&(_, place)| cell(row, place))
    }

    /// The ray of a row.
    pub(super) fn ray(&self, row: &ByteRecord) -> Result<(SpacetimeKind, Cells), Failure> {
        let spacetime = self.spacetime.of(&self.header, row)?;
        let needed: Result<Vec<f64>, Failure> =
            self.needed.iter().map(|&(name, place)| self.header.number(row, name, place)).collect();
        let optional: Result<Vec<Option<f64>>, Failure> =
            self.optional.iter().map(|&(name, place)| self.header.maybe(row, name, place)).collect();
        Ok((spacetime, Cells { needed: needed?, optional: optional? }))
    }
}
