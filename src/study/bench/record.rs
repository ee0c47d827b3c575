//! All that races gave, for programs.

use serde::Serialize;

use super::race::{Race, Runs};
use super::vary::Vary;
use crate::scene::{Settings, flag_name};
use crate::study::estimate::Estimate;
use crate::trace::Stats;

/// All that was measured, for programs.
#[derive(Serialize)]
pub struct BenchRecord<'a> {
    version: &'static str,
    scene: &'a str,
    /// Name of what was varied.
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
    /// CPU time of a render: median, shortest, longest.
    cpu_seconds: [f64; 3],
    /// CPU time of a camera path, microseconds.
    us_per_path: f64,
    /// Over the CPU time of the first contender.
    time_ratio: Option<Estimate>,
    /// Time ratio without the time in which light sampling learns before.
    tracing_ratio: Option<Estimate>,
    /// Share of the lanes in use.
    occupancy: Option<f64>,
    rounds: &'a [Stats],
}

impl<'a> BenchRecord<'a> {
    /// The record of `races` on `scene`.
    pub fn new(scene: &'a str, sweep: Option<Vary>, races: &'a [Race]) -> Self {
        let points = races.iter().map(PointRecord::of).collect();
        Self { version: env!("CARGO_PKG_VERSION"), scene, sweep: sweep.map(flag_name), warm_up: 1, points }
    }
}

impl<'a> PointRecord<'a> {
    fn of(race: &'a Race) -> Self {
        let contender = |(index, runs): (usize, &'a Runs)| {
            let times = |time: fn(&Stats) -> f64| {
                let [shortest, longest] = runs.range(time);
                [runs.median(time), shortest, longest]
            };
            ContenderRecord {
                name: runs.contender.name(),
                seconds: times(|stats| stats.seconds),
                cpu_seconds: times(|stats| stats.cpu_seconds),
                us_per_path: runs.us_per_path(),
                time_ratio: (index > 0).then(|| race.ratio(index, 0)).flatten(),
                tracing_ratio: (index > 0).then(|| race.tracing_ratio(index, 0)).flatten(),
                occupancy: runs.occupancy(),
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
