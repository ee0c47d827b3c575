//! PNG from SVG.

use std::io::{self, Write};
use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::film::write_rgb8;

/// The characters of diagrams, so that pictures are the same on machines with other fonts, or none.
static FONT: &[u8] = include_bytes!("../../assets/fonts/DejaVuSans-subset.ttf");
/// Pixels per point.
const SCALE: f32 = 2.0;

/// Rasterises `svg` on white.
pub(super) fn write(svg: &str, out: impl Write) -> io::Result<()> {
    let invalid = |why: String| io::Error::new(io::ErrorKind::InvalidData, why);
    let mut options = Options::default();
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(FONT.to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let tree = Tree::from_str(svg, &options).map_err(|error| invalid(error.to_string()))?;
    let [width, height] =
        [tree.size().width(), tree.size().height()].map(|side| (SCALE * side).ceil() as u32);
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| invalid(format!("no picture of {width}x{height} pixels")))?;
    pixels.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    // Opaque, so that the premultiplied colours are the colours.
    let rgb: Vec<[u8; 3]> = pixels.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
    write_rgb8(&rgb, (width as usize, height as usize), out)
}
