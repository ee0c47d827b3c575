//! A render from start to end: passes until the samples, the noise or the time asked for are reached.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use super::choice::with_render_transport;
use super::halt::Halt;
use super::job::Job;
use super::learn::lamp_edges::LampEdges;
use super::learn::learn_lights;
use super::passes::pass_of;
use super::run::{Run, on_threads};
use super::split::trace_split;
use super::stats::{Counters, StageTimes, Stats};
use super::tile::{self, Tile};
use super::transport::{Errand, Transport};
use super::work::{Lattice, Share, Work};
use super::worker::{Worker, Workers};
use crate::film::{Aov, Image, Wanted};
use crate::scene::Baked;

/// What a render gives.
pub struct Rendered {
    /// The picture.
    pub image: Image,
    /// Samples that every pixel holds; fewer than asked for if the run ended early.
    pub spp: u32,
    /// Pixels that hold no sample at all.
    pub unsampled: usize,
    /// What was done and how long it took.
    pub stats: Stats,
}

impl Rendered {
    /// Pixels of the picture, of the crop if it is one.
    pub fn pixels(&self) -> usize {
        self.image.size.0 * self.image.size.1
    }
}

/// How far a render has come, in camera paths.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Camera paths finished.
    pub done: u64,
    /// Camera paths in all.
    pub total: u64,
}

/// Samples below which the noise is not known well enough to stop.
const FEWEST_FOR_NOISE: u32 = 16;

/// Renders `scene`; `progress` is called when the first path begins, and from worker threads after each finished tile. Setting `cancel` ends the run at
/// once: pixels that miss the current pass keep the samples of the passes before.
pub fn render(
    scene: &Baked,
    run: &Run,
    cancel: &AtomicBool,
    progress: &(dyn Fn(Progress) + Sync),
) -> Rendered {
    with_render_transport(scene, Renderer { scene, run, cancel, progress })
}

struct Renderer<'a> {
    scene: &'a Baked,
    run: &'a Run,
    cancel: &'a AtomicBool,
    progress: &'a (dyn Fn(Progress) + Sync),
}

impl Errand for Renderer<'_> {
    type Output = Rendered;

    fn run<T: Transport>(self, transport: &T) -> Rendered {
        let (settings, run) = (&self.scene.settings, self.run);
        let wanted = Wanted::new(&run.aovs, run.noise.is_some());
        let [x0, y0, x1, y1] = run.crop.unwrap_or([0, 0, settings.width, settings.height]);
        let mut tiles = tile::cover((x0, y0), (x1 - x0, y1 - y0), wanted);
        let started = Instant::now();
        let (counters, times, threads) =
            on_threads(run.threads, || self.work(transport, &mut tiles, started));
        let mut image = Image {
            width: settings.width,
            height: settings.height,
            origin: (x0, y0),
            size: (x1 - x0, y1 - y0),
            planes: Vec::new(),
            attributes: Vec::new(),
        };
        let spp = tiles.iter().map(|tile| tile.spp).min().unwrap_or(0);
        let unsampled = tiles.iter().filter(|tile| tile.spp == 0).map(|tile| tile.size.0 * tile.size.1).sum();
        tile::assemble(tiles, &run.aovs, &mut image);
        image.attributes = self.attributes(spp);
        Rendered { image, spp, unsampled, stats: Stats::new(counters, times, started.elapsed(), threads) }
    }
}

impl Renderer<'_> {
    /// What the file says of itself; entity names only beside the plane of their numbers.
    fn attributes(&self, spp: u32) -> Vec<(String, String)> {
        let mut attributes =
            vec![("spp".into(), spp.to_string()), ("seed".into(), self.scene.settings.seed.to_string())];
        if self.run.aovs.contains(&Aov::Entity) {
            let names = self.scene.entities.iter().enumerate();
            attributes.extend(names.map(|(index, name)| (format!("entity.{}", index + 1), name.clone())));
        }
        attributes
    }

    /// What light sampling has to learn first, then all passes.
    fn work<T: Transport>(
        &self,
        transport: &T,
        tiles: &mut [Tile],
        started: Instant,
    ) -> (Counters, StageTimes, usize) {
        let halt = Halt::new(self.cancel, self.run.time_limit);
        let mut job = Job::new(self.scene, &self.scene.settings, halt);
        learn_lights(&mut job, transport);
        let learning = started.elapsed().as_secs_f64();
        let (counters, times, threads) = self.passes(&job, transport, tiles);
        (counters, StageTimes { learning, ..times }, threads)
    }

    /// All passes over all tiles.
    fn passes<T: Transport>(
        &self,
        job: &Job,
        transport: &T,
        tiles: &mut [Tile],
    ) -> (Counters, StageTimes, usize) {
        let (halt, spp) = (&job.halt, job.settings.spp);
        let workers = Workers::new(job, transport, self.run.batch);
        let mut edges = vec![LampEdges::default(); tiles.len()];
        let pixels: u64 = tiles.iter().map(|tile| (tile.size.0 * tile.size.1) as u64).sum();
        let (done, total) = (AtomicU64::new(0), pixels * u64::from(spp));
        (self.progress)(Progress { done: 0, total });
        let mut first = 0;
        while first < spp && !halt.is_due() {
            let end = pass_of(first).end.min(spp);
            tiles.par_iter_mut().zip(&mut edges).for_each(|(tile, edges)| {
                if halt.is_due() {
                    return;
                }
                let Some(paths) = pass(&mut workers.own(), self.scene, tile, edges, end) else { return };
                let done = done.fetch_add(paths, Ordering::Relaxed) + paths;
                (self.progress)(Progress { done, total });
            });
            if tiles.iter().all(|tile| tile.spp > 0) {
                halt.has_picture();
            }
            if self.is_quiet(tiles) {
                break;
            }
            first = end;
        }
        workers.finish()
    }

    /// Whether the noise asked for is reached.
    fn is_quiet(&self, tiles: &[Tile]) -> bool {
        let Some(noise) = self.run.noise else { return false };
        if tiles.iter().any(|tile| tile.spp < FEWEST_FOR_NOISE) {
            return false;
        }
        let (error, pixels) = tiles
            .iter()
            .map(Tile::relative_error)
            .fold((0.0, 0), |(e, n), (error, count)| (e + error, n + count));
        error <= noise * pixels as f64
    }
}

/// Adds samples to each pixel of `tile`, up to `end` in all, of which few may be left to a pass, and takes those of pixels
/// that turn out to be at edges of lamps again: how many camera paths were added; `None`, and nothing changed in the
/// tile, if it had to give up.
fn pass<T: Transport>(
    worker: &mut Worker<T>,
    scene: &Baked,
    tile: &mut Tile,
    edges: &mut LampEdges,
    end: u32,
) -> Option<u64> {
    let Tile { origin, size, spp, wanted, .. } = *tile;
    let found = edges.refine(scene, (origin, size), spp, |work| worker.trace(work, Wanted::default()))?;
    let mut take = |numbers: Range<u32>, share| {
        let (first_sample, samples) = (numbers.start, numbers.len() as u32);
        let work = Work { origin, size, lattice: Lattice::ALL, first_sample, samples, share };
        trace_split(&work, wanted, |work, wanted| worker.trace(work, wanted))
    };
    let again = take(0..spp, Share::Beyond(&found))?;
    let samples = take(spp..end, Share::Whole(edges.pixels()))?;
    tile.replace(found.numbers(), &again);
    tile.add(&samples, end - spp);
    Some(u64::from(end - spp) * (size.0 * size.1) as u64)
}
