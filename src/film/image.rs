//! A finished picture: named f32 channels, ready to be written.

/// Names of the channels that every image has.
pub const BEAUTY: [&str; 4] = ["R", "G", "B", "A"];

/// One named channel of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
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
    /// First column and row of the data window; channels hold only the data window.
    pub origin: (usize, usize),
    /// Size of the data window.
    pub size: (usize, usize),
    /// `R`, `G`, `B`, `A`, then what was asked for.
    pub channels: Vec<Channel>,
    /// Header attributes as name and text: samples per pixel, seed, entity names (`entity.N`, N as in the entity
    /// channel).
    pub attributes: Vec<(String, String)>,
}

impl Image {
    /// The values of the channel called `name`, row-major over the data window.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| channel.values.as_slice())
    }

    /// True if the data window is a part of the picture and every channel fills it.
    pub fn is_consistent(&self) -> bool {
        let fits = |start: usize, size: usize, whole: usize| size > 0 && start + size <= whole;
        fits(self.origin.0, self.size.0, self.width)
            && fits(self.origin.1, self.size.1, self.height)
            && self.channels.iter().all(|channel| channel.values.len() == self.size.0 * self.size.1)
    }
}
