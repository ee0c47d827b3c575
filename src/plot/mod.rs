//! Diagrams for papers: drawn as SVG, and as PNG by rasterising that.
//!
//! [`Figure`] holds [`Diagram`]s side by side above one legend; a diagram holds [`DataSeries`] of curves between two
//! [`Axis`]. Colours are those of Okabe and Ito, which the colour-blind can tell apart too, and markers repeat what
//! they say.
//!
//! Plot crate: plotters 0.3.7 was tried on two figures, `assets/readme/cornell_study.svg` and `rays.svg`. It costs
//! little (3 more crates, MIT, 3 s of CPU time in a debug build), keeps text live and writes the same bytes every time,
//! but draws worse. Coordinates are whole pixels: curves show steps, worse in its bitmaps. Points outside the frame are
//! moved onto it instead of clipped: rays that leave run along its edge. Logarithmic axes label 9.999999999999999e-5,
//! over their neighbours, and nothing below the first power of ten; minor ticks have no marks. The legend lies over the
//! curves of one diagram; equal scales are up to the caller. With scaled coordinates, ticks, markers, clipping and the
//! legend written here, about 450 of the 680 lines would stay.

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
