//! What was measured of light sampling.

use std::io::{self, Write};

use clap::ValueEnum;

use super::{cell, markdown, with_error};
use crate::plot::{Axis, Chart, Figure, Series, Style};
use crate::scene::{LightSampling, flag_name};
use crate::study::estimate::Estimate;
use crate::study::lights::{Measurement, Way};

/// Size of one diagram, points.
const CHART: [f64; 2] = [470.0, 420.0];

/// The root of the mean square error, radiance; `None` where the reference's noise hides it.
fn rmse(measurement: &Measurement) -> Option<f64> {
    (measurement.mse.value > 0.0).then(|| measurement.mse.value.sqrt())
}

/// All measurements, and what each way gains, as two tables in Markdown.
pub fn table(ways: &[Way]) -> String {
    let header = [
        "light sampling",
        "spp",
        "seconds",
        "RMSE",
        "relMSE",
        "99.9 %",
        "mean/reference",
        "1/(MSE s)",
        "gain",
        "relative gain",
    ];
    let row = |m: &Measurement| {
        [
            flag_name(m.way),
            m.spp.to_string(),
            format!("{:.3}", m.seconds),
            scientific(rmse(m)),
            scientific(Some(m.relmse.value).filter(|relmse| *relmse > 0.0)),
            scientific(Some(m.p999)),
            with_error(m.mean),
            scientific(m.efficiency()),
            with_error(m.gain.absolute),
            with_error(m.gain.relative),
        ]
    };
    let all = markdown(header, ways.iter().flat_map(|way| &way.measurements).map(row).collect());
    let row = |way: &Way| [flag_name(way.way), with_error(way.gain.absolute), with_error(way.gain.relative)];
    let header = ["light sampling", "median gain", "median relative gain"];
    format!("{all}\n{}", markdown(header, ways.iter().map(row).collect()))
}

fn scientific(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2e}"))
}

/// Writes the measurements as rows; a cell without a value is empty.
///
/// # Errors
/// What `out` reports.
pub fn write_csv(ways: &[Way], mut out: impl Write) -> io::Result<()> {
    writeln!(
        out,
        "light_sampling,spp,seconds,mse,mse_error,rmse,relmse,relmse_error,p999,mean_ratio,mean_ratio_error,efficiency,\
         gain,gain_error,relative_gain,relative_gain_error,median_gain,median_gain_error,median_relative_gain,\
         median_relative_gain_error"
    )?;
    let pair = |estimate: Option<Estimate>| {
        [cell(estimate.map(|estimate| estimate.value)), cell(estimate.and_then(|estimate| estimate.error))]
    };
    for (way, m) in ways.iter().flat_map(|way| way.measurements.iter().map(move |m| (way, m))) {
        let mut cells = vec![flag_name(m.way), m.spp.to_string(), m.seconds.to_string()];
        cells.extend(pair(Some(m.mse)));
        cells.push(cell(rmse(m)));
        cells.extend(pair(Some(m.relmse)));
        cells.push(m.p999.to_string());
        cells.extend(pair(m.mean));
        cells.push(cell(m.efficiency()));
        let gains = [m.gain.absolute, m.gain.relative, way.gain.absolute, way.gain.relative];
        cells.extend(gains.into_iter().flat_map(pair));
        writeln!(out, "{}", cells.join(","))?;
    }
    Ok(())
}

/// Error over time and over samples, a curve per way.
pub fn figure(ways: &[Way]) -> Figure {
    let chart = |title: &str, label: &str, x: fn(&Measurement) -> f64| {
        let point = |m: &Measurement| rmse(m).map(|rmse| [x(m), rmse]);
        let series: Vec<Series> = ways
            .iter()
            .map(|way| Series {
                name: flag_name(way.way),
                style: style(way.way),
                curves: vec![way.measurements.iter().filter_map(point).collect()],
            })
            .collect();
        let along = |axis: usize| {
            series.iter().flat_map(|series| series.curves.iter().flatten()).map(move |point| point[axis])
        };
        Chart {
            title: title.to_owned(),
            x: Axis::log_around(label, along(0)),
            y: Axis::log_around("RMSE (radiance)", along(1)),
            size: CHART,
            series: series.clone(),
        }
    };
    let charts = vec![
        chart("Error over time", "time (s)", |m| m.seconds),
        chart("Error over samples", "samples per pixel", |m| f64::from(m.spp)),
    ];
    Figure { charts }
}

/// The same for a way whatever others are drawn.
fn style(way: LightSampling) -> Style {
    Style::nth(LightSampling::value_variants().iter().position(|&other| other == way).unwrap_or(0))
}
