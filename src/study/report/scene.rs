//! What was measured on a scene.

use std::io::{self, Write};

use super::{Curve, cell, error, mark, markdown, of, over_front, percent};
use crate::plot::{Axis, Chart, Figure};
use crate::scene::flag_name;
use crate::study::pareto::front;
use crate::study::sweep::{Measurement, Spread};

/// Size of one diagram, points.
const CHART: [f64; 2] = [470.0, 420.0];

/// 99th percentile of the error, pixels, and time per camera ray, nanoseconds: what fronts are judged by.
fn trade(measurement: &Measurement) -> [f64; 2] {
    [of(measurement.errors.footprint, |spread| spread.p99), measurement.cost.ns_per_ray]
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
        "precision",
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
    let row = |(measurement, on_front): (&Measurement, bool)| {
        let Measurement { setting, errors, cost } = measurement;
        [
            mark(on_front),
            flag_name(setting.stepper),
            flag_name(setting.precision),
            setting.tolerance.map_or_else(|| "–".to_owned(), |tolerance| format!("{tolerance:e}")),
            flag_name(setting.schedule),
            error(errors.footprint, |spread| spread.median),
            error(errors.footprint, |spread| spread.p99),
            error(errors.position, |spread| spread.median),
            error(errors.position, |spread| spread.p99),
            percent(errors.differ),
            format!("{:.0}", cost.ns_per_ray),
            format!("{:.0}", cost.paths_per_second),
            format!("{:.2}", cost.steps_per_ray),
            format!("{:.2}", cost.queries_per_ray),
        ]
    };
    markdown(header, measurements.iter().zip(pareto(measurements)).map(row).collect())
}

/// Writes the measurements as rows; a cell without a value is empty.
///
/// # Errors
/// What `out` reports.
pub fn write_csv(measurements: &[Measurement], mut out: impl Write) -> io::Result<()> {
    writeln!(
        out,
        "stepper,precision,tolerance,schedule,rays,differ,position_rmse,position_median,position_p99,direction_rmse,\
         direction_median,direction_p99,footprint_rmse,footprint_median,footprint_p99,ns_per_ray,paths_per_second,\
         steps_per_ray,queries_per_ray,pareto"
    )?;
    for (measurement, on_front) in measurements.iter().zip(pareto(measurements)) {
        let Measurement { setting, errors, cost } = measurement;
        let mut cells = vec![
            flag_name(setting.stepper),
            flag_name(setting.precision),
            cell(setting.tolerance),
            flag_name(setting.schedule),
            errors.rays.to_string(),
            errors.differ.to_string(),
        ];
        for spread in [errors.position, errors.direction, errors.footprint] {
            cells.extend(
                [|s: Spread| s.rmse, |s: Spread| s.median, |s: Spread| s.p99]
                    .map(|value| cell(spread.map(value))),
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
    let schedules = measurements.iter().any(|m| m.setting.schedule != measurements[0].setting.schedule);
    let curve = |m: &Measurement| Curve {
        stepper: m.setting.stepper,
        precision: m.setting.precision,
        schedule: schedules.then_some(m.setting.schedule),
    };
    let chart = |title: &str, error: fn(&Spread) -> f64| {
        let point = |m: &Measurement| (curve(m), [of(m.errors.footprint, error), m.cost.ns_per_ray]);
        let points: Vec<(Curve, [f64; 2])> = measurements.iter().map(point).collect();
        Chart {
            title: title.to_owned(),
            x: Axis::log_around("error (pixels)", points.iter().map(|(_, [x, _])| *x)),
            y: Axis::log_around("time per camera ray (ns)", points.iter().map(|(_, [_, y])| *y)),
            size: CHART,
            series: over_front(&points),
        }
    };
    let charts = vec![
        chart("Median error", |spread| spread.median),
        chart("99th percentile of the error", |spread| spread.p99),
    ];
    Figure { charts }
}
