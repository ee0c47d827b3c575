//! Trade-offs of speed for accuracy: reports that mark their Pareto front, and a curve for each way to follow rays.

use super::pareto::front;
use super::report::Report;
use super::table::{Table, TableRow};
use super::way::Way;
use crate::plot::{Color, DataSeries, Diagram, Figure, Style};
use crate::scene::{Precision, flag_name};

/// Width of the line behind curves, points.
const BROAD: f64 = 12.0;

/// A measurement of cost and error.
pub(super) trait TradeOff: Sized {
    /// The way that was measured.
    fn way(&self) -> Way;
    /// Error and cost that the front is judged by.
    fn place(&self) -> [f64; 2];
    /// Adds the cells that people read, after those of the way.
    fn printed(&self, row: TableRow) -> TableRow;
    /// Adds the cells that programs read.
    fn row(&self, row: TableRow) -> TableRow;
    /// Diagrams of all measurements.
    fn figure(all: &[Self]) -> Figure;
}

/// The report of `measurements`, of which those on the front are marked.
pub(super) fn report<M: TradeOff>(measurements: &[M]) -> Report {
    let on_front = front(&measurements.iter().map(M::place).collect::<Vec<_>>());
    let rows = || measurements.iter().zip(&on_front);
    let printed = |(m, on): (&M, &bool)| {
        let row = TableRow::default().cell("front", if *on { "*" } else { "" });
        m.printed(m.way().printed(row))
    };
    let row = |(m, on): (&M, &bool)| m.row(m.way().row(TableRow::default())).cell("pareto", u8::from(*on));
    Report {
        text: Table::of(rows().map(printed)).markdown(),
        table: Table::of(rows().map(row)),
        figure: M::figure(measurements),
    }
}

/// A diagram of curves through `points` over their Pareto front.
pub(super) fn over_front(
    title: &str,
    labels: [&str; 2],
    size: [f64; 2],
    points: &[(Way, [f64; 2])],
) -> Diagram {
    let places: Vec<[f64; 2]> = points.iter().map(|(_, place)| *place).collect();
    let best = places.iter().zip(front(&places)).filter(|(_, on_front)| *on_front).map(|(place, _)| *place);
    Diagram::log_log(title, labels, size, through(points)).over(broad("Pareto front", best.collect()))
}

/// A broad pale line through `points`, from left to right.
pub(super) fn broad(name: &str, mut points: Vec<[f64; 2]>) -> DataSeries {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    DataSeries { name: name.to_owned(), style: Style::line(Color::PALE, BROAD), curves: vec![points] }
}

/// A curve for each way but for tolerances through `points`; dashed ones are single precision.
pub(super) fn through(points: &[(Way, [f64; 2])]) -> Vec<DataSeries> {
    let schedules = points.iter().any(|(way, _)| way.schedule != points[0].0.schedule);
    let mut series: Vec<DataSeries> = Vec::new();
    // Both precisions of a stepper look alike but for the line.
    let (mut curves, mut pairs) = (Vec::new(), Vec::new());
    for &(way, place) in points {
        let curve = Way { tolerance: None, ..way };
        let index = position(&mut curves, curve);
        if index == series.len() {
            let dashed = curve.precision == Precision::F32;
            let pair = position(&mut pairs, Way { precision: Precision::F64, ..curve });
            let schedule =
                curve.schedule.filter(|_| schedules).map(|schedule| format!(", {}", flag_name(schedule)));
            let single = if dashed { " f32" } else { "" };
            series.push(DataSeries {
                name: format!("{}{single}{}", flag_name(curve.stepper), schedule.unwrap_or_default()),
                style: Style { dashed, ..Style::nth(pair) },
                curves: vec![Vec::new()],
            });
        }
        series[index].curves[0].push(place);
    }
    series
}

/// Index of `way` among `known`, to which it is added if it is not there.
fn position(known: &mut Vec<Way>, way: Way) -> usize {
    known.iter().position(|&other| other == way).unwrap_or_else(|| {
        known.push(way);
        known.len() - 1
    })
}
