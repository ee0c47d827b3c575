//! A half-finished render as plain data: what a checkpoint has to hold.

use super::learn::lamp_edges::LampEdges;
use super::run::Run;
use super::tile::{self, Tile};
use crate::film::{Aov, Image, Wanted};
use crate::scene::Settings;

/// Sums over the samples so far, and the edges of lamps found so far, of each tile of a picture. All else that a render
/// works with follows from the scene.
pub struct State {
    frame: Frame,
    tiles: Vec<TileState>,
}

/// The pixels that are rendered, and what is summed for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Frame {
    /// Width and height of the whole picture.
    picture: (usize, usize),
    /// First column and row that are rendered.
    origin: (usize, usize),
    /// Columns and rows that are rendered.
    size: (usize, usize),
    wanted: Wanted,
    seed: u64,
}

/// State of a tile.
pub(super) struct TileState {
    pub tile: Tile,
    pub edges: LampEdges,
}

impl Frame {
    fn new(settings: &Settings, run: &Run) -> Self {
        let [x0, y0, x1, y1] = run.crop.unwrap_or([0, 0, settings.width, settings.height]);
        Self {
            picture: (settings.width, settings.height),
            origin: (x0, y0),
            size: (x1 - x0, y1 - y0),
            wanted: Wanted::new(&run.aovs, run.noise.is_some()),
            seed: settings.seed,
        }
    }

    fn image(&self) -> Image {
        let ((width, height), channels, attributes) = (self.picture, Vec::new(), Vec::new());
        Image { width, height, origin: self.origin, size: self.size, channels, attributes }
    }
}

impl State {
    /// A picture without samples.
    pub(super) fn new(settings: &Settings, run: &Run) -> Self {
        let frame = Frame::new(settings, run);
        let tiles = tile::cover(frame.origin, frame.size, frame.wanted);
        let empty = |tile| TileState { tile, edges: LampEdges::default() };
        Self { frame, tiles: tiles.into_iter().map(empty).collect() }
    }

    /// True if a render under `settings` by `run` can go on from here: the same pixels, planes and random numbers. That
    /// the scene is the same is for the caller to know.
    pub(super) fn belongs_to(&self, settings: &Settings, run: &Run) -> bool {
        self.frame == Frame::new(settings, run)
    }

    pub(super) fn wanted(&self) -> Wanted {
        self.frame.wanted
    }

    pub(super) fn tiles_mut(&mut self) -> &mut [TileState] {
        &mut self.tiles
    }

    /// Samples that every pixel holds, which is the number of the next.
    pub fn spp(&self) -> u32 {
        self.tiles.iter().map(|part| part.tile.spp).min().unwrap_or(0)
    }

    /// Pixels that are rendered.
    pub fn pixels(&self) -> usize {
        self.frame.size.0 * self.frame.size.1
    }

    /// Pixels that hold no sample at all.
    pub fn unsampled(&self) -> usize {
        let pixels = |tile: &Tile| tile.size.0 * tile.size.1;
        self.tiles.iter().filter(|part| part.tile.spp == 0).map(|part| pixels(&part.tile)).sum()
    }

    /// Mean over pixels of the standard error relative to the pixel's brightness.
    pub(super) fn relative_error(&self) -> f64 {
        let errors = self.tiles.iter().map(|part| part.tile.relative_error());
        let (sum, pixels) = errors.fold((0.0, 0), |(e, n), (error, count)| (e + error, n + count));
        sum / pixels as f64
    }

    /// The picture so far, with the planes of `aovs`.
    pub(super) fn image(&self, aovs: &[Aov]) -> Image {
        let mut image = self.frame.image();
        tile::assemble(self.tiles.iter().map(|part| &part.tile), aovs, &mut image);
        image
    }

    /// The picture as of `image`, freeing tiles as the planes fill, last first: what was allocated last is what an
    /// allocator gives back.
    pub(super) fn into_image(self, aovs: &[Aov]) -> Image {
        let mut image = self.frame.image();
        tile::assemble(self.tiles.into_iter().rev().map(|part| part.tile), aovs, &mut image);
        image
    }
}
