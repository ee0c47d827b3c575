//! A short look at what a render costs: the kernels themselves, over sparse parts of the picture.
//!
//! Each worker takes turns. A turn traces a few samples of pixels that lie evenly all over the picture, by either
//! schedule, and all that is done for edges of lamps in a small neighbourhood. No turn sees the same pixels as another.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::choice::with_render_transport;
use super::edge_pixels::EdgePixels;
use super::halt::Halt;
use super::illumination::{Illumination, LightSummary};
use super::job::Job;
use super::learn::lamp_edges::LampEdges;
use super::learn::{Lesson, photons, visible_caps};
use super::ray_cone::RayCones;
use super::run::{Run, Threads};
use super::samples::Samples;
use super::split::short_paths;
use super::tile::TILE;
use super::transport::{Transport, TransportVisitor};
use super::work::{Lattice, Share, Work};
use super::worker::Workers;
use crate::film::Wanted;
use crate::scene::{Baked, Schedule, Settings};

/// Samples of each pixel that is looked at, at most: as many as a pass of a render takes.
const SAMPLES: u32 = 16;
/// Paths of pixels beside each other, so that they find in the caches what the others needed, as in a render.
const NEIGHBOURS: f64 = 64.0;
/// Paths of a turn, at least and at most.
const PATHS: (f64, f64) = (256.0, 4096.0);
/// Time of a turn's paths in the schedule that is set, and in the other, relative to that of the probe.
const TURN: [f64; 2] = [0.04, 0.015];
/// Time beyond that of the probe after which a turn is given up.
const LONGEST: Duration = Duration::from_secs(3);
/// Photons sent at most in a lesson: what they cost is proportional to their number.
const PHOTONS: u32 = 1 << 15;
/// Columns and rows of a neighbourhood in which edges are looked for.
const NEIGHBOURHOOD: usize = 8;
/// Neighbourhoods of a turn.
const NEIGHBOURHOODS: usize = 2;
/// Most samples for whose number edges are searched: there are hardly more to be found.
const EDGE_SPP: u32 = 256;
/// Samples that are taken of the edges found.
const EDGE_SAMPLES: u32 = 2;

/// Cost of a render.
#[derive(Clone, Debug)]
pub struct Probe {
    /// Worker threads.
    pub threads: usize,
    /// Wall time of learning of light sampling, seconds.
    pub learning: f64,
    /// Summary of light sampling; `None` where it is off or of no use.
    pub lights: Option<LightSummary>,
    /// Pixels that are rendered.
    pub pixels: usize,
    /// Tiles that they are in; workers take them whole.
    pub tiles: usize,
    /// One of each turn.
    pub readings: Vec<Reading>,
}

/// Costs measured in a turn: thread time, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// A camera path in the wavefront schedule.
    pub wavefront: f64,
    /// A camera path in the per-pixel schedule.
    pub per_pixel: f64,
    /// Edges of lamps, for each pixel of the picture and all its samples.
    pub edges: f64,
}

/// Looks for about `limit` at what rendering `scene` by `run` costs; there may be no readings if its paths take too
/// long.
pub fn probe(scene: &Baked, run: &Run, limit: Duration) -> Probe {
    with_render_transport(scene, Prober { scene, run, limit })
}

struct Prober<'a> {
    scene: &'a Baked,
    run: &'a Run,
    limit: Duration,
}

impl TransportVisitor for Prober<'_> {
    type Output = Probe;

    fn run<T: Transport + 'static>(self, transport: T) -> Probe {
        Threads::new(self.run.threads).run(|| self.look(&transport))
    }
}

impl Prober<'_> {
    fn look<T: Transport>(&self, transport: &T) -> Probe {
        let started = Instant::now();
        let spp = self.scene.settings.spp.min(EDGE_SPP);
        let settings = Settings { spp, ..self.scene.settings.clone() };
        let halt = Halt::after(LONGEST.saturating_add(self.limit));
        let mut job = Job::new(self.scene, &settings, halt);
        job.cones = RayCones::of(self.scene, transport);
        let learning = learn(&mut job, transport, self.scene.settings.spp);
        let lights = job.illumination.as_ref().map(|illumination| illumination.summary(self.scene));
        let wanted = Wanted::new(&self.run.aovs, self.run.noise.is_some());
        let workers = |schedule| Workers::new(schedule, self.run.batch);
        let turns = Turns {
            job: &job,
            transport,
            window: CropWindow::of(&settings, self.run),
            samples: settings.spp.min(SAMPLES),
            wanted,
            wavefront: workers(Schedule::Wavefront),
            per_pixel: workers(Schedule::PerPixel),
        };
        let (next, readings) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
        rayon::broadcast(|_| {
            let turn = || next.fetch_add(1, Ordering::Relaxed);
            // The first turn warms up caches and tells how much a turn can look at.
            let Some(Reading { wavefront, per_pixel, .. }) = turns.take(turn(), [PATHS.0; 2]) else { return };
            let [set, other] = TURN.map(|share| share * self.limit.as_secs_f64());
            let paths = match settings.schedule {
                Schedule::Wavefront => [set / wavefront, other / per_pixel],
                Schedule::PerPixel => [other / wavefront, set / per_pixel],
            };
            while let Some(reading) = turns.take(turn(), paths) {
                readings.lock().unwrap_or_else(PoisonError::into_inner).push(reading);
                if started.elapsed() >= self.limit {
                    break;
                }
            }
        });
        let readings = readings.into_inner().unwrap_or_else(PoisonError::into_inner);
        let (width, height) = turns.window.size;
        let tiles = width.div_ceil(TILE) * height.div_ceil(TILE);
        Probe {
            threads: rayon::current_num_threads(),
            learning,
            lights,
            pixels: width * height,
            tiles,
            readings,
        }
    }
}

/// Traces by one of the schedules; `None` if it had to give up.
type Trace<'a> = dyn Fn(&Work, Wanted) -> Option<Samples> + 'a;

/// State that all turns share.
struct Turns<'a, T: Transport> {
    job: &'a Job<'a>,
    transport: &'a T,
    window: CropWindow,
    samples: u32,
    wanted: Wanted,
    wavefront: Workers<T>,
    per_pixel: Workers<T>,
}

impl<T: Transport> Turns<'_, T> {
    /// A turn of the thread that asks, of about so many paths in the wavefront and in the per-pixel schedule; `None` if
    /// it had to give up.
    fn take(&self, turn: usize, paths: [f64; 2]) -> Option<Reading> {
        let Self { window, samples, wanted, .. } = *self;
        let lattices = paths.map(|paths| window.lattice(samples, paths));
        // Not the same pixels twice: what they need would be in the caches.
        let patch = |number, lattice| ProbePatch { number, window, lattice, samples, wanted };
        let scene = self.job.scene;
        let trace = |workers: &Workers<T>, work: &Work, wanted| {
            workers.own().trace(self.job, self.transport, work, wanted)
        };
        let wavefront = |work: &Work, wanted| trace(&self.wavefront, work, wanted);
        let per_pixel = |work: &Work, wanted| trace(&self.per_pixel, work, wanted);
        let as_set: &Trace = match scene.settings.schedule {
            Schedule::Wavefront => &wavefront,
            Schedule::PerPixel => &per_pixel,
        };
        let numbers = NEIGHBOURHOODS * turn..NEIGHBOURHOODS * (turn + 1);
        let found: Option<f64> = numbers.map(|number| patch(number, Lattice::ALL).edges(as_set, scene)).sum();
        Some(Reading {
            edges: found? / NEIGHBOURHOODS as f64,
            wavefront: patch(2 * turn, lattices[0]).paths(&wavefront)?,
            per_pixel: patch(2 * turn + 1, lattices[1]).paths(&per_pixel)?,
        })
    }
}

/// Learns what there is to learn of the lights, from fewer rays than a render of so many samples; the seconds that all
/// of its lessons take.
fn learn<T: Transport>(job: &mut Job, transport: &T, samples: u32) -> f64 {
    let started = Instant::now();
    let Some(mut illumination) = Illumination::of(job.scene, transport) else { return 0.0 };
    let pixels = job.settings.width * job.settings.height;
    let first = started.elapsed().as_secs_f64();
    let (mut looking, mut sending) = (0.0, 0.0);
    for Lesson { looks, photons } in Lesson::all(pixels, samples) {
        let started = Instant::now();
        visible_caps::learn(job, transport, &mut illumination, looks);
        looking += started.elapsed().as_secs_f64();
        let (started, sent) = (Instant::now(), photons.min(PHOTONS));
        photons::learn(job, transport, &mut illumination, sent);
        sending += started.elapsed().as_secs_f64() * f64::from(photons) / f64::from(sent);
    }
    job.illumination = Some(illumination);
    first + looking + sending
}

/// The part of the picture that is rendered.
#[derive(Clone, Copy)]
struct CropWindow {
    origin: (usize, usize),
    size: (usize, usize),
}

impl CropWindow {
    fn of(settings: &Settings, run: &Run) -> Self {
        let [x0, y0, x1, y1] = run.crop.unwrap_or([0, 0, settings.width, settings.height]);
        Self { origin: (x0, y0), size: (x1 - x0, y1 - y0) }
    }

    /// Pixels that are spread evenly, for about so many paths of `samples` each.
    fn lattice(&self, samples: u32, paths: f64) -> Lattice {
        let run = (NEIGHBOURS / f64::from(samples)).sqrt();
        let pixels = paths.clamp(PATHS.0, PATHS.1) / f64::from(samples);
        let thinned = ((self.size.0 * self.size.1) as f64 / pixels).sqrt().max(1.0);
        Lattice { run: run as usize, every: (run * thinned).ceil() as usize }
    }
}

/// Part of the picture that is rendered in a turn.
#[derive(Clone, Copy)]
struct ProbePatch {
    number: usize,
    window: CropWindow,
    lattice: Lattice,
    samples: u32,
    wanted: Wanted,
}

impl ProbePatch {
    /// A place for each patch, far from those of others: Roberts' sequence of the plastic number.
    fn spot(&self, within: (usize, usize)) -> (usize, usize) {
        let at = |ratio: f64, size: usize| ((self.number as f64 * ratio).fract() * size as f64) as usize;
        (at(0.754_877_666_246_692_8, within.0), at(0.569_840_290_998_053_3, within.1))
    }

    /// Seconds that a camera path takes, over the whole picture.
    fn paths(&self, trace: &Trace) -> Option<f64> {
        let CropWindow { origin, size } = self.window;
        let Self { lattice, samples, .. } = *self;
        let (x, y) = self.spot((lattice.every.min(size.0), lattice.every.min(size.1)));
        let none = EdgePixels::default();
        let work = Work {
            origin: (origin.0 + x, origin.1 + y),
            size: (lattice.count(size.0 - x), lattice.count(size.1 - y)),
            lattice,
            first_sample: samples * self.number as u32,
            samples,
            share: Share::Whole(&none),
        };
        let started = Instant::now();
        trace(&work, self.wanted)?;
        Some(started.elapsed().as_secs_f64() / f64::from(work.paths()))
    }

    /// Seconds for each pixel that edges of lamps take in a neighbourhood: to find them and to look at them closely.
    fn edges(&self, trace: &Trace, scene: &Baked) -> Option<f64> {
        if !LampEdges::are_possible(scene) {
            return Some(0.0);
        }
        let CropWindow { origin, size } = self.window;
        let size = (size.0.min(NEIGHBOURHOOD), size.1.min(NEIGHBOURHOOD));
        let (x, y) = self.spot((self.window.size.0 - size.0 + 1, self.window.size.1 - size.1 + 1));
        let origin = (origin.0 + x, origin.1 + y);
        let started = Instant::now();
        let (mut edges, spp) = (LampEdges::default(), scene.settings.spp);
        let last = spp.min(EDGE_SPP) - 1;
        edges.refine(scene, (origin, size), last, |work| trace(work, Wanted::default()))?;
        let finding = started.elapsed().as_secs_f64();
        let (first_sample, samples) = (0, EDGE_SAMPLES);
        let share = Share::Whole(edges.pixels());
        let work = Work { origin, size, lattice: Lattice::ALL, first_sample, samples, share };
        let started = Instant::now();
        if let Some(work) = short_paths(&work) {
            trace(&work, Wanted::default())?;
        }
        let looking = started.elapsed().as_secs_f64();
        // Neighbourhoods are searched with a rim of one pixel, as tiles are.
        let rim = |side: usize| (side as f64 + 2.0) / side as f64;
        let less = rim(TILE) * rim(TILE) / (rim(size.0) * rim(size.1));
        let probed = f64::from(LampEdges::probes(spp)) / f64::from(LampEdges::probes(spp.min(EDGE_SPP)));
        let spp = f64::from(spp);
        Some((finding * less * probed + looking * spp / f64::from(samples)) / (size.0 * size.1) as f64)
    }
}
