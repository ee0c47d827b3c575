//! How cost grows with what is varied.

use super::super::{markdown, percent};
use super::{occupancy, over_first, seconds, style};
use crate::plot::{Axis, Chart, Figure, Series};
use crate::study::bench::{Race, Runs, Vary};

/// Size of one diagram, points.
const CHART: [f64; 2] = [470.0, 420.0];

/// All contenders at all values as a table in Markdown, and how their times grow.
pub fn table(sweep: Vary, races: &[Race]) -> String {
    let header = [
        sweep.label(),
        "contender",
        "seconds (range)",
        "time ratio",
        "thread µs/path",
        "rays/path",
        "steps/ray",
        "queries/ray",
        "lanes in use",
    ];
    let row = |race: &Race, (index, runs): (usize, &Runs)| {
        let counters = runs.counters();
        let rays = (counters.rays + counters.light_rays) as f64;
        [
            race.point.value.map_or_else(String::new, number),
            runs.contender.name(),
            seconds(runs),
            over_first(index, race.ratio(index, 0)),
            format!("{:.2}", runs.us_per_path()),
            format!("{:.2}", rays / counters.paths as f64),
            format!("{:.2}", counters.steps as f64 / rays),
            format!("{:.2}", counters.queries as f64 / rays),
            occupancy(runs).map_or_else(|| "–".to_owned(), percent),
        ]
    };
    let rows = races.iter().flat_map(|race| race.runs.iter().enumerate().map(|entry| row(race, entry)));
    format!("{}\n{}", markdown(header, rows.collect()), growth(races))
}

/// A value as short as it can be written.
fn number(value: f64) -> String {
    if (1e-3..1e9).contains(&value) { value.to_string() } else { format!("{value:e}") }
}

/// How the time grows from the least value to the largest, and the power of the value that this is, a line per
/// contender.
fn growth(races: &[Race]) -> String {
    let value = |race: &Race| race.point.value.unwrap_or(f64::NAN);
    let by_value = |a: &&Race, b: &&Race| value(a).total_cmp(&value(b));
    let ends = (races.iter().min_by(by_value), races.iter().max_by(by_value));
    let (Some(least), Some(most)) = ends else { return String::new() };
    let line = |(first, last): (&Runs, &Runs)| {
        let [short, long] = [first, last].map(|runs| runs.median(|stats| stats.seconds));
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

/// Time of a render and thread time per path over the value, a curve per contender.
pub fn figure(sweep: Vary, races: &[Race]) -> Figure {
    let contenders = races.first().map_or(0, |race| race.runs.len());
    let chart = |title: &str, label: &str, y: fn(&Runs) -> f64| {
        let series: Vec<Series> = (0..contenders)
            .map(|index| {
                let point = |race: &Race| [race.point.value.unwrap_or(f64::NAN), y(&race.runs[index])];
                let contender = races[0].runs[index].contender;
                let curve = races.iter().map(point).collect();
                Series { name: contender.name(), style: style(contender), curves: vec![curve] }
            })
            .collect();
        let along = |axis: usize| series.iter().flat_map(|s| &s.curves[0]).map(move |point| point[axis]);
        Chart {
            title: title.to_owned(),
            x: Axis::log_around(sweep.label(), along(0)),
            y: Axis::log_around(label, along(1)),
            size: CHART,
            series: series.clone(),
        }
    };
    let charts = vec![
        chart("Time of a render", "time (s)", |runs| runs.median(|stats| stats.seconds)),
        chart("Time per path", "thread time per camera path (µs)", Runs::us_per_path),
    ];
    Figure { charts }
}
