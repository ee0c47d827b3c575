//! Diagrams side by side over their legend.

use super::diagram::{DataSeries, Diagram, LABEL};
use super::style::Style;
use super::svg::{Align, Drawing, text_width};

/// Diagrams in a row with one legend: that of the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// From left to right.
    pub diagrams: Vec<Diagram>,
}

/// Length of a line in the legend, points.
const SAMPLE: f64 = 38.0;
/// From a line in the legend to its name, points.
const GAP: f64 = 8.0;
/// From a name in the legend to the next line, points.
const SPACING: f64 = 28.0;
/// Left and right of the legend, points.
const EDGE: f64 = 24.0;
/// Height of a row of the legend, points.
const ROW: f64 = 28.0;

impl Figure {
    /// The figure as an SVG document.
    pub(super) fn svg(&self) -> String {
        let mut drawing = Drawing::new();
        let (mut width, mut height) = (0.0, 0.0f64);
        for diagram in &self.diagrams {
            diagram.draw(&mut drawing, [width, 0.0]);
            let [w, h] = diagram.outer_size();
            (width, height) = (width + w, height.max(h));
        }
        let room = width - 2.0 * EDGE;
        let rows = rows(self.diagrams.first().map_or(&[], |diagram| &diagram.series), room);
        for (index, row) in rows.iter().enumerate() {
            let y = height + (index as f64 + 0.5) * ROW;
            let mut x = EDGE + 0.5 * (room - row_width(row)).max(0.0);
            for series in row {
                sample([x, y], series.style, &mut drawing);
                let baseline = [x + SAMPLE + GAP, y + 0.36 * LABEL];
                drawing.text(baseline, LABEL, Align::Start, false, &series.name);
                x += entry_width(series) + SPACING;
            }
        }
        drawing.finish([width, height + rows.len() as f64 * ROW + 0.5 * ROW])
    }
}

/// A short piece of a series.
fn sample([x, y]: [f64; 2], style: Style, drawing: &mut Drawing) {
    if style.filled {
        let (a, b) = (x + 0.25 * SAMPLE, x + 0.75 * SAMPLE);
        drawing.curve(&[[a, y - 8.0], [b, y - 8.0], [b, y + 8.0], [a, y + 8.0]], style);
    } else {
        drawing.line([x, y], [x + SAMPLE, y], style);
        drawing.curve(&[[x + 0.5 * SAMPLE, y]], Style { width: 0.0, ..style });
    }
}

fn entry_width(series: &DataSeries) -> f64 {
    SAMPLE + GAP + text_width(&series.name, LABEL)
}

fn row_width(row: &[&DataSeries]) -> f64 {
    row.iter().map(|series| entry_width(series)).sum::<f64>() + SPACING * row.len().saturating_sub(1) as f64
}

/// The named series in rows no wider than `room`, unless by a single name.
fn rows(series: &[DataSeries], room: f64) -> Vec<Vec<&DataSeries>> {
    let mut rows: Vec<Vec<&DataSeries>> = Vec::new();
    for series in series.iter().filter(|series| !series.name.is_empty()) {
        match rows.last_mut() {
            Some(row) if row_width(row) + SPACING + entry_width(series) <= room => row.push(series),
            _ => rows.push(vec![series]),
        }
    }
    rows
}
