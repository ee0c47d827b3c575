//! Counters and timings of a render.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::cpu_clock;
use crate::film::RayEnd;

/// Rays by fate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Fates {
    /// Met a surface.
    pub hit: u64,
    /// Left to infinity.
    pub escaped: u64,
    /// Fell through the horizon.
    pub captured: u64,
    /// Took more steps than allowed.
    pub step_limit: u64,
    /// Lost their state.
    pub non_finite: u64,
}

/// Work done, counted by whoever does it and added up in a fixed order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counters {
    /// Camera paths.
    pub paths: u64,
    /// Rays: camera rays and bounces.
    pub rays: u64,
    /// Rays to lights.
    pub light_rays: u64,
    /// March steps, rejected ones included.
    pub steps: u64,
    /// BVH queries.
    pub queries: u64,
    /// Rays by fate.
    pub fates: Fates,
}

/// Items handled by a stage, and the CPU time that worker threads took for them, added over threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StageCost {
    /// CPU time, seconds.
    pub seconds: f64,
    /// Rays handled, or paths: a ray counts once in every round in which the stage handles it.
    pub items: u64,
}

/// Occupancy of the vectors, added over rounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Occupancy {
    /// Rounds.
    pub rounds: u64,
    /// Lanes in use.
    pub live: u64,
    /// Lanes there are.
    pub lanes: u64,
    /// Lanes of the blocks in use.
    pub blocks: u64,
}

/// Items and time of each stage, and occupancy of the vectors; all but `learning` in the wavefront schedule only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StageTimes {
    /// Learning of light sampling before passes, CPU time of all threads, seconds.
    pub learning: f64,
    /// Camera rays.
    pub generate: StageCost,
    /// Integration steps and arcs.
    pub advance: StageCost,
    /// Searching the scene.
    pub intersect: StageCost,
    /// Deciding each ray's outcome, polishing hits.
    pub settle: StageCost,
    /// Light from infinity.
    pub escape: StageCost,
    /// Emission, roulette and scattering.
    pub scatter: StageCost,
    /// Results to the tile, freeing lanes.
    pub film: StageCost,
    /// Lanes over rounds.
    pub occupancy: Occupancy,
}

/// Counts and times of one render.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Stats {
    /// Wall time of the render, seconds.
    pub seconds: f64,
    /// CPU time of all threads, seconds.
    pub cpu_seconds: f64,
    /// Worker threads.
    pub threads: usize,
    /// Work done.
    #[serde(flatten)]
    pub counters: Counters,
    /// Camera paths per second.
    pub paths_per_second: f64,
    /// March steps per second.
    pub steps_per_second: f64,
    /// BVH queries per camera path.
    pub queries_per_path: f64,
    /// BVH queries per ray.
    pub queries_per_ray: f64,
    /// March steps per ray.
    pub steps_per_ray: f64,
    /// The stages of the wavefront.
    pub stages: StageTimes,
    /// Largest resident memory of the process so far, bytes; absent where the system does not say.
    pub peak_memory_bytes: Option<u64>,
}

impl Fates {
    /// Counts a ray that ended.
    pub fn count(&mut self, end: RayEnd) {
        *(match end {
            RayEnd::Hit => &mut self.hit,
            RayEnd::Escaped => &mut self.escaped,
            RayEnd::Captured => &mut self.captured,
            RayEnd::StepLimit => &mut self.step_limit,
            RayEnd::NonFinite => &mut self.non_finite,
        }) += 1;
    }
}

impl Counters {
    /// Counts a ray that a path sends out, to a light or onwards.
    pub fn count_ray(&mut self, light_ray_in_flight: bool) {
        *(if light_ray_in_flight { &mut self.light_rays } else { &mut self.rays }) += 1;
    }

    /// Adds another worker's counts.
    pub fn add(&mut self, other: &Counters) {
        let Counters { paths, rays, light_rays, steps, queries, fates } = other;
        self.paths += paths;
        self.rays += rays;
        self.light_rays += light_rays;
        self.steps += steps;
        self.queries += queries;
        self.fates.hit += fates.hit;
        self.fates.escaped += fates.escaped;
        self.fates.captured += fates.captured;
        self.fates.step_limit += fates.step_limit;
        self.fates.non_finite += fates.non_finite;
    }
}

impl StageCost {
    fn add(&mut self, other: &StageCost) {
        self.seconds += other.seconds;
        self.items += other.items;
    }
}

impl Occupancy {
    /// Counts a round in which `live` of `lanes` lanes are in use, which blocks of `block` hold.
    pub fn count(&mut self, live: usize, lanes: usize, block: usize) {
        self.rounds += 1;
        self.live += live as u64;
        self.lanes += lanes as u64;
        self.blocks += live.next_multiple_of(block) as u64;
    }

    /// Share of the lanes that are in use; `None` without rounds.
    pub fn share(&self) -> Option<f64> {
        (self.rounds > 0).then(|| self.live as f64 / self.lanes as f64)
    }
}

impl StageTimes {
    /// Adds another worker's times.
    pub fn add(&mut self, other: &StageTimes) {
        let StageTimes { learning, generate, advance, intersect, settle, escape, scatter, film, occupancy } =
            other;
        self.learning += learning;
        self.generate.add(generate);
        self.advance.add(advance);
        self.intersect.add(intersect);
        self.settle.add(settle);
        self.escape.add(escape);
        self.scatter.add(scatter);
        self.film.add(film);
        self.occupancy.rounds += occupancy.rounds;
        self.occupancy.live += occupancy.live;
        self.occupancy.lanes += occupancy.lanes;
        self.occupancy.blocks += occupancy.blocks;
    }

    fn scale(&mut self, by: f64) {
        let Self { learning: _, generate, advance, intersect, settle, escape, scatter, film, occupancy: _ } =
            self;
        for stage in [generate, advance, intersect, settle, escape, scatter, film] {
            stage.seconds *= by;
        }
    }

    /// The stages by name, in the order of a round.
    pub fn named(&self) -> [(&'static str, StageCost); 7] {
        [
            ("generate", self.generate),
            ("advance", self.advance),
            ("intersect", self.intersect),
            ("settle", self.settle),
            ("escape", self.escape),
            ("scatter", self.scatter),
            ("film", self.film),
        ]
    }
}

impl Stats {
    /// Rates from counts and times, `elapsed` on the wall and on the CPUs.
    pub fn new(counters: Counters, stages: StageTimes, elapsed: [Duration; 2], threads: usize) -> Self {
        let [seconds, cpu_seconds] = elapsed.map(|time| time.as_secs_f64());
        let per = |count: u64, of: f64| if of > 0.0 { count as f64 / of } else { 0.0 };
        Self {
            seconds,
            cpu_seconds,
            threads,
            counters,
            paths_per_second: per(counters.paths, seconds),
            steps_per_second: per(counters.steps, seconds),
            queries_per_path: per(counters.queries, counters.paths as f64),
            queries_per_ray: per(counters.queries, (counters.rays + counters.light_rays) as f64),
            steps_per_ray: per(counters.steps, (counters.rays + counters.light_rays) as f64),
            stages,
            peak_memory_bytes: peak_memory(),
        }
    }
}

/// Linux: VmHWM of /proc/self/status, kB.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}

/// Times consecutive stages of a thread's work with one reading of the wall clock each, which is cheap, and the whole
/// work with two readings of the CPU's clock, which are not: at the end, stages get their shares of the CPU time.
pub struct Lap {
    times: StageTimes,
    started: Instant,
    last: Instant,
    cpu: Duration,
}

impl Lap {
    /// Starts the clock.
    pub fn start() -> Self {
        let now = Instant::now();
        Self { times: StageTimes::default(), started: now, last: now, cpu: cpu_clock::of_thread() }
    }

    /// Adds the time since the last lap, in which `items` were handled, to a stage.
    pub fn end(&mut self, stage: impl FnOnce(&mut StageTimes) -> &mut StageCost, items: usize) {
        let now = Instant::now();
        let seconds = (now - self.last).as_secs_f64();
        stage(&mut self.times).add(&StageCost { seconds, items: items as u64 });
        self.last = now;
    }

    /// Counts a round, see [`Occupancy::count`].
    pub fn count(&mut self, live: usize, lanes: usize, block: usize) {
        self.times.occupancy.count(live, lanes, block);
    }

    /// CPU time of each stage.
    pub fn finish(mut self) -> StageTimes {
        let (cpu, wall) = (cpu_clock::of_thread().saturating_sub(self.cpu), self.last - self.started);
        if !wall.is_zero() {
            self.times.scale(cpu.as_secs_f64() / wall.as_secs_f64());
        }
        self.times
    }
}
