//! A finished picture: named f32 planes, ready to be written.

/// Names of the channels that every image has.
pub const BEAUTY: [&str; 4] = ["R", "G", "B", "A"];

/// One named channel of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Channel name as it appears in the EXR, e.g. `R`, `normal.X`.
    pub name: String,
    /// Row-major values, row 0 at the top.
    pub values: Vec<f32>,
}

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width of the whole picture, pixels.
    pub width: usize,
    /// Height of the whole picture, pixels.
    pub height: usize,
    /// First column and row of the data window; planes hold only the data window.
    pub origin: (usize, usize),
    /// Size of the data window.
    pub size: (usize, usize),
    /// `R`, `G`, `B`, `A`, then what was asked for.
    pub planes: Vec<Plane>,
    /// Header attributes as name and text: samples per pixel, seed, entity names (`entity.N`, N as in the entity plane).
    pub attributes: Vec<(String, String)>,
}

impl Image {
    /// The values of the plane called `name`, row-major over the data window.
    pub fn plane(&self, name: &str) -> Option<&[f32]> {
        self.planes.iter().find(|plane| plane.name == name).map(|plane| plane.values.as_slice())
    }

    /// True if the data window is a part of the picture and every plane fills it.
    pub fn is_consistent(&self) -> bool {
        let fits = |start: usize, size: usize, whole: usize| size > 0 && start + size <= whole;
        fits(self.origin.0, self.size.0, self.width)
            && fits(self.origin.1, self.size.1, self.height)
            && self.planes.iter().all(|plane| plane.values.len() == self.size.0 * self.size.1)
    }
}
