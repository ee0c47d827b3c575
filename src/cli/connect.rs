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
use crate::spacetime::{Entry, SpacetimeKind};
use crate::study::connections::{Joiner, Joint, Joints, PointPair};
use crate::study::spinning_connections::{self, SpinningJoint};
use crate::study::table::number_cell;

/// Columns of the points of a pair; copied, as those of the spacetime.
const POINTS: [&str; 6] = ["x0", "x1", "x2", "y0", "y1", "y2"];
/// Columns that are found around a centre.
const RESULTS: [&str; 14] = [
    "winding",
    "Phi",
    "b",
    "dx0",
    "dx1",
    "dx2",
    "dy0",
    "dy1",
    "dy2",
    "t",
    "G_xy",
    "G_yx",
    "nu_x_over_nu_y",
    "swing",
];
/// Columns that are found around a spinning hole.
const SPINNING_RESULTS: [&str; 20] = [
    "image",
    "images",
    "dx0",
    "dx1",
    "dx2",
    "px0",
    "px1",
    "px2",
    "dy0",
    "dy1",
    "dy2",
    "py0",
    "py1",
    "py2",
    "t",
    "G_xy",
    "G_yx",
    "nu_x_over_nu_y",
    "swept",
    "sens",
];

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

/// Cells of the connections of a pair, and the number of those that rounding hides.
struct Connections {
    rows: Vec<Vec<String>>,
    hidden: usize,
}

struct ConnectJob {
    joiner: Joiner,
    /// True around a spinning hole.
    spins: bool,
    max_winding: u32,
    header: TableHeader,
    spacetime: Parameters,
    /// Columns of labels, if there are any, and of inputs.
    pair: Option<usize>,
    kind: Option<usize>,
    inputs: Vec<(&'static str, usize)>,
    /// Line and inputs of the labels that have been met.
    met: HashMap<Vec<u8>, (u64, PointPair)>,
    /// Rows read.
    rows: u64,
    counts: ConnectionCounts,
}

impl ConnectJob {
    fn new(header: &TableHeader, spacetime: &'static Entry, max_winding: u32) -> Result<Self, Failure> {
        let spins = match spacetime.example() {
            SpacetimeKind::Spinning { .. } => true,
            SpacetimeKind::Flat
            | SpacetimeKind::Spherical { .. }
            | SpacetimeKind::Wormhole { .. }
            | SpacetimeKind::Indexed(_) => false,
        };
        let spacetime = Parameters::find(header, spacetime, &POINTS)?;
        let points = header.all(&POINTS)?;
        Ok(Self {
            joiner: Joiner::default(),
            spins,
            max_winding,
            pair: header.place("pair")?,
            kind: header.place("kind")?,
            inputs: spacetime.places().chain(points).collect(),
            spacetime,
            header: header.clone(),
            met: HashMap::new(),
            rows: 0,
            counts: ConnectionCounts::default(),
        })
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
    type Answer = Connections;

    fn settings(&self) -> String {
        format!("connect --spacetime {} --max-winding {}", self.spacetime.name(), self.max_winding)
    }

    fn names(&self) -> Vec<&'static str> {
        let inputs = self.inputs.iter().map(|(name, _)| *name);
        let results = if self.spins { &SPINNING_RESULTS[..] } else { &RESULTS };
        ["pair", "kind"].into_iter().chain(inputs).chain(results.iter().copied()).collect()
    }

    fn read(&mut self, row: ByteRecord) -> Result<Option<Task>, Failure> {
        self.rows += 1;
        let mut points = [0.0; POINTS.len()];
        let places = &self.inputs[self.inputs.len() - POINTS.len()..];
        for (number, &(name, place)) in points.iter_mut().zip(places) {
            *number = self.header.number(&row, name, place)?;
        }
        let spacetime = self.spacetime.of(&self.header, &row)?;
        let pair =
            PointPair { spacetime, x: DVec3::from_slice(&points[0..3]), y: DVec3::from_slice(&points[3..6]) };
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

    fn answer(&self, task: &Task) -> Result<Connections, Failure> {
        let joined = if self.spins {
            spinning_connections::join(&task.pair, self.max_winding).map(|Joints { found, hidden }| {
                let rows = found.iter().enumerate();
                let rows = rows.map(|(i, joint)| spinning_results(joint, i + 1, found.len()).to_vec());
                Connections { rows: rows.collect(), hidden }
            })
        } else {
            self.joiner.join(&task.pair, self.max_winding).map(|Joints { found, hidden }| Connections {
                rows: found.iter().map(|joint| results(joint).to_vec()).collect(),
                hidden,
            })
        };
        joined.map_err(|error| self.header.refuse(line(&task.row), &error))
    }

    fn write(
        &mut self,
        task: &Task,
        found: &Connections,
        out: &mut csv::Writer<impl Write>,
    ) -> csv::Result<()> {
        let text = |place: usize| task.row.get(place).unwrap_or_default();
        for results in &found.rows {
            out.write_field(&task.label)?;
            out.write_field(self.kind.map_or(&b""[..], text))?;
            self.inputs.iter().try_for_each(|&(_, place)| out.write_field(text(place)))?;
            out.write_record(results)?;
        }
        self.counts.pairs += 1;
        self.counts.connections += found.rows.len();
        self.counts.hidden += found.hidden;
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

/// The cells of [`RESULTS`].
fn results(joint: &Joint) -> [String; RESULTS.len()] {
    let Joint { direction: dx, arrival: dy, .. } = joint;
    [
        joint.winding.to_string(),
        number_cell(joint.swept),
        number_cell(joint.b),
        number_cell(dx.x),
        number_cell(dx.y),
        number_cell(dx.z),
        number_cell(dy.x),
        number_cell(dy.y),
        number_cell(dy.z),
        number_cell(joint.time),
        number_cell(joint.spread),
        number_cell(joint.reversed_spread),
        number_cell(joint.frequency_ratio),
        number_cell(joint.swing),
    ]
}

/// The cells of [`SPINNING_RESULTS`], of the ray that arrives as the `image`th of all `images`.
fn spinning_results(joint: &SpinningJoint, image: usize, images: usize) -> [String; SPINNING_RESULTS.len()] {
    let SpinningJoint { directions: [dx, dy], momenta: [px, py], .. } = joint;
    [
        image.to_string(),
        images.to_string(),
        number_cell(dx.x),
        number_cell(dx.y),
        number_cell(dx.z),
        number_cell(px.x),
        number_cell(px.y),
        number_cell(px.z),
        number_cell(dy.x),
        number_cell(dy.y),
        number_cell(dy.z),
        number_cell(py.x),
        number_cell(py.y),
        number_cell(py.z),
        number_cell(joint.time),
        number_cell(joint.spread),
        number_cell(joint.reversed_spread),
        number_cell(joint.frequency_ratio),
        number_cell(joint.swept),
        number_cell(joint.sens),
    ]
}
