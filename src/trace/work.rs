//! What is to be done: the job as a whole, and one tile's share of a pass.

use super::illumination::Illumination;
use crate::scene::{Baked, Settings};
use crate::shade::Sampler;

/// What every kernel may read.
pub struct Job<'a> {
    /// The baked scene.
    pub scene: &'a Baked,
    /// Its settings.
    pub settings: &'a Settings,
    /// Random numbers.
    pub sampler: Sampler,
    /// Light sampling, if any.
    pub illumination: Option<Illumination>,
}

/// Some samples of every pixel of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Work {
    /// First column and row.
    pub origin: (usize, usize),
    /// Columns and rows.
    pub size: (usize, usize),
    /// First sample.
    pub first_sample: u32,
    /// Samples per pixel.
    pub samples: u32,
}

impl Work {
    /// Camera paths in all.
    pub fn paths(&self) -> u32 {
        (self.size.0 * self.size.1) as u32 * self.samples
    }

    /// Image column and row of the tile's pixel `index`.
    pub fn pixel(&self, index: u32) -> (usize, usize) {
        let index = index as usize;
        (self.origin.0 + index % self.size.0, self.origin.1 + index / self.size.0)
    }
}
