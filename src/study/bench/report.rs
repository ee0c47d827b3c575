//! Reports of races: how one went, or how cost grows with what is varied.

use super::previous::Previous;
use super::race::Race;
use super::vary::Vary;
use super::{growth, single};
use crate::scene::flag_name;
use crate::study::report::Report;
use crate::study::table::{Table, TableRow};
use crate::trace::Stats;

/// The report of `races`, one for each value of what is varied, or else one; a row for every render that counts. Their
/// text compares them with builds before this one.
pub fn report(sweep: Option<Vary>, races: &[Race], previous: &[Previous]) -> Report {
    let rows = races.iter().flat_map(|race| rows(sweep, race));
    let table = Table::of(rows);
    let before: String = previous.iter().map(|previous| format!("\n{}", previous.text(races))).collect();
    let report = match sweep {
        Some(sweep) => {
            Report { text: growth::text(sweep, races), table, figure: growth::figure(sweep, races) }
        }
        None => Report {
            text: races.iter().map(single::text).collect(),
            table,
            figure: single::figure(&races[0]),
        },
    };
    Report { text: report.text + &before, ..report }
}

fn rows(sweep: Option<Vary>, race: &Race) -> impl Iterator<Item = TableRow> {
    race.runs.iter().flat_map(move |runs| {
        let start = move |round: usize| {
            TableRow::default()
                .maybe("sweep", sweep.map(flag_name))
                .maybe("value", race.point.value)
                .cell("contender", runs.contender.name())
                .cell("round", round)
        };
        runs.rounds.iter().zip(1..).map(move |(stats, round)| render(start(round), race, stats))
    })
}

/// Adds the cells of a render.
fn render(row: TableRow, race: &Race, stats: &Stats) -> TableRow {
    let (settings, counters) = (&race.point.settings, &stats.counters);
    let occupancy = stats.stages.occupancy.share();
    let mut row = row
        .cell("seconds", stats.seconds)
        .cell("cpu_seconds", stats.cpu_seconds)
        .cell("learning_seconds", stats.stages.learning)
        .cell("threads", stats.threads)
        .cell("batch", race.point.batch)
        .cell("width", settings.width)
        .cell("height", settings.height)
        .cell("spp", settings.spp)
        .cell("paths", counters.paths)
        .cell("rays", counters.rays)
        .cell("light_rays", counters.light_rays)
        .cell("steps", counters.steps)
        .cell("queries", counters.queries)
        .maybe("occupancy", occupancy);
    for (name, stage) in stats.stages.named() {
        // Without a wavefront nothing is counted by stage.
        let counted = occupancy.map(|_| stage);
        row = row
            .maybe(format!("{name}_seconds"), counted.map(|stage| stage.seconds))
            .maybe(format!("{name}_items"), counted.map(|stage| stage.items));
    }
    row
}
