//! Growth of cost with what is varied.

use super::cells::{over_first, seconds};
use super::race::{Race, Runs};
use super::vary::Vary;
use crate::plot::{DataSeries, Diagram, Figure};
use crate::study::report::style_of;
use crate::study::table::{NONE, Table, TableRow, percent};
use crate::trace::Stats;

/// Size of one diagram, points.
const DIAGRAM: [f64; 2] = [470.0, 420.0];

/// All contenders at all values as a table in Markdown, and how their times grow.
pub(super) fn text(sweep: Vary, races: &[Race]) -> String {
    let row = |race: &Race, (index, runs): (usize, &Runs)| {
        let counters = runs.counters();
        let rays = (counters.rays + counters.light_rays) as f64;
        TableRow::default()
            .maybe(sweep.label(), race.point.value.map(number))
            .cell("contender", runs.contender.name())
            .cell("seconds (range)", seconds(runs, |stats| stats.seconds))
            .cell("time ratio", over_first(index, race.ratio(index, 0)))
            .cell("CPU µs/path", format!("{:.2}", runs.us_per_path()))
            .cell("rays/path", format!("{:.2}", rays / counters.paths as f64))
            .cell("steps/ray", format!("{:.2}", counters.steps as f64 / rays))
            .cell("queries/ray", format!("{:.2}", counters.queries as f64 / rays))
            .cell("lanes in use", runs.occupancy().map_or(NONE.to_owned(), percent))
    };
    let rows = races.iter().flat_map(|race| race.runs.iter().enumerate().map(|entry| row(race, entry)));
    format!("{}\n{}", Table::of(rows).markdown(), growth(sweep, races))
}

/// A value as short as it can be written.
fn number(value: f64) -> String {
    if (1e-3..1e9).contains(&value) { value.to_string() } else { format!("{value:e}") }
}

/// Growth of the time from the least value to the largest, and the power of the value that this is, a line per
/// contender.
fn growth(sweep: Vary, races: &[Race]) -> String {
    let value = |race: &Race| race.point.value.unwrap_or(f64::NAN);
    let by_value = |a: &&Race, b: &&Race| value(a).total_cmp(&value(b));
    let ends = (races.iter().min_by(by_value), races.iter().max_by(by_value));
    let (Some(least), Some(most)) = ends else { return String::new() };
    // The work is the same on any number of threads.
    let time: fn(&Stats) -> f64 = match sweep {
        Vary::Threads => |stats| stats.seconds,
        _ => |stats| stats.cpu_seconds,
    };
    let line = |(first, last): (&Runs, &Runs)| {
        let [short, long] = [first, last].map(|runs| runs.median(time));
        format!(
            "{}, from {} to {}: {:.3} times the time, value^{:.2}\n",
            first.contender.name(),
            number(value(least)),
            number(value(most)),
            long / short,
            libm::log(long / short) / libm::log(value(most) / value(least))
        )
    };
    let lines = least.runs.iter().zip(&most.runs).map(line);
    if races.len() > 1 { lines.collect() } else { String::new() }
}

/// Wall time of a render and CPU time per path over the value, a curve per contender.
pub(super) fn figure(sweep: Vary, races: &[Race]) -> Figure {
    let contenders = races.first().map_or(0, |race| race.runs.len());
    let diagram = |title: &str, label: &str, y: fn(&Runs) -> f64| {
        let series = |index: usize| {
            let point = |race: &Race| [race.point.value.unwrap_or(f64::NAN), y(&race.runs[index])];
            let contender = races[0].runs[index].contender;
            let curve = races.iter().map(point).collect();
            DataSeries { name: contender.name(), style: style_of(&contender), curves: vec![curve] }
        };
        Diagram::log_log(title, [sweep.label(), label], DIAGRAM, (0..contenders).map(series).collect())
    };
    let diagrams = vec![
        diagram("Time of a render", "time (s)", |runs| runs.median(|stats| stats.seconds)),
        diagram("Time per path", "CPU time per camera path (µs)", Runs::us_per_path),
    ];
    Figure { diagrams }
}
