//! Measurements for people and papers: tables, CSV, diagrams.

pub mod bench;
pub mod ends;
pub mod lights;
pub mod scene;

use super::estimate::Estimate;
use super::pareto::front;
use super::sweep::Spread;
use crate::plot::{Color, Series, Style};
use crate::scene::{Precision, Schedule, StepperKind, flag_name};

/// Width of the line under a front, points.
const FRONT: f64 = 12.0;

/// A value of an error for which there may be none.
fn of(spread: Option<Spread>, value: fn(&Spread) -> f64) -> f64 {
    spread.as_ref().map_or(f64::NAN, value)
}

/// An error in a table.
fn error(spread: Option<Spread>, value: fn(&Spread) -> f64) -> String {
    spread.as_ref().map_or_else(|| "–".to_owned(), |spread| format!("{:.1e}", value(spread)))
}

/// A share in a table.
fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// A cell of a CSV file, empty without a value.
fn cell(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// `0.6703 ± 0.0052`: two digits of the error, or three of a value without one.
fn with_error(estimate: Option<Estimate>) -> String {
    let Some(Estimate { value, error }) = estimate else { return "–".to_owned() };
    let decimals =
        |number: f64, digits: f64| (digits - 1.0 - libm::log10(number.abs()).floor()).clamp(0.0, 9.0);
    match error {
        Some(error) if error > 0.0 => {
            let decimals = decimals(error, 2.0) as usize;
            format!("{value:.decimals$} ± {error:.decimals$}")
        }
        _ => format!("{value:.0$}", decimals(value, 3.0) as usize),
    }
}

/// What marks a row of a table.
fn mark(on_front: bool) -> String {
    if on_front { "*" } else { "" }.to_owned()
}

/// A table in Markdown.
fn markdown<const N: usize>(header: [&str; N], rows: Vec<[String; N]>) -> String {
    let rows: Vec<[String; N]> = [header.map(str::to_owned)].into_iter().chain(rows).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..N).map(width).collect();
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut lines: Vec<String> = rows
        .iter()
        .map(|row| line(row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:>width$}")).collect()))
        .collect();
    lines.insert(1, line(widths.iter().map(|&width| format!("{}:", "-".repeat(width - 1))).collect()));
    lines.concat()
}

/// What a curve is of.
#[derive(Clone, Copy, PartialEq)]
struct Curve {
    stepper: StepperKind,
    precision: Precision,
    /// None where all curves have the same.
    schedule: Option<Schedule>,
}

impl Curve {
    fn name(self) -> String {
        let precision = match self.precision {
            Precision::F32 => " f32",
            Precision::F64 => "",
        };
        let schedule =
            self.schedule.map_or_else(String::new, |schedule| format!(", {}", flag_name(schedule)));
        format!("{}{precision}{schedule}", flag_name(self.stepper))
    }
}

/// The curves through `points` over their Pareto front.
fn over_front(points: &[(Curve, [f64; 2])]) -> Vec<Series> {
    let places: Vec<[f64; 2]> = points.iter().map(|(_, place)| *place).collect();
    let on_front = front(&places);
    let mut best: Vec<[f64; 2]> =
        places.iter().zip(on_front).filter(|(_, on)| *on).map(|(place, _)| *place).collect();
    best.sort_by(|a, b| a[0].total_cmp(&b[0]));
    over("Pareto front", best, points)
}

/// The curves through `points` over a broad line; broken lines are single precision.
fn over(name: &str, line: Vec<[f64; 2]>, points: &[(Curve, [f64; 2])]) -> Vec<Series> {
    let mut series =
        vec![Series { name: name.to_owned(), style: Style::line(Color::PALE, FRONT), curves: vec![line] }];
    // Both precisions of a stepper look alike but for the line.
    let mut curves: Vec<Curve> = Vec::new();
    let mut pairs: Vec<Curve> = Vec::new();
    for &(curve, place) in points {
        let index = position(&mut curves, curve);
        if index + 1 == series.len() {
            let dashed = curve.precision == Precision::F32;
            let pair = position(&mut pairs, Curve { precision: Precision::F64, ..curve });
            let style = Style { dashed, ..Style::nth(pair) };
            series.push(Series { name: curve.name(), style, curves: vec![Vec::new()] });
        }
        series[index + 1].curves[0].push(place);
    }
    series
}

/// Where `curve` is among `known`, to which it is added if it is not.
fn position(known: &mut Vec<Curve>, curve: Curve) -> usize {
    known.iter().position(|&other| other == curve).unwrap_or_else(|| {
        known.push(curve);
        known.len() - 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_digits_that_their_errors_leave() {
        let text = |value, error| with_error(Some(Estimate { value, error }));
        assert_eq!(text(0.670_34, Some(0.005_21)), "0.6703 ± 0.0052");
        assert_eq!(text(1234.5, Some(120.0)), "1234 ± 120");
        assert_eq!(text(12.345, None), "12.3");
        assert_eq!(text(1.0, Some(0.0)), "1.00");
        assert_eq!(with_error(None), "–");
    }
}
