//! From baked tables to a picture.

mod stats;

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use crate::film::{Aov, Image};
use crate::scene::Baked;
pub use stats::{Fates, Stats};

/// How a render runs; none of it changes a pixel's value, except by ending early.
#[derive(Clone, Debug)]
pub struct Run {
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// Rays in a worker's wavefront.
    pub batch: usize,
    /// Stop after this much time.
    pub time_limit: Option<Duration>,
    /// Stop when the image's mean relative standard error falls below this.
    pub noise: Option<f64>,
    /// Render only the pixels in `x0..x1`, `y0..y1` (as `[x0, y0, x1, y1]`).
    pub crop: Option<[usize; 4]>,
    /// Planes beside the beauty.
    pub aovs: Vec<Aov>,
}

impl Default for Run {
    fn default() -> Self {
        Self { threads: 0, batch: 4096, time_limit: None, noise: None, crop: None, aovs: Vec::new() }
    }
}

/// What a render gives.
pub struct Rendered {
    /// The picture.
    pub image: Image,
    /// Samples that every pixel holds; fewer than asked for if the run ended early.
    pub spp: u32,
    /// What was done and how long it took.
    pub stats: Stats,
}

/// How far a render has come, in camera paths.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Camera paths finished.
    pub done: u64,
    /// Camera paths in all.
    pub total: u64,
}

/// Renders `scene`; `progress` is called from worker threads after each finished tile, and setting `cancel` ends the
/// run after the tiles in work (pixels that miss the current pass keep the samples of the passes before).
pub fn render(_scene: &Baked, _run: &Run, _cancel: &AtomicBool, _progress: &(dyn Fn(Progress) + Sync)) -> Rendered {
    unimplemented!()
}
