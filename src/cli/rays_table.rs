//! Tables of rays: a CSV file with a ray per row.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use csv::ByteRecord;
use glam::DVec3;

use super::failure::Failure;
use super::table::TableHeader;
use crate::spacetime::{Entry, Parameter, SPACETIMES, SpacetimeKind};
use crate::study::free::FreeRay;

/// Reads `--spacetime`: a name from the table of all.
pub(super) fn spacetime() -> impl TypedValueParser<Value = &'static Entry> {
    let value = |entry: &&Entry| PossibleValue::new(entry.name).help(entry.summary);
    let names = PossibleValuesParser::new(SPACETIMES.iter().map(value));
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
    /// A column: its name and place.
    Column(&'static str, usize),
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
                .map(|&(name, place)| ParameterSource::Column(name, place))
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
            ParameterSource::Column(name, place) => Some((name, place)),
            ParameterSource::Constant(_) => None,
        })
    }

    /// The spacetime of a row, about the origin.
    pub(super) fn of(&self, header: &TableHeader, row: &ByteRecord) -> Result<SpacetimeKind, Failure> {
        let value = |source: &ParameterSource| match *source {
            ParameterSource::Column(name, place) => header.number(row, name, place),
            ParameterSource::Constant(value) => Ok(value),
        };
        let values: Result<Vec<f64>, Failure> = self.sources.iter().map(value).collect();
        Ok(self.entry.with(DVec3::ZERO, &values?))
    }
}

/// Columns that are copied where there are any.
const LABELS: [&str; 2] = ["id", "kind"];
/// Columns that describe a ray.
const RAY: [&str; 7] = ["x0", "y0", "z0", "dx0", "dy0", "dz0", "r_out"];

/// Columns of a table that are read, and their places.
pub(super) struct RayColumns {
    pub(super) header: TableHeader,
    pub(super) spacetime: Parameters,
    /// Those that are copied: labels, then numbers.
    all: Vec<(&'static str, usize)>,
}

impl RayColumns {
    pub(super) fn find(header: &TableHeader, spacetime: &'static Entry) -> Result<Self, Failure> {
        let mut all = Vec::new();
        for label in LABELS {
            all.extend(header.place(label)?.map(|place| (label, place)));
        }
        let spacetime = Parameters::find(header, spacetime, &RAY)?;
        all.extend(spacetime.places());
        all.extend(header.all(&RAY)?);
        Ok(Self { header: header.clone(), spacetime, all })
    }

    /// Names of the columns that are copied.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.all.iter().map(|(name, _)| *name)
    }

    /// The cells that are copied.
    pub(super) fn inputs<'a>(&self, row: &'a ByteRecord) -> impl Iterator<Item = &'a [u8]> {
        self.all.iter().map(|&(_, place)| row.get(place).unwrap_or_default())
    }

    /// The ray of a row.
    pub(super) fn ray(&self, row: &ByteRecord) -> Result<(SpacetimeKind, FreeRay), Failure> {
        let spacetime = self.spacetime.of(&self.header, row)?;
        let mut ray = [0.0; RAY.len()];
        for (number, &(name, place)) in ray.iter_mut().zip(&self.all[self.all.len() - RAY.len()..]) {
            *number = self.header.number(row, name, place)?;
        }
        let ray = FreeRay {
            start: DVec3::from_slice(&ray[0..3]),
            direction: DVec3::from_slice(&ray[3..6]),
            r_out: ray[6],
        };
        Ok((spacetime, ray))
    }
}
