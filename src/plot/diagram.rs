//! Diagram: axes and curves.

use super::axis::Axis;
use super::style::{Color, Style};
use super::svg::{Align, Drawing};

/// Curves that look alike and share a line in the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct DataSeries {
    /// Name in the legend; empty to leave it out.
    pub name: String,
    /// Style of its curves.
    pub style: Style,
    /// Points of each curve, in values of the axes.
    pub curves: Vec<Vec<[f64; 2]>>,
}

/// Curves between two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagram {
    /// Above the frame.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// Width and height of the frame, points.
    pub size: [f64; 2],
    /// Later ones are drawn over earlier ones.
    pub series: Vec<DataSeries>,
}

/// Around the frame, points: left, top, right, bottom.
const MARGIN: [f64; 4] = [92.0, 46.0, 24.0, 66.0];
/// Sizes of type, points.
pub(super) const LABEL: f64 = 17.0;
const TITLE: f64 = 18.0;
const TICK: f64 = 15.0;
/// Lengths of ticks, points.
const MAJOR: f64 = 7.0;
const MINOR: f64 = 4.0;
const EDGE: Style = Style::line(Color::BLACK, 1.2);
const GRID: Style = Style::line(Color("#E6E6E6"), 1.0);

impl Diagram {
    /// A diagram with logarithmic axes around all points of `series`.
    pub fn log_log(title: &str, [x, y]: [&str; 2], size: [f64; 2], series: Vec<DataSeries>) -> Self {
        let points = || series.iter().flat_map(|series| series.curves.iter().flatten());
        let x = Axis::log_around(x, points().map(|[x, _]| *x));
        let y = Axis::log_around(y, points().map(|[_, y]| *y));
        Self { title: title.to_owned(), x, y, size, series }
    }

    /// The diagram with `line` behind all that it has.
    #[must_use]
    pub fn over(mut self, line: DataSeries) -> Self {
        self.series.insert(0, line);
        self
    }

    /// Size with all margins.
    pub(super) fn outer_size(&self) -> [f64; 2] {
        let [left, top, right, bottom] = MARGIN;
        [left + self.size[0] + right, top + self.size[1] + bottom]
    }

    /// Draws the diagram with its outer corner at `corner`.
    pub(super) fn draw(&self, drawing: &mut Drawing, corner: [f64; 2]) {
        let (left, top) = (corner[0] + MARGIN[0], corner[1] + MARGIN[1]);
        let [width, height] = self.size;
        let bottom = top + height;
        let x = |value: f64| left + width * self.x.at(value);
        let y = |value: f64| bottom - height * self.y.at(value);
        let (x_ticks, y_ticks) = (self.x.ticks(width), self.y.ticks(height));
        for tick in x_ticks.iter().filter(|tick| tick.label.is_some()) {
            drawing.line([x(tick.value), top], [x(tick.value), bottom], GRID);
        }
        for tick in y_ticks.iter().filter(|tick| tick.label.is_some()) {
            drawing.line([left, y(tick.value)], [left + width, y(tick.value)], GRID);
        }
        drawing.clipped([left, top, width, height], |drawing| {
            for series in &self.series {
                for curve in &series.curves {
                    let places: Vec<[f64; 2]> = curve
                        .iter()
                        .map(|&[a, b]| [x(a), y(b)])
                        .filter(|place| place.iter().all(|c| c.is_finite()))
                        .collect();
                    drawing.curve(&places, series.style);
                }
            }
        });
        drawing.frame([left, top, width, height], EDGE);
        for tick in &x_ticks {
            let length = if tick.label.is_some() { MAJOR } else { MINOR };
            drawing.line([x(tick.value), bottom], [x(tick.value), bottom - length], EDGE);
            if let Some(label) = &tick.label {
                drawing.text([x(tick.value), bottom + 1.35 * TICK], TICK, Align::Middle, false, label);
            }
        }
        for tick in &y_ticks {
            let length = if tick.label.is_some() { MAJOR } else { MINOR };
            drawing.line([left, y(tick.value)], [left + length, y(tick.value)], EDGE);
            if let Some(label) = &tick.label {
                drawing.text([left - 8.0, y(tick.value) + 0.36 * TICK], TICK, Align::End, false, label);
            }
        }
        let middle = left + 0.5 * width;
        drawing.text([middle, top - 16.0], TITLE, Align::Middle, false, &self.title);
        drawing.text([middle, bottom + 50.0], LABEL, Align::Middle, false, &self.x.label);
        drawing.text([left - 68.0, top + 0.5 * height], LABEL, Align::Middle, true, &self.y.label);
    }
}
