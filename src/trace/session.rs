//! A half-finished render that can be looked at, gone on with, put away and taken up again.

use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use glam::DVec3;
use rayon::prelude::*;

use super::choice::{with_medium, with_render_transport};
use super::cpu_clock;
use super::halt::Halt;
use super::illumination::Illumination;
use super::job::Job;
use super::passes::pass_of;
use super::ray_cone::RayCones;
use super::run::{Run, Threads};
use super::split::trace_split;
use super::state::{State, TileState};
use super::stats::Stats;
use super::tile::Tile;
use super::tracer::{Tracer, Tracing};
use super::transport::{Transport, TransportVisitor};
use super::work::{Lattice, Share, Work};
use super::worker::Workers;
use crate::film::{Aov, Image, Wanted};
use crate::scene::{Baked, MAX_SPP};
use crate::spacetime::ConformallyFlat;

/// A render that stands between two passes.
///
/// No pixel depends on how many samples are asked for: 64 samples that are extended to 256 are those of a render of
/// 256.
///
/// ```
/// use std::sync::atomic::AtomicBool;
///
/// use warpfront::scene::load;
/// use warpfront::trace::{Run, Session};
///
/// let overrides = ["film.width=24".to_owned(), "film.height=18".to_owned()];
/// let scene = load("scenes/cornell_black_hole.toml".as_ref(), &overrides)?;
/// let (run, cancel) = (Run::default(), AtomicBool::new(false));
///
/// let mut session = Session::new(&scene, &run, &cancel);
/// while session.pass(4, |_| ()) {
///     println!("{} samples per pixel", session.state().spp());
/// }
/// let preview = session.image();
///
/// // Later, maybe: four more samples.
/// let mut session = Session::resume(&scene, &run, &cancel, session.into_state()).expect("the same picture");
/// while session.pass(8, |_| ()) {}
/// assert_eq!(session.state().spp(), 8);
/// assert_ne!(session.image().channel("R"), preview.channel("R"));
/// # Ok::<(), warpfront::scene::SceneError>(())
/// ```
pub struct Session<'a> {
    scene: &'a Baked,
    run: &'a Run,
    threads: Threads,
    tracer: Box<dyn Tracer + 'a>,
    state: State,
    /// CPU time spent in learning.
    learning: Duration,
    /// Wall time and CPU time spent in learning and passes.
    spent: [Duration; 2],
}

impl<'a> Session<'a> {
    /// Begins a render of `scene` by `run`. The time limit of `run` starts here. Setting `cancel` ends this and every pass at once.
    pub fn new(scene: &'a Baked, run: &'a Run, cancel: &'a AtomicBool) -> Self {
        Self::with(scene, run, cancel, State::new(&scene.settings, run))
    }

    /// Like [`Self::new`], in a spacetime of the caller's own about `center`, in place of the scene's.
    pub fn around<M: ConformallyFlat>(
        scene: &'a Baked,
        medium: (DVec3, M),
        run: &'a Run,
        cancel: &'a AtomicBool,
    ) -> Self {
        let state = State::new(&scene.settings, run);
        Self::open((scene, run, cancel), state, |opening| with_medium(scene, medium, opening))
    }

    /// Goes on with a render of the same scene that was put away; `None` if `state` is of other pixels, planes or seed.
    pub fn resume(scene: &'a Baked, run: &'a Run, cancel: &'a AtomicBool, state: State) -> Option<Self> {
        state.belongs_to(&scene.settings, run).then(|| Self::with(scene, run, cancel, state))
    }

    fn with(scene: &'a Baked, run: &'a Run, cancel: &'a AtomicBool, state: State) -> Self {
        Self::open((scene, run, cancel), state, |opening| with_render_transport(scene, opening))
    }

    fn open(
        (scene, run, cancel): (&'a Baked, &'a Run, &'a AtomicBool),
        state: State,
        choose: impl FnOnce(Opening<'a>) -> Box<dyn Tracer + 'a> + Send,
    ) -> Self {
        let watch = Watch::start();
        let halt = Halt::new(cancel, run.time_limit);
        let threads = Threads::new(run.threads);
        let tracer = threads.run(|| choose(Opening { scene, run, halt }));
        Self { scene, run, threads, tracer, state, learning: Duration::ZERO, spent: watch.elapsed() }
    }

    /// Takes the next few samples of every pixel, at most up to `end` in all; `each` is called after each finished
    /// tile, from worker threads, with the camera paths that were added. False once there is nothing to add: all have
    /// `end` samples, or the session was cancelled or its time is over. Pixels that miss a pass keep the samples of the
    /// passes before. Some passes learn of the lights first.
    pub fn pass(&mut self, end: u32, each: impl Fn(u64) + Sync) -> bool {
        let (watch, first) = (Watch::start(), self.state.spp());
        if first >= end {
            return false;
        }
        let pass = pass_of(first.min(MAX_SPP - 1));
        let tracer = &mut self.tracer;
        self.threads.run(|| tracer.learn(pass.end));
        self.learning += watch.elapsed()[1];
        let end = pass.end.min(end);
        let (tracer, scene, wanted) = (self.tracer.as_ref(), self.scene, self.state.wanted());
        let tiles = self.state.tiles_mut();
        self.threads.run(|| {
            tiles.par_iter_mut().filter(|part| part.tile.spp < end).for_each(|part| {
                if !tracer.halt().is_due()
                    && let Some(paths) = part.pass(tracer, scene, wanted, end)
                {
                    each(paths);
                }
            });
        });
        if self.state.unsampled() == 0 {
            tracer.halt().has_picture();
        }
        let [wall, cpu] = watch.elapsed();
        self.spent = [self.spent[0] + wall, self.spent[1] + cpu];
        self.state.spp() > first
    }

    /// Samples so far.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Ends the session; [`Self::resume`] goes on with it.
    pub fn into_state(self) -> State {
        self.state
    }

    /// The picture so far.
    pub fn image(&self) -> Image {
        let attributes = attributes(self.scene, self.run, self.state.spp());
        Image { attributes, ..self.state.image(&self.run.aovs) }
    }

    /// Ends the session: the picture, with less memory than by [`Self::image`].
    pub fn into_image(self) -> Image {
        let Self { scene, run, tracer, state, .. } = self;
        drop(tracer);
        let attributes = attributes(scene, run, state.spp());
        Image { attributes, ..state.into_image(&run.aovs) }
    }

    /// Work and time so far.
    pub fn stats(&self) -> Stats {
        let (counters, mut times, threads) = self.tracer.totals();
        times.learning = self.learning.as_secs_f64();
        Stats::new(counters, times, self.spent, threads)
    }
}

/// Wall clock and CPU clock of the process, read at the same moments.
struct Watch {
    wall: Instant,
    cpu: Duration,
}

impl Watch {
    fn start() -> Self {
        Self { wall: Instant::now(), cpu: cpu_clock::of_process() }
    }

    fn elapsed(&self) -> [Duration; 2] {
        [self.wall.elapsed(), cpu_clock::of_process().saturating_sub(self.cpu)]
    }
}

/// Entries of the file's header; entity names only beside the plane of their numbers.
fn attributes(scene: &Baked, run: &Run, spp: u32) -> Vec<(String, String)> {
    let mut attributes =
        vec![("spp".into(), spp.to_string()), ("seed".into(), scene.settings.seed.to_string())];
    if run.aovs.contains(&Aov::Entity) {
        let names = scene.entities.iter().enumerate();
        attributes.extend(names.map(|(index, name)| (format!("entity.{}", index + 1), name.clone())));
    }
    attributes
}

/// The start of a session, for a transport.
struct Opening<'a> {
    scene: &'a Baked,
    run: &'a Run,
    halt: Halt<'a>,
}

impl<'a> TransportVisitor for Opening<'a> {
    type Output = Box<dyn Tracer + 'a>;

    fn run<T: Transport + 'static>(self, transport: T) -> Box<dyn Tracer + 'a> {
        let settings = &self.scene.settings;
        let illumination = Illumination::of(self.scene, &transport);
        let cones = RayCones::of(self.scene, &transport);
        let job = Job { illumination, cones, ..Job::new(self.scene, settings, self.halt) };
        let workers = Workers::new(settings.schedule, self.run.batch);
        Box::new(Tracing { job, transport, workers, lesson: None })
    }
}

impl TileState {
    /// Adds samples to each pixel, up to `end` in all, of which few may be left to a pass, and takes those of pixels
    /// that turn out to be at edges of lamps again: how many camera paths were added; `None`, and nothing changed in
    /// the tile, if it had to give up.
    fn pass(&mut self, tracer: &dyn Tracer, scene: &Baked, wanted: Wanted, end: u32) -> Option<u64> {
        let Self { tile, edges } = self;
        let Tile { origin, size, spp, .. } = *tile;
        let found = edges.refine(scene, (origin, size), spp, |work| tracer.trace(work, Wanted::default()))?;
        let take = |numbers: Range<u32>, share| {
            let (first_sample, samples) = (numbers.start, numbers.len() as u32);
            let work = Work { origin, size, lattice: Lattice::ALL, first_sample, samples, share };
            trace_split(&work, wanted, |work, wanted| tracer.trace(work, wanted))
        };
        let again = take(0..spp, Share::Beyond(&found))?;
        let samples = take(spp..end, Share::Whole(edges.pixels()))?;
        tile.replace(found.numbers(), &again);
        tile.add(&samples, end - spp);
        Some(u64::from(end - spp) * (size.0 * size.1) as u64)
    }
}
