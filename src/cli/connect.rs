//! `warpfront connect`.

use std::collections::HashMap;
use std::io::Write;

use csv::ByteRecord;
use glam::DVec3;

use super::args::ConnectArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::rays_table::Parameters;
use super::rowwise::{RowWise, Setup};
use super::table::{TableHeader, line};
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

/// A pair, and the row in which it came.
struct Task {
    row: ByteRecord,
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
    type Answer = Joints;

    fn settings(&self) -> String {
        format!("connect --spacetime {} --max-winding {}", self.spacetime.name(), self.max_winding)
    }

    fn names(&self) -> Vec<&'static str> {
        let inputs = self.inputs().map(|(name, _)| name);
        ["pair", "kind"].into_iter().chain(inputs).chain(self.form.results.iter().copied()).collect()
    }

    fn read(&mut self, row: ByteRecord) -> Result<Option<Task>, Failure> {
        self.rows += 1;
        let mut points = [0.0; POINTS.len()];
        for (number, &(name, place)) in points.iter_mut().zip(&self.points) {
            *number = self.header.number(&row, name, place)?;
        }
        let [x, y] = [0, 3].map(|first| DVec3::from_slice(&points[first..first + 3]));
        let optional = self.optional.iter().map(|&(name, place)| self.header.maybe(&row, name, place));
        let optional = optional.collect::<Result<_, Failure>>()?;
        let pair = PointPair { spacetime: self.spacetime.of(&self.header, &row)?, x, y, optional };
        let label = match self.pair {
            Some(place) => {
                let label = row.get(place).unwrap_or_default();
                if self.is_known(label, line(&row), &pair)? {
                    return Ok(None);
                }
                label.to_owned()
            }
            None => self.rows.to_string().into_bytes(),
        };
        Ok(Some(Task { row, label, pair }))
    }

    fn answer(&self, task: &Task) -> Result<Joints, Failure> {
        let joined = (self.form.join)(&self.lenses, &task.pair, self.max_winding);
        joined.map_err(|error| self.header.refuse(line(&task.row), &error))
    }

    fn write(&mut self, task: &Task, joints: &Joints, out: &mut csv::Writer<impl Write>) -> csv::Result<()> {
        let text = |place: usize| task.row.get(place).unwrap_or_default();
        for results in &joints.found {
            out.write_field(&task.label)?;
            out.write_field(self.kind.map_or(&b""[..], text))?;
            self.inputs().try_for_each(|(_, place)| out.write_field(text(place)))?;
            out.write_record(results)?;
        }
        self.counts.pairs += 1;
        self.counts.connections += joints.found.len();
        self.counts.hidden += joints.hidden;
        Ok(())
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
