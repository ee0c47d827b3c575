//! OpenEXR environments: which of its channels are the sky, where, and in which colours.

use exr::meta::attribute::IntegerBounds;
use glam::Vec3;

use super::picture::{BYTES_PER_PIXEL, Picture, check_size, undecodable};
use crate::asset::exr::{Colours, ExrFile};
use crate::asset::flaw::Flaw;
use crate::asset::memory::Memory;
use crate::asset::notes::Notes;

/// Pixels of a picture from which it has to be filled, if sparsely: the rest of it is memory for nothing.
const LARGE: usize = 1 << 22;
/// Most pixels of a large picture for each that the file holds.
const SPARSE: usize = 1 << 10;

/// Decodes the colours of an OpenEXR file over its display window, black where it has none.
pub(super) fn decode(bytes: &[u8], memory: &Memory, notes: &mut Notes) -> Result<Picture, Flaw> {
    let file = ExrFile::open(bytes)?;
    let colours = file.colours()?;
    let (data, display) = (file.data_window(colours.part), file.display_window(colours.part));
    for window in [data, display] {
        window.validate(None).map_err(undecodable)?;
    }
    if file.is_cube_map(colours.part) {
        return Err(Flaw::new(
            "is a cube map",
            "convert it to a latitude-longitude picture, for instance with OpenEXR's exrenvmap",
        ));
    }
    let (width, height) = (display.size.width(), display.size.height());
    note_layer(&colours, notes);
    check_windows(data, display, notes)?;
    check_size(width, height, BYTES_PER_PIXEL, memory)?;

    let (left, top) = (offset(data, display, 0), offset(data, display, 1));
    let mut pixels = vec![Vec3::ZERO; width * height];
    file.read(colours.part, colours.channels.list(), memory, |slot, x, y, value| {
        let place = |at: usize, offset: i64, size: usize| {
            usize::try_from(at as i64 + offset).ok().filter(|at| *at < size)
        };
        if let (Some(x), Some(y)) = (place(x, left, width), place(y, top, height)) {
            pixels[y * width + x][slot] = value;
        }
    })?;
    let to_rgb = file.to_rgb(&colours);
    if !to_rgb.is_identity() {
        pixels.iter_mut().for_each(|pixel| *pixel = to_rgb.apply(*pixel));
    }
    if to_rgb.is_unclear() {
        notes.add("chromaticities that span no colour space are ignored", "all");
    }
    Ok(Picture { width, height, pixels, warnings: Vec::new() })
}

/// Offset of the data window's start from the display window's.
fn offset(data: IntegerBounds, display: IntegerBounds, axis: usize) -> i64 {
    let of = |window: IntegerBounds| [window.position.x(), window.position.y()][axis];
    i64::from(of(data)) - i64::from(of(display))
}

fn note_layer(colours: &Colours, notes: &mut Notes) {
    if !colours.layer.is_empty() && !colours.others.is_empty() {
        let others = colours.others.join(", ");
        notes.add(
            format!("of several layers with colours this one is used (beside {others})"),
            &colours.layer,
        );
    }
}

fn check_windows(data: IntegerBounds, display: IntegerBounds, notes: &mut Notes) -> Result<(), Flaw> {
    let (start, end) = (data.position, data.end());
    let (first, last) = (display.position, display.end());
    if end.x() <= first.x() || end.y() <= first.y() || start.x() >= last.x() || start.y() >= last.y() {
        return Err(Flaw::new(
            "its data window lies outside its display window",
            "save it again with all of its pixels",
        ));
    }
    let (shown, there) = (display.size.area(), data.size.area());
    if shown > LARGE && shown / there.max(1) > SPARSE {
        return Err(Flaw::new(
            format!(
                "its display window of {} × {} pixels is nearly all empty",
                display.size.0, display.size.1
            ),
            "save it again with all of its pixels",
        ));
    }
    let covers =
        start.x() <= first.x() && start.y() <= first.y() && end.x() >= last.x() && end.y() >= last.y();
    if !covers {
        let size = format!("{} × {}", data.size.width(), data.size.height());
        notes.add("its data window covers only a part of the picture, and the rest is black", size);
    }
    Ok(())
}
