//! Diagrams for papers: drawn as SVG, and as PNG by rasterising that.
//!
//! [`Figure`] holds [`Diagram`]s side by side above one legend; a diagram holds [`DataSeries`] of curves between two
//! [`Axis`]. Colours are those of Okabe and Ito, which the colour-blind can tell apart too, and markers repeat what
//! they say.

mod axis;
mod diagram;
mod figure;
mod png;
mod style;
mod svg;

use std::io::{self, Write};
use std::path::Path;

pub use axis::Axis;
pub use diagram::{DataSeries, Diagram};
pub use figure::Figure;
pub use style::{Color, Style};

/// File format of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Vector graphics with live text.
    Svg,
    /// Pixels.
    Png,
}

impl Format {
    /// The format that the extension of `path` names.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        [("svg", Self::Svg), ("png", Self::Png)]
            .into_iter()
            .find(|(name, _)| *name == extension)
            .map(|(_, f)| f)
    }
}

impl Figure {
    /// Writes the figure.
    ///
    /// # Errors
    /// Errors of `out`, and [`io::ErrorKind::InvalidData`] if the figure cannot be rasterised.
    pub fn write(&self, format: Format, mut out: impl Write) -> io::Result<()> {
        let svg = self.svg();
        match format {
            Format::Svg => out.write_all(svg.as_bytes()),
            Format::Png => png::write(&svg, out),
        }
    }
}
