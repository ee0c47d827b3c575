//! What races gave: rows and records of all renders here, tables and charts in [`race`] and [`growth`].

pub mod growth;
pub mod race;

use std::io::{self, Write};

use clap::ValueEnum;
use serde::Serialize;

use super::{cell, with_error};
use crate::plot::Style;
use crate::scene::{Settings, flag_name};
use crate::study::bench::{Contender, Race, Runs, Vary};
use crate::study::estimate::Estimate;
use crate::trace::{StageTimes, Stats};

/// All that was measured, for programs.
#[derive(Serialize)]
pub struct Record<'a> {
    version: &'static str,
    scene: &'a str,
    /// What was varied.
    sweep: Option<String>,
    /// Renders of each contender at each point before those that count.
    warm_up: u32,
    points: Vec<PointRecord<'a>>,
}

#[derive(Serialize)]
struct PointRecord<'a> {
    value: Option<f64>,
    schwarzschild_radius: f64,
    batch: usize,
    settings: &'a Settings,
    contenders: Vec<ContenderRecord<'a>>,
}

#[derive(Serialize)]
struct ContenderRecord<'a> {
    name: String,
    /// Wall time of a render: median, shortest, longest.
    seconds: [f64; 3],
    /// Thread time of a camera path, microseconds.
    us_per_path: f64,
    /// Over the time of the first contender.
    time_ratio: Option<Estimate>,
    /// The same without what light sampling learns before.
    tracing_ratio: Option<Estimate>,
    /// Share of the lanes in use.
    occupancy: Option<f64>,
    rounds: &'a [Stats],
}

impl<'a> Record<'a> {
    /// The record of `races` on `scene`.
    pub fn new(scene: &'a str, sweep: Option<Vary>, races: &'a [Race]) -> Self {
        let points = races.iter().map(PointRecord::of).collect();
        Self { version: env!("CARGO_PKG_VERSION"), scene, sweep: sweep.map(flag_name), warm_up: 1, points }
    }
}

impl<'a> PointRecord<'a> {
    fn of(race: &'a Race) -> Self {
        let contender = |(index, runs): (usize, &'a Runs)| {
            let [shortest, longest] = runs.range();
            ContenderRecord {
                name: runs.contender.name(),
                seconds: [runs.median(|stats| stats.seconds), shortest, longest],
                us_per_path: runs.us_per_path(),
                time_ratio: (index > 0).then(|| race.ratio(index, 0)).flatten(),
                tracing_ratio: (index > 0).then(|| race.tracing_ratio(index, 0)).flatten(),
                occupancy: occupancy(runs),
                rounds: &runs.rounds,
            }
        };
        Self {
            value: race.point.value,
            schwarzschild_radius: race.point.spacetime.schwarzschild_radius(),
            batch: race.point.batch,
            settings: &race.point.settings,
            contenders: race.runs.iter().enumerate().map(contender).collect(),
        }
    }
}

/// Share of the lanes in use, the same in every round; `None` without a wavefront.
fn occupancy(runs: &Runs) -> Option<f64> {
    runs.rounds.first()?.stages.occupancy.share()
}

/// Writes every render that counts as a row; a cell without a value is empty.
///
/// # Errors
/// What `out` reports.
pub fn write_csv(sweep: Option<Vary>, races: &[Race], mut out: impl Write) -> io::Result<()> {
    let stages = StageTimes::default().named().map(|(name, _)| format!("{name}_seconds,{name}_items"));
    writeln!(
        out,
        "sweep,value,contender,round,seconds,learning_seconds,threads,batch,width,height,spp,paths,rays,light_rays,steps,queries,\
         occupancy,{}",
        stages.join(",")
    )?;
    for race in races {
        for runs in &race.runs {
            for (round, stats) in runs.rounds.iter().enumerate() {
                let mut cells = vec![
                    sweep.map_or_else(String::new, flag_name),
                    cell(race.point.value),
                    runs.contender.name(),
                    (round + 1).to_string(),
                ];
                cells.extend(numbers(race, stats));
                writeln!(out, "{}", cells.join(","))?;
            }
        }
    }
    Ok(())
}

/// Cells of a render.
fn numbers(race: &Race, stats: &Stats) -> Vec<String> {
    let (settings, counters) = (&race.point.settings, &stats.counters);
    let occupancy = stats.stages.occupancy.share();
    let mut cells = vec![
        stats.seconds.to_string(),
        stats.stages.learning.to_string(),
        stats.threads.to_string(),
        race.point.batch.to_string(),
        settings.width.to_string(),
        settings.height.to_string(),
        settings.spp.to_string(),
    ];
    let counts = [counters.paths, counters.rays, counters.light_rays, counters.steps, counters.queries];
    cells.extend(counts.map(|count| count.to_string()));
    cells.push(cell(occupancy));
    for (_, stage) in stats.stages.named() {
        let of_wavefront = occupancy.is_some();
        cells.push(cell(of_wavefront.then_some(stage.seconds)));
        cells.push(cell(of_wavefront.then_some(stage.items as f64)));
    }
    cells
}

/// `0.512 (0.509–0.530)`: the median wall time and its range, seconds.
fn seconds(runs: &Runs) -> String {
    let [shortest, longest] = runs.range();
    format!("{:.3} ({shortest:.3}–{longest:.3})", runs.median(|stats| stats.seconds))
}

/// A ratio to the first contender, as contender number `index` has it.
fn over_first(index: usize, ratio: Option<Estimate>) -> String {
    if index == 0 { "1".to_owned() } else { with_error(ratio) }
}

/// The same for a contender whatever others are drawn.
fn style(contender: Contender) -> Style {
    Style::nth(Contender::value_variants().iter().position(|&other| other == contender).unwrap_or(0))
}
