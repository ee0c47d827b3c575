//! Run settings of a render.

use std::time::Duration;

use super::tile::Tile;
use crate::film::{Aov, Wanted};

/// Run settings of a render; none of them changes a pixel's value, except by ending early.
#[derive(Clone, Debug)]
pub struct Run {
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// Rays in a worker's wavefront.
    pub batch: usize,
    /// Stop after this much time, from the first ray on; later, if some pixel would have no sample, by at most a
    /// second.
    pub time_limit: Option<Duration>,
    /// Stop when the image's mean relative standard error falls below this.
    pub noise: Option<f64>,
    /// Render only the pixels in `x0..x1`, `y0..y1` (as `[x0, y0, x1, y1]`).
    pub crop: Option<[usize; 4]>,
    /// Planes beside the beauty.
    pub aovs: Vec<Aov>,
}

impl Run {
    /// Bytes that sums over samples take for each pixel.
    pub fn pixel_bytes(&self) -> usize {
        Tile::pixel_bytes(Wanted::new(&self.aovs, self.noise.is_some()))
    }
}

impl Default for Run {
    fn default() -> Self {
        Self { threads: 0, batch: 1024, time_limit: None, noise: None, crop: None, aovs: Vec::new() }
    }
}

/// Worker threads of a run.
pub struct Threads(Option<rayon::ThreadPool>);

impl Threads {
    /// So many, 0 for one per core.
    pub fn new(threads: usize) -> Self {
        // Without a pool of its own a run shares rayon's.
        Self(rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok())
    }

    /// Does `work` on them.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}
