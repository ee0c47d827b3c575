//! Tables of rays: a CSV file with a ray per row.

use clap::ValueEnum;
use csv::ByteRecord;
use glam::DVec3;

use super::failure::Failure;
use super::table::Header;
use crate::scene::SpacetimeKind;
use crate::study::free::{Fault, FreeRay, Input};

/// A spacetime by its name; what describes it is in the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Spacetime {
    /// A hole of Schwarzschild radius `rs` at the origin; isotropic coordinates
    Schwarzschild,
    /// No hole: straight rays
    Flat,
}

impl Spacetime {
    /// Columns that describe it.
    fn parameters(self) -> &'static [&'static str] {
        match self {
            Spacetime::Schwarzschild => &["rs"],
            Spacetime::Flat => &[],
        }
    }

    /// The spacetime of a row, given the numbers in these columns.
    fn of(self, parameters: &[f64]) -> SpacetimeKind {
        match (self, parameters) {
            (Spacetime::Schwarzschild, &[schwarzschild_radius, ..]) => {
                SpacetimeKind::Schwarzschild { center: DVec3::ZERO, schwarzschild_radius }
            }
            _ => SpacetimeKind::Flat,
        }
    }
}

/// Columns that are copied where there are any.
const LABELS: [&str; 2] = ["id", "kind"];
/// Columns that describe a ray.
const RAY: [&str; 7] = ["x0", "y0", "z0", "dx0", "dy0", "dz0", "r_out"];

/// Which columns of a table are read, and where they are.
pub(super) struct Columns {
    pub(super) header: Header,
    pub(super) spacetime: Spacetime,
    /// Those that are copied: labels, then numbers.
    all: Vec<(&'static str, usize)>,
    /// How many are labels.
    labels: usize,
}

impl Columns {
    pub(super) fn find(header: &Header, spacetime: Spacetime) -> Result<Self, Failure> {
        let mut all = Vec::new();
        for label in LABELS {
            all.extend(header.place(label)?.map(|place| (label, place)));
        }
        let labels = all.len();
        let needed: Vec<&str> = spacetime.parameters().iter().chain(&RAY).copied().collect();
        all.extend(header.all(&needed)?);
        Ok(Self { header: header.clone(), spacetime, all, labels })
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
        let mut numbers = Vec::with_capacity(self.all.len());
        for &(name, place) in &self.all[self.labels..] {
            numbers.push(self.header.number(row, name, place)?);
        }
        let (parameters, ray) = numbers.split_at(self.spacetime.parameters().len());
        let ray = FreeRay {
            start: DVec3::from_slice(&ray[0..3]),
            direction: DVec3::from_slice(&ray[3..6]),
            r_out: ray[6],
        };
        Ok((self.spacetime.of(parameters), ray))
    }

    /// Why the ray in a line cannot be followed.
    pub(super) fn refuse(&self, line: u64, fault: &Fault) -> Failure {
        let column = match fault.input {
            Input::SchwarzschildRadius => "column `rs`",
            Input::Start => "columns `x0`, `y0`, `z0`",
            Input::Direction => "columns `dx0`, `dy0`, `dz0`",
            Input::Sphere => "column `r_out`",
            Input::Stepper => "--stepper",
        };
        self.header.at(line, column, &fault.cause).help(&fault.remedy)
    }
}
