//! A render from start to end: passes until the samples, the noise or the time asked for are reached.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::run::Run;
use super::session::Session;
use super::state::State;
use super::stats::Stats;
use crate::film::Image;
use crate::scene::Baked;

/// A finished render.
pub struct Rendered {
    /// The picture.
    pub image: Image,
    /// Samples that every pixel holds; fewer than asked for if the run ended early.
    pub spp: u32,
    /// Pixels that hold no sample at all.
    pub unsampled: usize,
    /// Work that was done and the time that it took.
    pub stats: Stats,
}

impl Rendered {
    /// Pixels of the picture, of the crop if it is one.
    pub fn pixels(&self) -> usize {
        self.image.size.0 * self.image.size.1
    }
}

/// Progress of a render, in camera paths.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Camera paths finished.
    pub done: u64,
    /// Camera paths in all.
    pub total: u64,
}

/// Samples below which the noise is not known well enough to stop.
const FEWEST_FOR_NOISE: u32 = 16;

/// Renders `scene`; `progress` is called when the first path begins, and from worker threads after each finished tile.
/// Setting `cancel` ends the run at once: pixels that miss the current pass keep the samples of the passes before.
pub fn render(
    scene: &Baked,
    run: &Run,
    cancel: &AtomicBool,
    progress: &(dyn Fn(Progress) + Sync),
) -> Rendered {
    let spp = scene.settings.spp;
    let mut session = Session::new(scene, run, cancel);
    let (done, total) = (AtomicU64::new(0), session.state().pixels() as u64 * u64::from(spp));
    progress(Progress { done: 0, total });
    let count = |paths| {
        let done = done.fetch_add(paths, Ordering::Relaxed) + paths;
        progress(Progress { done, total });
    };
    while session.pass(spp, count) && !is_quiet(session.state(), run.noise) {}
    let (spp, unsampled) = (session.state().spp(), session.state().unsampled());
    let stats = session.stats();
    Rendered { image: session.into_image(), spp, unsampled, stats }
}

/// True if the noise asked for is reached.
fn is_quiet(state: &State, noise: Option<f64>) -> bool {
    noise.is_some_and(|noise| state.spp() >= FEWEST_FOR_NOISE && state.relative_error() <= noise)
}
