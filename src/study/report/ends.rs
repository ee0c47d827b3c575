//! What was measured on rays that nothing is in the way of.

use std::io::{self, Write};

use super::{Curve, cell, error, mark, markdown, of, over, over_front, percent};
use crate::plot::{Axis, Chart, Figure};
use crate::scene::flag_name;
use crate::study::ends::Measurement;
use crate::study::pareto::front;

/// Size of one diagram, points.
const CHART: [f64; 2] = [520.0, 460.0];

/// 99th percentile of the error of direction at the start, radians, and time per ray, nanoseconds: what fronts are judged
/// by.
fn trade(measurement: &Measurement) -> [f64; 2] {
    [of(measurement.errors.direction_over_sens, |spread| spread.p99), measurement.ns_per_ray]
}

/// Which measurements are on the front of error (99th percentile of angle over sensitivity) against time per ray.
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
        "median/sens",
        "99 %/sens",
        "max/sens",
        "above tolerance",
        "worst",
        "wrong fate",
        "ns/ray",
        "steps/ray",
    ];
    let row = |(measurement, on_front): (&Measurement, bool)| {
        let Measurement { setting, errors, ns_per_ray, steps_per_ray } = measurement;
        let none = || "–".to_owned();
        [
            mark(on_front),
            flag_name(setting.stepper),
            flag_name(setting.precision),
            format!("{:e}", setting.tolerance),
            error(errors.direction_over_sens, |spread| spread.median),
            error(errors.direction_over_sens, |spread| spread.p99),
            error(errors.direction_over_sens, |spread| spread.max),
            errors.honesty.map_or_else(none, |honesty| percent(honesty.above)),
            errors.honesty.map_or_else(none, |honesty| format!("{:.2}", honesty.worst)),
            percent(errors.differ),
            format!("{ns_per_ray:.0}"),
            format!("{steps_per_ray:.2}"),
        ]
    };
    markdown(header, measurements.iter().zip(pareto(measurements)).map(row).collect())
}

/// Writes the measurements as rows; a cell without a value is empty.
///
/// # Errors
/// What `out` reports.
pub fn write_csv(measurements: &[Measurement], mut out: impl Write) -> io::Result<()> {
    let mut header: Vec<String> =
        ["stepper", "precision", "tolerance", "rays", "compared", "differ"].map(str::to_owned).to_vec();
    for error in ["direction", "direction_over_sens", "position", "position_over_sens"] {
        header.extend(["median", "p99", "max"].map(|value| format!("{error}_{value}")));
    }
    let rest = ["above_tolerance", "worst_over_tolerance", "ns_per_ray", "steps_per_ray", "pareto"];
    writeln!(out, "{},{}", header.join(","), rest.join(","))?;
    for (measurement, on_front) in measurements.iter().zip(pareto(measurements)) {
        let Measurement { setting, errors, ns_per_ray, steps_per_ray } = measurement;
        let mut cells = vec![
            flag_name(setting.stepper),
            flag_name(setting.precision),
            setting.tolerance.to_string(),
            errors.rays.to_string(),
            errors.compared.to_string(),
            errors.differ.to_string(),
        ];
        let all = [errors.direction, errors.direction_over_sens, errors.position, errors.position_over_sens];
        for spread in all {
            cells.push(cell(spread.map(|spread| spread.median)));
            cells.push(cell(spread.map(|spread| spread.p99)));
            cells.push(cell(spread.map(|spread| spread.max)));
        }
        cells.push(cell(errors.honesty.map(|honesty| honesty.above)));
        cells.push(cell(errors.honesty.map(|honesty| honesty.worst)));
        cells.extend([ns_per_ray.to_string(), steps_per_ray.to_string()]);
        writeln!(out, "{},{}", cells.join(","), u8::from(on_front))?;
    }
    Ok(())
}

/// Work against precision, time per ray over the 99th percentile of the error; and the largest error over the tolerance.
pub fn figure(measurements: &[Measurement]) -> Figure {
    let curve = |m: &Measurement| Curve {
        stepper: m.setting.stepper,
        precision: m.setting.precision,
        schedule: None,
    };
    let chart = |title: &str, [x, y]: [&str; 2], points: &[(Curve, [f64; 2])], series| Chart {
        title: title.to_owned(),
        x: Axis::log_around(x, points.iter().map(|(_, [x, _])| *x)),
        y: Axis::log_around(y, points.iter().map(|(_, [_, y])| *y)),
        size: CHART,
        series,
    };
    let work: Vec<(Curve, [f64; 2])> = measurements.iter().map(|m| (curve(m), trade(m))).collect();
    let largest = |m: &Measurement| of(m.errors.direction_over_sens, |spread| spread.max);
    let kept: Vec<(Curve, [f64; 2])> =
        measurements.iter().map(|m| (curve(m), [m.setting.tolerance, largest(m)])).collect();
    let mut allowed: Vec<[f64; 2]> = kept.iter().map(|(_, [tolerance, _])| [*tolerance; 2]).collect();
    allowed.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let charts = vec![
        chart(
            "Work and precision, 99 % of the rays",
            ["angle at the end / sens (radians)", "time per ray (ns)"],
            &work,
            over_front(&work),
        ),
        chart(
            "Largest error (grey: the tolerance)",
            ["tolerance (radians)", "angle at the end / sens (radians)"],
            &kept,
            over("error = tolerance", allowed, &kept),
        ),
    ];
    Figure { charts }
}
