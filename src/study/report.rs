//! Measurements for people and papers: table, CSV, diagram.

use std::io::{self, Write};

use clap::ValueEnum;

use super::pareto::front;
use super::sweep::{Measurement, Spread};
use crate::plot::{Axis, Chart, Color, Figure, Series, Style};

/// Size of one diagram, points.
const CHART: [f64; 2] = [470.0, 420.0];
/// Width of the line under a front, points.
const FRONT: f64 = 12.0;

/// A value of an error for which there may be none.
fn of(spread: Option<Spread>, value: fn(&Spread) -> f64) -> f64 {
    spread.as_ref().map_or(f64::NAN, value)
}

/// 99th percentile of the error, pixels, and time per camera ray, nanoseconds: what fronts are judged by.
fn trade(measurement: &Measurement) -> [f64; 2] {
    [of(measurement.errors.footprint, |spread| spread.p99), measurement.cost.ns_per_ray]
}

/// The name under which a setting is given on the command line.
fn name(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Which measurements are on the front of error (99th percentile, pixels) against time per camera ray.
pub fn pareto(measurements: &[Measurement]) -> Vec<bool> {
    front(&measurements.iter().map(trade).collect::<Vec<_>>())
}

/// The measurements as a table in Markdown; those on the Pareto front are marked.
pub fn table(measurements: &[Measurement]) -> String {
    let header = [
        "front",
        "stepper",
        "tolerance",
        "schedule",
        "median (px)",
        "99 % (px)",
        "median",
        "99 %",
        "differ",
        "ns/camera ray",
        "paths/s",
        "steps/ray",
        "queries/ray",
    ];
    let mut rows = vec![header.map(str::to_owned)];
    for (measurement, on_front) in measurements.iter().zip(pareto(measurements)) {
        let Measurement { setting, errors, cost } = measurement;
        let error = |spread, value| match of(spread, value) {
            none if none.is_nan() => "–".to_owned(),
            error => format!("{error:.1e}"),
        };
        rows.push([
            if on_front { "*" } else { "" }.to_owned(),
            name(setting.stepper),
            setting.tolerance.map_or_else(|| "–".to_owned(), |tolerance| format!("{tolerance:e}")),
            name(setting.schedule),
            error(errors.footprint, |spread| spread.median),
            error(errors.footprint, |spread| spread.p99),
            error(errors.position, |spread| spread.median),
            error(errors.position, |spread| spread.p99),
            format!("{:.2} %", 100.0 * errors.differ),
            format!("{:.0}", cost.ns_per_ray),
            format!("{:.0}", cost.paths_per_second),
            format!("{:.2}", cost.steps_per_ray),
            format!("{:.2}", cost.queries_per_ray),
        ]);
    }
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut lines: Vec<String> = rows
        .iter()
        .map(|row| line(row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:>width$}")).collect()))
        .collect();
    lines.insert(1, line(widths.iter().map(|&width| format!("{}:", "-".repeat(width - 1))).collect()));
    lines.concat()
}

/// Writes the measurements as rows; a cell without a value is empty.
///
/// # Errors
/// What `out` reports.
pub fn write_csv(measurements: &[Measurement], mut out: impl Write) -> io::Result<()> {
    writeln!(
        out,
        "stepper,tolerance,schedule,rays,differ,position_rmse,position_median,position_p99,direction_rmse,\
         direction_median,direction_p99,footprint_rmse,footprint_median,footprint_p99,ns_per_ray,paths_per_second,\
         steps_per_ray,queries_per_ray,pareto"
    )?;
    let optional = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for (measurement, on_front) in measurements.iter().zip(pareto(measurements)) {
        let Measurement { setting, errors, cost } = measurement;
        let mut cells = vec![
            name(setting.stepper),
            optional(setting.tolerance),
            name(setting.schedule),
            errors.rays.to_string(),
            errors.differ.to_string(),
        ];
        for spread in [errors.position, errors.direction, errors.footprint] {
            cells.extend(
                [|s: Spread| s.rmse, |s: Spread| s.median, |s: Spread| s.p99]
                    .map(|value| optional(spread.map(value))),
            );
        }
        let costs = [cost.ns_per_ray, cost.paths_per_second, cost.steps_per_ray, cost.queries_per_ray];
        cells.extend(costs.map(|cost| cost.to_string()));
        writeln!(out, "{},{}", cells.join(","), u8::from(on_front))?;
    }
    Ok(())
}

/// Work against precision: time per camera ray over the median error and over its 99th percentile.
pub fn figure(measurements: &[Measurement]) -> Figure {
    let chart = |title: &str, error: fn(&Spread) -> f64| {
        let point = |m: &Measurement| [of(m.errors.footprint, error), m.cost.ns_per_ray];
        Chart {
            title: title.to_owned(),
            x: Axis::log_around("error (pixels)", measurements.iter().map(|m| point(m)[0])),
            y: Axis::log_around("time per camera ray (ns)", measurements.iter().map(|m| point(m)[1])),
            size: CHART,
            series: series(measurements, point),
        }
    };
    let charts = vec![
        chart("Median error", |spread| spread.median),
        chart("99th percentile of the error", |spread| spread.p99),
    ];
    Figure { charts }
}

/// A curve per stepper and schedule, over the Pareto front.
fn series(measurements: &[Measurement], point: impl Fn(&Measurement) -> [f64; 2]) -> Vec<Series> {
    let points: Vec<[f64; 2]> = measurements.iter().map(&point).collect();
    let on_front = front(&points);
    let mut best: Vec<[f64; 2]> =
        points.iter().zip(on_front).filter(|(_, on)| *on).map(|(p, _)| *p).collect();
    best.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut series = vec![Series {
        name: "Pareto front".to_owned(),
        style: Style::line(Color::PALE, FRONT),
        curves: vec![best],
    }];
    let schedules = measurements.iter().any(|m| m.setting.schedule != measurements[0].setting.schedule);
    let mut names: Vec<String> = Vec::new();
    for measurement in measurements {
        let setting = measurement.setting;
        let stepper = name(setting.stepper);
        let name = if schedules { format!("{stepper}, {}", name(setting.schedule)) } else { stepper };
        let index = names.iter().position(|known| *known == name).unwrap_or_else(|| {
            let style = Style::nth(names.len());
            series.push(Series { name: name.clone(), style, curves: vec![Vec::new()] });
            names.push(name);
            names.len() - 1
        });
        series[index + 1].curves[0].push(point(measurement));
    }
    series
}
