//! Trade-offs of speed for accuracy: reports that mark their Pareto front, and a curve for each way to follow rays.

use super::pareto::front;
use super::report::Report;
use super::table::{Row, Table};
use crate::plot::{Chart, Color, Figure, Series, Style};
use crate::scene::{Precision, Schedule, StepperKind, flag_name};

/// Width of the line behind curves, points.
const BROAD: f64 = 12.0;

/// A measurement of cost and error.
pub(super) trait TradeOff: Sized {
    /// Error and cost that the front is judged by.
    fn place(&self) -> [f64; 2];
    /// Adds the cells that people read.
    fn printed(&self, row: Row) -> Row;
    /// The cells that programs read.
    fn row(&self) -> Row;
    /// Diagrams of all measurements.
    fn figure(all: &[Self]) -> Figure;
}

/// The report of `measurements`, of which those on the front are marked.
pub(super) fn report<M: TradeOff>(measurements: &[M]) -> Report {
    let on_front = front(&measurements.iter().map(M::place).collect::<Vec<_>>());
    let rows = || measurements.iter().zip(&on_front);
    let mark = |on_front: bool| if on_front { "*" } else { "" };
    Report {
        text: Table::of(rows().map(|(m, on)| m.printed(Row::default().cell("front", mark(*on))))).markdown(),
        table: Table::of(rows().map(|(m, on)| m.row().cell("pareto", u8::from(*on)))),
        figure: M::figure(measurements),
    }
}

/// What a curve is of.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Curve {
    pub(super) stepper: StepperKind,
    pub(super) precision: Precision,
    /// None where all curves have the same.
    pub(super) schedule: Option<Schedule>,
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

/// A chart of curves through `points` over their Pareto front.
pub(super) fn over_front(
    title: &str,
    labels: [&str; 2],
    size: [f64; 2],
    points: &[(Curve, [f64; 2])],
) -> Chart {
    let places: Vec<[f64; 2]> = points.iter().map(|(_, place)| *place).collect();
    let best = places.iter().zip(front(&places)).filter(|(_, on_front)| *on_front).map(|(place, _)| *place);
    Chart::log_log(title, labels, size, through(points)).over(broad("Pareto front", best.collect()))
}

/// A broad pale line through `points`, from left to right.
pub(super) fn broad(name: &str, mut points: Vec<[f64; 2]>) -> Series {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Series { name: name.to_owned(), style: Style::line(Color::PALE, BROAD), curves: vec![points] }
}

/// The curves through `points`; dashed ones are single precision.
pub(super) fn through(points: &[(Curve, [f64; 2])]) -> Vec<Series> {
    let mut series: Vec<Series> = Vec::new();
    // Both precisions of a stepper look alike but for the line.
    let (mut curves, mut pairs) = (Vec::new(), Vec::new());
    for &(curve, place) in points {
        let index = position(&mut curves, curve);
        if index == series.len() {
            let dashed = curve.precision == Precision::F32;
            let pair = position(&mut pairs, Curve { precision: Precision::F64, ..curve });
            let style = Style { dashed, ..Style::nth(pair) };
            series.push(Series { name: curve.name(), style, curves: vec![Vec::new()] });
        }
        series[index].curves[0].push(place);
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
