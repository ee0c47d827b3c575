//! `warpfront connect`.

use std::collections::HashMap;

use csv::ByteRecord;
use glam::DVec3;

use super::args::ConnectArgs;
use super::completion::Completion;
use super::csv_text::CsvText;
use super::failure::Failure;
use super::rays_table::Parameters;
use super::rowwise::{RowWise, Setup};
use super::table::{TableHeader, cell, line};
use super::units::{decimal, plural};
use crate::spacetime::Entry;
use crate::study::join::{JoinForm, Joints, LensCache, POINTS, PointPair};

/// Finds the rays that join the points of every pair of a table.
pub(super) fn run(args: &ConnectArgs) -> Result<Completion, Failure> {
    let setup = Setup {
        input: &args.pairs,
        what: ["pair of points", "pairs"],
        output: args.output.as_deref(),
        threads: args.threads,
        progress: args.meter.progress,
        strict: args.strict,
    };
    setup.run(|header| ConnectJob::new(header, args.spacetime, args.max_winding))
}

/// A pair of points and its label.
struct Task {
    label: Vec<u8>,
    pair: PointPair,
}

/// Counts of pairs and connections so far.
#[derive(Default)]
struct ConnectionCounts {
    pairs: usize,
    connections: usize,
    hidden: usize,
}

struct ConnectJob {
    form: &'static JoinForm,
    lenses: LensCache,
    max_winding: u32,
    header: TableHeader,
    spacetime: Parameters,
    /// Columns of labels, if there are any, and of inputs.
    pair: Option<usize>,
    kind: Option<usize>,
    points: Vec<(&'static str, usize)>,
    optional: Vec<(&'static str, Option<usize>)>,
    /// Line and inputs of the labels that have been met.
    met: HashMap<Vec<u8>, (u64, PointPair)>,
    /// Rows read.
    rows: u64,
    counts: ConnectionCounts,
}

impl ConnectJob {
    fn new(header: &TableHeader, spacetime: &'static Entry, max_winding: u32) -> Result<Self, Failure> {
        let form = JoinForm::of(spacetime);
        let optional = form.optional.iter().map(|&name| Ok((name, header.place(name)?)));
        Ok(Self {
            form,
            lenses: LensCache::default(),
            max_winding,
            pair: header.place("pair")?,
            kind: header.place("kind")?,
            spacetime: Parameters::find(header, spacetime, &POINTS)?,
            points: header.all(&POINTS)?,
            optional: optional.collect::<Result<_, Failure>>()?,
            header: header.clone(),
            met: HashMap::new(),
            rows: 0,
            counts: ConnectionCounts::default(),
        })
    }

    /// Columns that are copied, and their places.
    fn inputs(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let optional = self.optional.iter().filter_map(|&(name, place)| Some((name, place?)));
        self.spacetime.places().chain(self.points.iter().copied()).chain(optional)
    }

    /// Looks up a label, and adds it if it is new: true if a pair of this label has been met before.
    fn is_known(&mut self, label: &[u8], line: u64, inputs: &PointPair) -> Result<bool, Failure> {
        match self.met.get(label) {
            None => {
                self.met.insert(label.to_owned(), (line, inputs.clone()));
                Ok(false)
            }
            Some((_, known)) if known == inputs => Ok(true),
            Some((before, _)) => {
                let label = String::from_utf8_lossy(label);
                let cause = format!("pair `{label}` was given with other inputs in line {before}");
                Err(self.header.at(line, "column `pair`", &cause).help("give every pair a label of its own"))
            }
        }
    }
}

impl RowWise for ConnectJob {
    type Task = Task;
    type Counts = ConnectionCounts;

    fn settings(&self) -> String {
        format!("connect --spacetime {} --max-winding {}", self.spacetime.name(), self.max_winding)
    }

    fn names(&self) -> Vec<&'static str> {
        let inputs = self.inputs().map(|(name, _)| name);
        ["pair", "kind"].into_iter().chain(inputs).chain(self.form.results.iter().copied()).collect()
    }

    fn read(&mut self, row: &ByteRecord) -> Result<Option<Task>, Failure> {
        self.rows += 1;
        let mut points = [0.0; POINTS.len()];
        for (number, &(name, place)) in points.iter_mut().zip(&self.points) {
            *number = self.header.number(row, name, place)?;
        }
        let [x, y] = [0, 3].map(|first| DVec3::from_slice(&points[first..first + 3]));
        let optional = self.optional.iter().map(|&(name, place)| self.header.maybe(row, name, place));
        let optional = optional.collect::<Result<_, Failure>>()?;
        let pair = PointPair { spacetime: self.spacetime.of(&self.header, row)?, x, y, optional };
        let label = match self.pair {
            Some(place) => {
                let label = cell(row, place);
                if self.is_known(label, line(row), &pair)? {
                    return Ok(None);
                }
                label.to_owned()
            }
            None => self.rows.to_string().into_bytes(),
        };
        Ok(Some(Task { label, pair }))
    }

    fn answer(
        &self,
        row: &ByteRecord,
        Task { label, pair }: &Task,
        out: &mut CsvText,
        counts: &mut ConnectionCounts,
    ) -> Result<(), Failure> {
        let Joints { found, hidden } = (self.form.join)(&self.lenses, pair, self.max_winding)
            .map_err(|error| self.header.refuse(line(row), &error))?;
        for results in &found {
            out.text(label);
            out.text(self.kind.map_or(&b""[..], |place| cell(row, place)));
            self.inputs().for_each(|(_, place)| out.text(cell(row, place)));
            results.iter().for_each(|result| out.text(result.as_bytes()));
            out.end_row();
        }
        counts.pairs += 1;
        counts.connections += found.len();
        counts.hidden += hidden;
        Ok(())
    }

    fn count(&mut self, ConnectionCounts { pairs, connections, hidden }: ConnectionCounts) {
        self.counts.pairs += pairs;
        self.counts.connections += connections;
        self.counts.hidden += hidden;
    }

    fn summary(&self, seconds: f64) -> String {
        let ConnectionCounts { pairs, connections, hidden } = self.counts;
        let lost = if hidden > 0 { format!(" ({hidden} hidden by rounding)") } else { String::new() };
        format!(
            "{}: {}{lost}; {seconds:.2} s, {} pairs/s",
            plural(pairs, "pair", "pairs"),
            plural(connections, "connection", "connections"),
            decimal(pairs as f64 / seconds.max(1e-6)),
        )
    }

    fn lost(&self) -> usize {
        self.counts.hidden
    }
}
