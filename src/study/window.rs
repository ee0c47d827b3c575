//! A part of a picture.

use serde::Serialize;

/// A rectangle of pixels, counted from the top left corner of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Window {
    /// First column and row.
    pub origin: (usize, usize),
    /// Width and height, pixels.
    pub size: (usize, usize),
}
