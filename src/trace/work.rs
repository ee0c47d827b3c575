//! What is to be done: the job as a whole, and one tile's share of a pass.

use super::edges::Edges;
use super::illumination::Illumination;
use super::path::Gathers;
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

/// Some samples of the pixels of a tile.
#[derive(Clone, Copy)]
pub struct Work<'a> {
    /// First column and row.
    pub origin: (usize, usize),
    /// Columns and rows.
    pub size: (usize, usize),
    /// First sample.
    pub first_sample: u32,
    /// Samples per pixel.
    pub samples: u32,
    /// What the paths gather, and in which pixels.
    pub share: Share<'a>,
}

/// Which pixels' light is gathered by a piece of work, and which part of it.
#[derive(Clone, Copy)]
pub enum Share<'a> {
    /// All light; in pixels at the edges of lamps, all but what the camera sees of lamps.
    Whole(&'a Edges),
    /// What the camera sees of lamps, in pixels at their edges.
    Edges(&'a Edges),
    /// What the camera sees of lamps, in all pixels.
    Lamps,
}

impl Work<'_> {
    /// Camera paths in all.
    pub fn paths(&self) -> u32 {
        let pixels = match self.share {
            Share::Edges(edges) => edges.pixels().len(),
            Share::Whole(_) | Share::Lamps => self.size.0 * self.size.1,
        };
        pixels as u32 * self.samples
    }

    /// Image column and row of path `index`, and what it gathers.
    pub fn path(&self, index: u32) -> ((usize, usize), Gathers) {
        let number = index / self.samples;
        let (pixel, gathers) = match self.share {
            Share::Whole(edges) if edges.holds(number) => (number, Gathers::Beyond),
            Share::Whole(_) => (number, Gathers::All),
            Share::Edges(edges) => (edges.pixels()[number as usize], Gathers::Lamps),
            Share::Lamps => (number, Gathers::Lamps),
        };
        let pixel = pixel as usize;
        ((self.origin.0 + pixel % self.size.0, self.origin.1 + pixel / self.size.0), gathers)
    }
}
