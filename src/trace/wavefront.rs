//! The wavefront schedule: a batch of rays advances one move at a time, stage after stage.
//!
//! A worker owns its wavefront; nothing is shared and nothing is atomic. Lanes are dense: a path that ends leaves its
//! lane to a new camera path, and when none are left, to the last lane. What a lane computes depends on its path alone,
//! so the picture depends neither on the batch size nor on the order of lanes.

use super::job::Job;
use super::path::{Gathers, Path};
use super::ray_end::RayEnd;
use super::samples::Samples;
use super::stages::draw::Draws;
use super::stages::escape::escape;
use super::stages::generate::{camera_ray, start};
use super::stages::intersect::intersect_all;
use super::stages::light::{self, LightRayProgress};
use super::stages::record::{record_end, record_step};
use super::stages::shade::{gather, shade};
use super::stats::{Counters, Lap, StageTimes};
use super::transport::{Landing, Moved, Outcome, Start, Transport};
use super::vertex::Vertex;
use super::work::Work;
use crate::geometry::{PrimitiveId, Search};
use crate::math::columns::{Columns, LANES};
use crate::spacetime::AtInfinity;

/// A worker's rays.
pub struct Wavefront<T: Transport> {
    flights: Columns<T::Flight>,
    moves: Columns<T::Move>,
    paths: Columns<Path>,
    /// Empty without light sampling.
    vertices: Columns<Vertex>,
    /// Payloads of rays where their paths were scattered last.
    carried: Vec<T::Carried>,
    /// Payloads of rays where they ended in this round.
    arrived: Vec<T::Carried>,
    /// True for rays whose exact landing matters.
    exactly: Vec<bool>,
    draws: Draws,
    search: Search<T::Segment>,
    scratch: T::Scratch,
    /// Lanes in use.
    live: usize,
    capacity: usize,
    events: Events<T::Carried>,
}

/// Events of a round, as lists of lanes.
#[derive(Default)]
struct Events<C> {
    /// Rays to be launched.
    starts: Vec<(usize, Start<C>)>,
    landed: Vec<(usize, Landing)>,
    /// Light rays that ended, at their target or not.
    lit: Vec<(usize, bool)>,
    /// Light rays that met mirrors or glass, or what they look for behind them.
    specular: Vec<(usize, Landing)>,
    /// Light rays that left beyond mirrors and glass.
    gone: Vec<(usize, AtInfinity)>,
    escaped: Vec<(usize, AtInfinity)>,
    ended: Vec<(usize, RayEnd)>,
    finished: Vec<usize>,
}

impl<T: Transport> Wavefront<T> {
    /// A wavefront of at most `capacity` lanes.
    pub fn new(capacity: usize) -> Self {
        Self {
            flights: Columns::default(),
            moves: Columns::default(),
            paths: Columns::default(),
            vertices: Columns::default(),
            carried: Vec::new(),
            arrived: Vec::new(),
            exactly: Vec::new(),
            draws: Draws::default(),
            search: Search::default(),
            scratch: T::Scratch::default(),
            live: 0,
            capacity,
            events: Events::default(),
        }
    }

    /// Traces all paths of `work` into `samples`; `None`, and the samples are worth nothing, if it had to give up.
    pub fn trace(
        &mut self,
        job: &Job,
        transport: &T,
        work: &Work,
        samples: &mut Samples,
        counters: &mut Counters,
        times: &mut StageTimes,
    ) -> Option<()> {
        self.resize(self.capacity.min(work.paths() as usize), job.illumination.is_some());
        let mut next = 0;
        let mut lap = Lap::start();
        loop {
            if job.halt.is_due() {
                self.live = 0;
                return None;
            }
            let before = self.live;
            self.generate(job, transport, work, &mut next, counters);
            lap.end(|times| &mut times.generate, self.live - before);
            if self.live == 0 {
                times.add(&lap.finish());
                return Some(());
            }
            lap.count(self.live, self.exactly.len(), LANES);
            transport.advance_all(self.flights.blocks(self.live), self.moves.blocks_mut(self.live));
            lap.end(|times| &mut times.advance, self.live);
            self.intersect(job, transport, counters);
            lap.end(|times| &mut times.intersect, self.live);
            self.settle(job, transport, samples, counters);
            lap.end(|times| &mut times.settle, self.live);
            let Events { landed, lit, specular, gone, escaped, ended, .. } = &self.events;
            let (lost, met) =
                (escaped.len() + ended.len(), landed.len() + lit.len() + specular.len() + gone.len());
            self.escape(job, samples);
            lap.end(|times| &mut times.escape, lost);
            self.through_specular(job);
            self.gather(counters);
            self.shade(job, samples, counters);
            transport.launch_all(&self.events.starts, &mut self.flights, &mut self.scratch);
            self.events.starts.clear();
            lap.end(|times| &mut times.scatter, met);
            let finished = self.events.finished.len();
            self.film(samples);
            lap.end(|times| &mut times.film, finished);
        }
    }

    fn resize(&mut self, lanes: usize, has_vertices: bool) {
        self.flights.resize(lanes);
        self.moves.resize(lanes);
        self.paths.resize(lanes);
        self.vertices.resize(if has_vertices { lanes } else { 0 });
        self.carried.resize(lanes, T::Carried::default());
        self.arrived.resize(lanes, T::Carried::default());
        self.exactly.resize(lanes, true);
    }

    /// Fills free lanes with camera paths, from number `next` on.
    fn generate(&mut self, job: &Job, transport: &T, work: &Work, next: &mut u32, counters: &mut Counters) {
        let free = (self.exactly.len() - self.live).min((work.paths() - *next) as usize);
        let fresh = self.live..self.live + free;
        for (lane, index) in fresh.clone().zip(*next..) {
            self.paths.set(lane, start(job, work, index));
        }
        let Self { paths, draws, .. } = self;
        draws.cameras(job, fresh.clone().map(|lane| paths.get(lane)));
        for (place, lane) in fresh.enumerate() {
            let path = paths.get(lane);
            let (position, direction) = camera_ray(job, &path, draws.camera(place));
            if job.illumination.is_some() {
                self.vertices.set(lane, Vertex::default());
            }
            self.exactly[lane] = true;
            let carried = T::Carried::default();
            let origin_prim = PrimitiveId::none_on(job.scene.camera.side);
            let start = Start { position, direction, origin_prim, carried };
            self.events.starts.push((lane, start));
            counters.paths += u64::from(path.gathers != Gathers::Lamps);
        }
        self.live += free;
        *next += free as u32;
        counters.rays += free as u64;
        transport.launch_all(&self.events.starts, &mut self.flights, &mut self.scratch);
        self.events.starts.clear();
    }

    fn intersect(&mut self, job: &Job, transport: &T, counters: &mut Counters) {
        let Self { flights, moves, search, live, .. } = self;
        intersect_all(transport, &job.scene.geometry, (flights, moves), search, *live, counters);
    }

    /// Sorts lanes by what became of their rays; those still flying take their step.
    fn settle(&mut self, job: &Job, transport: &T, samples: &mut Samples, counters: &mut Counters) {
        self.record_steps(transport, samples);
        let lit = |vertices: &Columns<Vertex>, lane: usize| {
            job.illumination.as_ref().filter(|_| vertices.get(lane).light_ray_in_flight)
        };
        let Self { flights, moves, vertices, arrived, search, exactly, live, events, scratch, .. } = self;
        // Only punctual lights are passed.
        if let Some(illumination) = job.illumination.as_ref().filter(|i| i.lights.has_points()) {
            for lane in (0..*live).filter(|&lane| vertices.get(lane).light_ray_in_flight) {
                let ray = (&flights.get(lane), &moves.get(lane), search.found[lane]);
                if light::passes_its_light(illumination, transport, ray, &vertices.get(lane)) {
                    events.lit.push((lane, true));
                }
            }
        }
        let passed = events.lit.len();
        let fates = &mut counters.fates;
        let geometry = &job.scene.geometry;
        let (found, exactly) = (&search.found[..*live], &exactly[..*live]);
        transport.settle_all(
            Moved { geometry, flights, moves, found, exactly },
            scratch,
            |lane, outcome, carried| {
                arrived[lane] = carried;
                if let Some(illumination) = lit(vertices, lane) {
                    if events.lit[..passed].binary_search(&(lane, true)).is_ok() {
                        return;
                    }
                    match light::conclude(illumination, &vertices.get(lane), outcome) {
                        LightRayProgress::Flying(_) => {}
                        LightRayProgress::Ended(is_reached) => events.lit.push((lane, is_reached)),
                        LightRayProgress::Landed(landing) => events.specular.push((lane, landing)),
                        LightRayProgress::Escaped(there) => events.gone.push((lane, there)),
                    }
                    return;
                }
                match outcome {
                    Outcome::Flying(_) => {}
                    Outcome::Landed(landing) => {
                        fates.hit += 1;
                        events.landed.push((lane, landing));
                    }
                    Outcome::Escaped(there) => {
                        fates.escaped += 1;
                        events.escaped.push((lane, there));
                    }
                    Outcome::Captured => {
                        fates.captured += 1;
                        events.ended.push((lane, RayEnd::Captured));
                    }
                    Outcome::StepLimit => {
                        fates.step_limit += 1;
                        events.ended.push((lane, RayEnd::StepLimit));
                    }
                    Outcome::NonFinite => {
                        fates.non_finite += 1;
                        events.ended.push((lane, RayEnd::NonFinite));
                    }
                }
            },
        );
    }

    /// Records moves for the planes that want them.
    fn record_steps(&self, transport: &T, samples: &mut Samples) {
        if !(samples.needs().steps || samples.needs().length) {
            return;
        }
        for lane in 0..self.live {
            let light_ray_in_flight =
                !self.vertices.is_empty() && self.vertices.get(lane).light_ray_in_flight;
            let length = || {
                let point = self.search.found[lane].map(|found| found.point);
                transport.length(&self.flights.get(lane), &self.moves.get(lane), point)
            };
            record_step(&self.paths.get(lane), light_ray_in_flight, length, samples);
        }
    }

    /// Ends the paths whose rays met nothing.
    fn escape(&mut self, job: &Job, samples: &mut Samples) {
        for (lane, there) in self.events.escaped.drain(..) {
            let mut path = self.paths.get(lane);
            let vertex = if job.illumination.is_some() { self.vertices.get(lane) } else { Vertex::default() };
            escape(job, &mut path, &vertex, there);
            record_end(job, &path, RayEnd::Escaped, Some(there.side), samples);
            self.paths.set(lane, path);
            self.events.finished.push(lane);
        }
        for (lane, fate) in self.events.ended.drain(..) {
            record_end(job, &self.paths.get(lane), fate, None, samples);
            self.events.finished.push(lane);
        }
    }

    /// Takes light rays through mirrors and glass.
    fn through_specular(&mut self, job: &Job) {
        for (lane, landing) in self.events.specular.drain(..) {
            let (mut path, mut vertex) = (self.paths.get(lane), self.vertices.get(lane));
            match light::through_specular(job, &mut path, &mut vertex, &landing) {
                Some(direction) => {
                    let Landing { position, primitive: origin_prim, .. } = landing;
                    let carried = self.arrived[lane];
                    self.events.starts.push((lane, Start { position, direction, origin_prim, carried }));
                }
                None => self.events.lit.push((lane, false)),
            }
            self.paths.set(lane, path);
            self.vertices.set(lane, vertex);
        }
        for (lane, there) in self.events.gone.drain(..) {
            let mut path = self.paths.get(lane);
            light::escape(job, &mut path, &self.vertices.get(lane), there);
            self.paths.set(lane, path);
            self.events.lit.push((lane, false));
        }
    }

    /// Adds what light rays brought and launches the continuations of their paths in the same lanes.
    fn gather(&mut self, counters: &mut Counters) {
        for (lane, is_reached) in self.events.lit.drain(..) {
            let (mut path, mut vertex) = (self.paths.get(lane), self.vertices.get(lane));
            match gather(&mut path, &mut vertex, is_reached) {
                Some(direction) => {
                    let Vertex { position, origin_prim, .. } = vertex;
                    self.exactly[lane] = true;
                    let carried = self.carried[lane];
                    self.events.starts.push((lane, Start { position, direction, origin_prim, carried }));
                    counters.rays += 1;
                }
                None => self.events.finished.push(lane),
            }
            self.paths.set(lane, path);
            self.vertices.set(lane, vertex);
        }
    }

    /// Gathers emission where rays landed and launches light rays or continuations in the same lanes.
    fn shade(&mut self, job: &Job, samples: &mut Samples, counters: &mut Counters) {
        let Self { paths, draws, .. } = self;
        draws.vertices(job, self.events.landed.iter().map(|&(lane, _)| paths.get(lane)));
        for (place, (lane, landing)) in self.events.landed.drain(..).enumerate() {
            let mut path = self.paths.get(lane);
            let mut vertex = Vertex::default();
            if job.illumination.is_some() {
                vertex = self.vertices.get(lane);
            }
            match shade(job, &mut path, &mut vertex, &landing, &self.draws.vertex(place), samples) {
                Some(direction) => {
                    let Landing { position, primitive: origin_prim, .. } = landing;
                    self.exactly[lane] = !vertex.light_ray_in_flight || light::lands_exactly(&vertex);
                    let carried = self.arrived[lane];
                    self.carried[lane] = carried;
                    self.events.starts.push((lane, Start { position, direction, origin_prim, carried }));
                    counters.count_ray(vertex.light_ray_in_flight);
                }
                None => self.events.finished.push(lane),
            }
            self.paths.set(lane, path);
            if job.illumination.is_some() {
                self.vertices.set(lane, vertex);
            }
        }
    }

    /// Hands in finished paths and closes their lanes up, from the back so that no finished lane is moved.
    fn film(&mut self, samples: &mut Samples) {
        self.events.finished.sort_unstable();
        while let Some(lane) = self.events.finished.pop() {
            let Path { slot, radiance, .. } = self.paths.get(lane);
            samples.radiance[slot as usize] = radiance;
            self.live -= 1;
            self.paths.set(lane, self.paths.get(self.live));
            self.flights.set(lane, self.flights.get(self.live));
            self.carried[lane] = self.carried[self.live];
            self.exactly[lane] = self.exactly[self.live];
            if !self.vertices.is_empty() {
                self.vertices.set(lane, self.vertices.get(self.live));
            }
        }
    }
}
