//! A race at one point: who is how fast, and what the wavefront's stages cost.

use super::cells::{over_first, seconds};
use super::contender::Contender;
use super::race::{Race, Runs};
use crate::plot::{Axis, Color, DataSeries, Diagram, Figure, Style};
use crate::study::report::style_of;
use crate::study::table::{NONE, Table, TableRow, percent, with_error};
use crate::trace::Stats;

/// Size of the diagram, points.
const DIAGRAM: [f64; 2] = [620.0, 420.0];
/// Half the width of a bar, rounds.
const BAR: f64 = 0.38;
/// Room above the highest curve, relative to it.
const ROOM: f64 = 1.06;
/// Colours of stages, learning and the rest last.
const COLORS: [Color; 9] = [
    Color::GREEN,
    Color::BLUE,
    Color::ORANGE,
    Color::SKY,
    Color::WINE,
    Color::PURPLE,
    Color::GREY,
    Color::VERMILION,
    Color::PALE,
];
/// Learning of light sampling before, during which no thread does anything else.
const LEARN: &str = "learn";
/// CPU time that is no stage's: sums of samples, sharing out of tiles.
const REST: &str = "rest";

/// Contenders, the stages of the first wavefront among them, and what it all means, as text and tables in Markdown.
pub(super) fn text(race: &Race) -> String {
    let mut text = contenders(race);
    if let Some(wavefront) = wavefront(race) {
        text = format!("{text}\n{}\n{}\n", stages(wavefront), vectors(wavefront));
    }
    text + &verdicts(race)
}

fn wavefront(race: &Race) -> Option<&Runs> {
    race.runs.iter().find(|runs| runs.occupancy().is_some())
}

fn contenders(race: &Race) -> String {
    let row = |(index, runs): (usize, &Runs)| {
        let counters = runs.counters();
        let rays = counters.rays + counters.light_rays;
        let median = runs.median(|stats| stats.cpu_seconds);
        let rate = |count: u64, unit: f64| format!("{:.2}", count as f64 / median / unit);
        TableRow::default()
            .cell("contender", runs.contender.name())
            .cell("CPU seconds (range)", seconds(runs, |stats| stats.cpu_seconds))
            .cell("time ratio", over_first(index, race.ratio(index, 0)))
            .cell("tracing alone", over_first(index, race.tracing_ratio(index, 0)))
            .cell("k paths/CPU s", rate(counters.paths, 1e3))
            .cell("M rays/CPU s", rate(rays, 1e6))
            .cell("M steps/CPU s", rate(counters.steps, 1e6))
            .cell("M queries/CPU s", rate(counters.queries, 1e6))
            .cell("steps/ray", format!("{:.2}", counters.steps as f64 / rays as f64))
            .cell("queries/ray", format!("{:.2}", counters.queries as f64 / rays as f64))
    };
    Table::of(race.runs.iter().enumerate().map(row)).markdown()
}

/// CPU time of each stage, of learning and of what is left, seconds.
fn parts(stats: &Stats) -> Vec<(&'static str, f64)> {
    let stages = stats.stages.named().map(|(name, stage)| (name, stage.seconds));
    let learning = stats.stages.learning;
    let known = learning + stages.iter().map(|(_, seconds)| seconds).sum::<f64>();
    let rest = (stats.cpu_seconds - known).max(0.0);
    stages.into_iter().chain([(LEARN, learning), (REST, rest)]).collect()
}

fn stages(runs: &Runs) -> String {
    let Some(first) = runs.rounds.first() else { return String::new() };
    let items = first.stages.named().map(|(_, stage)| stage.items).into_iter().map(Some).chain([None, None]);
    let lanes = first.stages.occupancy.lanes as f64;
    let whole = runs.median(|stats| stats.cpu_seconds);
    let row = |(index, ((name, _), items)): (usize, ((&str, f64), Option<u64>))| {
        let seconds = runs.median(|stats| parts(stats)[index].1);
        let of_items =
            |value: &dyn Fn(f64) -> String| items.map_or(NONE.to_owned(), |items| value(items as f64));
        TableRow::default()
            .cell("stage", name)
            .cell("CPU seconds", format!("{seconds:.3}"))
            .cell("share", percent(seconds / whole))
            .cell("rays handled", of_items(&|items| items.to_string()))
            .cell("ns/ray", of_items(&|items| format!("{:.1}", 1e9 * seconds / items.max(1.0))))
            .cell("of all lanes", of_items(&|items| percent(items / lanes)))
    };
    Table::of(parts(first).into_iter().zip(items).enumerate().map(row)).markdown()
}

/// Occupancy of the vectors, in words.
fn vectors(runs: &Runs) -> String {
    let occupancy = runs.rounds.first().map(|stats| stats.stages.occupancy).unwrap_or_default();
    let per_round = |count: u64| count as f64 / occupancy.rounds.max(1) as f64;
    format!(
        "{} of the wavefront: {:.0} of {:.0} lanes in use, {}; of the lanes of blocks in use {}",
        match occupancy.rounds {
            1 => "1 move".to_owned(),
            rounds => format!("{rounds} moves"),
        },
        per_round(occupancy.live),
        per_round(occupancy.lanes),
        percent(occupancy.live as f64 / occupancy.lanes.max(1) as f64),
        percent(occupancy.live as f64 / occupancy.blocks.max(1) as f64),
    )
}

/// One sentence per contender after the first.
fn verdicts(race: &Race) -> String {
    let verdict = |(index, runs): (usize, &Runs)| {
        let [slower, faster] = [(index, 0), (0, index)].map(|(a, b)| with_error(race.ratio(a, b)));
        match runs.contender {
            Contender::Wavefront => format!("the wavefront against itself: {slower} times the time\n"),
            Contender::PerPixel => format!(
                "the wavefront is {slower} times as fast as the same kernels pixel by pixel; the pictures are the \
                 same, bit for bit\n"
            ),
            Contender::Paper => format!("the wavefront is {slower} times as fast as the paper's scheme\n"),
            Contender::Flat => format!("curved space takes {faster} times as long as flat space\n"),
        }
    };
    race.runs.iter().enumerate().skip(1).map(verdict).collect()
}

/// CPU time per path in every round: the wavefront's by stage, as bars, under the curves of all contenders.
pub(super) fn figure(race: &Race) -> Figure {
    let mut series = wavefront(race).map(bars).unwrap_or_default();
    for runs in &race.runs {
        let curve = runs
            .rounds
            .iter()
            .zip(1..)
            .map(|(stats, round)| [f64::from(round), microseconds(stats, stats.cpu_seconds)]);
        // The bars have the colours.
        let style = Style { color: Color::BLACK, ..style_of(&runs.contender) };
        series.push(DataSeries { name: runs.contender.name(), style, curves: vec![curve.collect()] });
    }
    let rounds = race.runs.first().map_or(0, |runs| runs.rounds.len());
    let heights = series.iter().flat_map(|series| series.curves.iter().flatten()).map(|[_, y]| *y);
    let top = ROOM * heights.fold(0.0, f64::max);
    let diagram = Diagram {
        title: "Time by round".to_owned(),
        x: Axis::linear("round", [0.5, rounds as f64 + 0.5]),
        y: Axis::linear("CPU time per camera path (µs)", [0.0, top]),
        size: DIAGRAM,
        series,
    };
    Figure { diagrams: vec![diagram] }
}

/// `seconds` of CPU time per camera path.
fn microseconds(stats: &Stats, seconds: f64) -> f64 {
    1e6 * seconds / stats.counters.paths as f64
}

/// The stages of the wavefront, one upon the other, a bar per round.
fn bars(runs: &Runs) -> Vec<DataSeries> {
    let names = runs.rounds.first().map(parts).unwrap_or_default();
    let mut series: Vec<DataSeries> = names
        .into_iter()
        .zip(COLORS.into_iter().cycle())
        .map(|((name, _), color)| DataSeries {
            name: name.to_owned(),
            style: Style::area(color),
            curves: Vec::new(),
        })
        .collect();
    for (stats, round) in runs.rounds.iter().zip(1..) {
        let (left, right) = (f64::from(round) - BAR, f64::from(round) + BAR);
        let mut low = 0.0;
        for (series, (_, seconds)) in series.iter_mut().zip(parts(stats)) {
            let high = low + microseconds(stats, seconds);
            series.curves.push(vec![[left, low], [right, low], [right, high], [left, high]]);
            low = high;
        }
    }
    series
}
