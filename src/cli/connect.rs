//! `warpfront connect`.

use std::collections::HashMap;
use std::io::Write;
use std::time::Instant;

use csv::ByteRecord;
use glam::DVec3;

use super::args::ConnectArgs;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::rowwise::{RowWise, Setup, cell};
use super::table::{Header, Table, line};
use super::units::{decimal, plural};
use super::{Outcome, say};
use crate::study::connections::{Fault, Input, Joiner, Joint, Joints, Pair};

/// Columns that describe a pair, and are copied.
const INPUTS: [&str; 7] = ["rs", "x0", "x1", "x2", "y0", "y1", "y2"];
/// Columns that are found.
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

/// Finds the rays that join the points of every pair of a table.
pub(super) fn run(args: &ConnectArgs) -> Result<Outcome, Failure> {
    // Without a result to keep, Ctrl-C ends the process and removes the unfinished file.
    Interrupt::install();
    let started = Instant::now();
    let mut table = Table::open(&args.pairs, "pair of points")?;
    let mut job = Job::new(&table.header, args.max_winding)?;
    let setup = Setup {
        input: (&args.pairs, "pairs"),
        output: args.output.as_deref(),
        threads: args.threads,
        progress: args.meter.progress,
    };
    let Some(wrote) = setup.run(&mut table, &mut job)? else { return Ok(Outcome::Good) };
    let seconds = started.elapsed().as_secs_f64();
    let Counts { pairs, connections, hidden } = job.counts;
    let lost = if hidden > 0 { format!(" ({hidden} hidden by rounding)") } else { String::new() };
    say(format!(
        "{}: {}{lost}; {seconds:.2} s, {} pairs/s{wrote}",
        plural(pairs, "pair", "pairs"),
        plural(connections, "connection", "connections"),
        decimal(pairs as f64 / seconds.max(1e-6)),
    ));
    Ok(if args.strict && hidden > 0 { Outcome::Lost } else { Outcome::Good })
}

/// A pair, and the row in which it came.
struct Task {
    row: ByteRecord,
    label: Vec<u8>,
    pair: Pair,
}

/// What has been done so far.
#[derive(Default)]
struct Counts {
    pairs: usize,
    connections: usize,
    hidden: usize,
}

struct Job {
    joiner: Joiner,
    max_winding: u32,
    header: Header,
    /// Where labels, if there are any, and inputs are.
    pair: Option<usize>,
    kind: Option<usize>,
    inputs: Vec<(&'static str, usize)>,
    /// Line and inputs of the labels that have been met.
    met: HashMap<Vec<u8>, (u64, [f64; INPUTS.len()])>,
    /// Rows read.
    rows: u64,
    counts: Counts,
}

impl Job {
    fn new(header: &Header, max_winding: u32) -> Result<Self, Failure> {
        let joiner = Joiner::new().ok_or_else(|| Failure::new("the hole has no photon sphere"))?;
        Ok(Self {
            joiner,
            max_winding,
            pair: header.place("pair")?,
            kind: header.place("kind")?,
            inputs: header.all(&INPUTS)?,
            header: header.clone(),
            met: HashMap::new(),
            rows: 0,
            counts: Counts::default(),
        })
    }

    /// Whether a pair of this label has been met before.
    fn is_known(&mut self, label: &[u8], line: u64, inputs: [f64; INPUTS.len()]) -> Result<bool, Failure> {
        match self.met.get(label) {
            None => {
                self.met.insert(label.to_owned(), (line, inputs));
                Ok(false)
            }
            Some((_, known)) if *known == inputs => Ok(true),
            Some((before, _)) => {
                let label = String::from_utf8_lossy(label);
                let cause = format!("pair `{label}` was given with other inputs in line {before}");
                Err(self.header.at(line, "column `pair`", &cause).help("give every pair a label of its own"))
            }
        }
    }
}

impl RowWise for Job {
    type Task = Task;
    type Answer = Joints;

    fn settings(&self) -> String {
        format!("connect --max-winding {}", self.max_winding)
    }

    fn names(&self) -> Vec<&'static str> {
        ["pair", "kind"].into_iter().chain(INPUTS).chain(RESULTS).collect()
    }

    fn read(&mut self, row: ByteRecord) -> Result<Option<Task>, Failure> {
        self.rows += 1;
        let mut inputs = [0.0; INPUTS.len()];
        for (input, &(name, place)) in inputs.iter_mut().zip(&self.inputs) {
            *input = self.header.number(&row, name, place)?;
        }
        let label = match self.pair {
            Some(place) => {
                let label = row.get(place).unwrap_or_default();
                if self.is_known(label, line(&row), inputs)? {
                    return Ok(None);
                }
                label.to_owned()
            }
            None => self.rows.to_string().into_bytes(),
        };
        let pair = Pair {
            schwarzschild_radius: inputs[0],
            x: DVec3::from_slice(&inputs[1..4]),
            y: DVec3::from_slice(&inputs[4..7]),
        };
        Ok(Some(Task { row, label, pair }))
    }

    fn answer(&self, task: &Task) -> Result<Joints, Failure> {
        let refuse = |fault: Fault| {
            let columns = match fault.input {
                Input::SchwarzschildRadius => "column `rs`",
                Input::X => "columns `x0`, `x1`, `x2`",
                Input::Y => "columns `y0`, `y1`, `y2`",
                Input::Both => "columns `x0` to `y2`",
            };
            self.header.at(line(&task.row), columns, &fault.cause).help(fault.remedy)
        };
        self.joiner.join(&task.pair, self.max_winding).map_err(refuse)
    }

    fn write(&mut self, task: &Task, joints: &Joints, out: &mut csv::Writer<impl Write>) -> csv::Result<()> {
        let text = |place: usize| task.row.get(place).unwrap_or_default();
        for joint in &joints.found {
            out.write_field(&task.label)?;
            out.write_field(self.kind.map_or(&b""[..], text))?;
            self.inputs.iter().try_for_each(|&(_, place)| out.write_field(text(place)))?;
            out.write_record(results(joint))?;
        }
        self.counts.pairs += 1;
        self.counts.connections += joints.found.len();
        self.counts.hidden += joints.hidden;
        Ok(())
    }
}

/// The cells of [`RESULTS`].
fn results(joint: &Joint) -> [String; RESULTS.len()] {
    let Joint { direction: dx, arrival: dy, .. } = joint;
    [
        joint.winding.to_string(),
        cell(joint.swept),
        cell(joint.b),
        cell(dx.x),
        cell(dx.y),
        cell(dx.z),
        cell(dy.x),
        cell(dy.y),
        cell(dy.z),
        cell(joint.time),
        cell(joint.spread),
        cell(joint.reversed_spread),
        cell(joint.frequency_ratio),
        cell(joint.swing),
    ]
}
