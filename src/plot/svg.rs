//! SVG as text.

use std::fmt::{Display, Write};

use super::style::{Marker, Style};

/// Alignment of a text relative to its anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Start,
    Middle,
    End,
}

/// A drawing in points, origin at the top left.
pub(super) struct Drawing {
    body: String,
    clips: usize,
}

/// Size of a marker, points: half its height.
const MARKER: f64 = 5.0;
/// Gaps and dashes of broken lines, points.
const DASHES: &str = "7 5";

impl Drawing {
    pub(super) fn new() -> Self {
        Self { body: String::new(), clips: 0 }
    }

    /// The document, on white.
    pub(super) fn finish(self, [width, height]: [f64; 2]) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"DejaVu Sans, Verdana, sans-serif\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n{}</svg>\n",
            self.body
        )
    }

    /// One element.
    fn element(&mut self, text: impl Display) {
        // Writing to a string does not fail.
        let _ = writeln!(self.body, "{text}");
    }

    /// Clips what `draw` draws at a box.
    pub(super) fn clipped(&mut self, [x, y, w, h]: [f64; 4], draw: impl FnOnce(&mut Self)) {
        self.clips += 1;
        let id = self.clips;
        self.element(format_args!(
            "<clipPath id=\"box{id}\"><rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{w:.2}\" height=\"{h:.2}\"/></clipPath>"
        ));
        self.element(format_args!("<g clip-path=\"url(#box{id})\">"));
        draw(self);
        self.element("</g>");
    }

    /// A straight line.
    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], style: Style) {
        self.curve(&[from, to], Style { marker: None, ..style });
    }

    /// A box's edges.
    pub(super) fn frame(&mut self, [x, y, w, h]: [f64; 4], style: Style) {
        let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]];
        self.curve(&corners, style);
    }

    /// A polygonal line with its area and markers, as its style says.
    pub(super) fn curve(&mut self, points: &[[f64; 2]], style: Style) {
        let Style { color, width, dashed, filled, marker } = style;
        if width > 0.0 || filled {
            let mut path = String::new();
            for (index, [x, y]) in points.iter().enumerate() {
                let _ = write!(path, "{}{x:.2} {y:.2}", if index == 0 { "M" } else { "L" });
            }
            let fill = if filled { color.0 } else { "none" };
            let stroke = if width > 0.0 { color.0 } else { "none" };
            let dashes = if dashed { format!(" stroke-dasharray=\"{DASHES}\"") } else { String::new() };
            self.element(format_args!(
                "<path d=\"{path}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"{width}\" \
                 stroke-linejoin=\"round\"{dashes}/>"
            ));
        }
        if let Some(marker) = marker {
            points.iter().for_each(|&at| self.marker(at, marker, style));
        }
    }

    fn marker(&mut self, [x, y]: [f64; 2], marker: Marker, Style { color, .. }: Style) {
        let (m, d) = (MARKER, 0.7 * MARKER);
        let path = match marker {
            Marker::Circle => {
                format!("M{:.2} {y:.2}a{m} {m} 0 1 0 {} 0a{m} {m} 0 1 0 -{} 0Z", x - m, 2.0 * m, 2.0 * m)
            }
            Marker::Square => {
                format!("M{:.2} {:.2}h{}v{}h-{}Z", x - 0.9 * m, y - 0.9 * m, 1.8 * m, 1.8 * m, 1.8 * m)
            }
            Marker::Triangle => format!("M{x:.2} {:.2}l{m} {}h-{}Z", y - 1.1 * m, 1.9 * m, 2.0 * m),
            Marker::TriangleDown => format!("M{x:.2} {:.2}l{m} -{}h-{}Z", y + 1.1 * m, 1.9 * m, 2.0 * m),
            Marker::Diamond => {
                let m = 1.2 * m;
                format!("M{x:.2} {:.2}l{m} {m}l-{m} {m}l-{m} -{m}Z", y - m)
            }
            Marker::Plus => format!("M{:.2} {y:.2}h{}M{x:.2} {:.2}v{}", x - m, 2.0 * m, y - m, 2.0 * m),
            Marker::Cross => {
                let (left, top, side) = (x - d, y - d, 2.0 * d);
                format!("M{left:.2} {top:.2}l{side} {side}M{left:.2} {:.2}l{side} -{side}", y + d)
            }
        };
        let open = matches!(marker, Marker::Plus | Marker::Cross);
        let (fill, stroke, width) = if open { ("none", color.0, 2.2) } else { (color.0, "#FFFFFF", 0.8) };
        self.element(format_args!(
            "<path d=\"{path}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"{width}\"/>"
        ));
    }

    /// A line of text with its baseline at `y`, turned to read upwards if `upwards`.
    pub(super) fn text(&mut self, [x, y]: [f64; 2], size: f64, align: Align, upwards: bool, text: &str) {
        let anchor = match align {
            Align::Start => "start",
            Align::Middle => "middle",
            Align::End => "end",
        };
        let turn = if upwards { format!(" transform=\"rotate(-90 {x:.2} {y:.2})\"") } else { String::new() };
        self.element(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\"{turn}>{}</text>",
            escaped(text)
        ));
    }
}

/// The width of a text, points, roughly.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let advance = |character| match character {
        'f' | 'i' | 'j' | 'l' | 'r' | 't' | 'I' | ' ' | '.' | ',' | '(' | ')' | '-' => 0.36,
        'm' | 'w' | 'M' | 'W' => 0.92,
        _ => 0.62,
    };
    size * text.chars().map(advance).sum::<f64>()
}

/// Text as XML spells it; characters that XML does not have are dropped.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '\u{FFFE}' | '\u{FFFF}' => {}
            character if character.is_control() => out.push(' '),
            character => out.push(character),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_loses_what_xml_does_not_have() {
        assert_eq!(escaped("a<b>&c\u{1}\u{FFFF}d"), "a&lt;b&gt;&amp;c d");
    }
}
