//! From baked tables to a picture.
//!
//! [`render`] chooses a [`transport`] for the scene's spacetime and a schedule, cuts the picture into tiles and the
//! samples into passes, and has worker threads run the [`stages`] over them.

mod choice;
pub mod curved;
mod edges;
mod exposure;
mod fate;
mod flock;
mod halt;
mod illumination;
mod paper;
mod path;
mod per_pixel;
mod photons;
mod probe;
mod samples;
mod shoot;
pub mod stages;
mod stats;
pub mod steppers;
mod straight;
mod surroundings;
mod tile;
mod trail;
pub mod transport;
mod vertex;
mod wavefront;
mod work;
mod worker;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::film::{Aov, Image, Wanted};
use crate::scene::Baked;
use choice::with_render_transport;
use edges::Edges;
pub use fate::Fate;
use halt::Halt;
use illumination::Illumination;
pub use illumination::LightSummary;
pub use probe::{Probe, Reading, probe};
pub use shoot::{Ray, Shot, shoot};
pub use stats::{Counters, Fates, Occupancy, Stage, StageTimes, Stats};
use tile::Tile;
pub use trail::{Trail, trails};
use transport::{Errand, Transport};
use work::Job;
use worker::Workers;

/// How a render runs; none of it changes a pixel's value, except by ending early.
#[derive(Clone, Debug)]
pub struct Run {
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// Rays in a worker's wavefront.
    pub batch: usize,
    /// Stop after this much time, from the first ray on; later, if some pixel would have no sample, by at most a second.
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

/// Samples of each pass but the first few.
const PASS: u32 = 16;
/// Samples below which the noise is not known well enough to stop.
const FEWEST_FOR_NOISE: u32 = 16;

/// The samples of the pass that this one belongs to: a picture soon, and Sobol' points in powers of two.
fn pass_of(sample: u32) -> Range<u32> {
    match sample {
        0 => 0..1,
        1..4 => 1..4,
        4..8 => 4..8,
        8..PASS => 8..PASS,
        _ => sample / PASS * PASS..(sample / PASS + 1) * PASS,
    }
}

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

/// Does `work` on so many threads, 0 for one per core.
fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(work),
        // Without a pool of its own the work shares rayon's.
        Err(_) => work(),
    }
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
        let mut job = Job::new(self.scene, settings);
        let wanted = Wanted::new(&run.aovs, run.noise.is_some());
        let [x0, y0, x1, y1] = run.crop.unwrap_or([0, 0, settings.width, settings.height]);
        let mut tiles = tile::cover((x0, y0), (x1 - x0, y1 - y0), wanted);
        let started = Instant::now();
        let (counters, times, threads) =
            on_threads(run.threads, || self.work(&mut job, transport, &mut tiles, wanted, started));
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
    fn work<'a, T: Transport>(
        &'a self,
        job: &mut Job<'a>,
        transport: &T,
        tiles: &mut [Tile],
        wanted: Wanted,
        started: Instant,
    ) -> (Counters, StageTimes, usize) {
        let mut illumination = Illumination::of(self.scene);
        job.halt = Halt::new(self.cancel, self.run.time_limit);
        if let Some(illumination) = &mut illumination {
            illumination.learn(job, transport);
        }
        job.illumination = illumination;
        let learning = started.elapsed().as_secs_f64();
        let (counters, times, threads) = self.passes(job, transport, tiles, wanted);
        (counters, StageTimes { learning, ..times }, threads)
    }

    /// All passes over all tiles.
    fn passes<T: Transport>(
        &self,
        job: &Job,
        transport: &T,
        tiles: &mut [Tile],
        wanted: Wanted,
    ) -> (Counters, StageTimes, usize) {
        let (halt, spp) = (&job.halt, job.settings.spp);
        let workers = Workers::new(job, transport, wanted, self.run.batch);
        let mut edges = vec![Edges::default(); tiles.len()];
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
                let Some(paths) = workers.own().pass(tile, edges, end) else { return };
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
