//! The wavefront schedule: a batch of rays advances one move at a time, stage after stage.
//!
//! A worker owns its wavefront; nothing is shared and nothing is atomic. Lanes are dense: a path that ends leaves its
//! lane to a new camera path, and when none are left, to the last lane. What a lane computes depends on its path alone,
//! so the picture depends neither on the batch size nor on the order of lanes.
//!
//! What every round needs of all rays is held in columns, what is needed only where a ray ends in rows, which are
//! worked on in their place.

use super::job::Job;
use super::path::{Gathers, Path};
use super::ray_cone::RayCone;
use super::ray_end::RayEnd;
use super::samples::Samples;
use super::stages::absorb::absorb;
use super::stages::draw::Draws;
use super::stages::escape::escape;
use super::stages::generate::{camera_ray, start};
use super::stages::intersect::intersect_all;
use super::stages::light::{self, LightRayProgress};
use super::stages::pass::{behind, passes};
use super::stages::record::{record_beside, record_end, record_entrance, record_halo, record_step};
use super::stages::shade::{Shading, gather};
use super::stats::{Counters, Fates, Lap, StageTimes};
use super::transport::{Landing, Moved, Outcome, Start, Transport};
use super::vertex::Vertex;
use super::work::Work;
use crate::geometry::{PrimitiveId, Search, Sought};
use crate::light::Target;
use crate::math::columns::{Columns, LANES};
use crate::spacetime::AtInfinity;

/// A worker's rays.
pub struct Wavefront<T: Transport> {
    flights: Columns<T::Flight>,
    moves: Columns<T::Move>,
    /// Those of the lanes in use.
    paths: Vec<Path>,
    /// Those of the lanes in use; empty without light sampling.
    vertices: Vec<Vertex>,
    /// Cones of camera rays and of those that scattering sent; those of the lanes in use, empty if no texture can be
    /// filtered.
    cones: Vec<RayCone>,
    /// Payloads of rays where their paths were scattered last.
    carried: Vec<T::Carried>,
    /// Payloads of rays where they ended in this round.
    arrived: Vec<T::Carried>,
    /// True for rays whose exact landing matters.
    exactly: Vec<bool>,
    draws: Draws,
    shading: Shading,
    search: Search<T::Segment>,
    scratch: T::Scratch,
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
    /// Light rays that met mirrors or glass, or what they look for behind them, or a textured lamp.
    specular: Vec<(usize, Landing)>,
    /// Light rays that left beyond mirrors and glass.
    gone: Vec<(usize, AtInfinity)>,
    escaped: Vec<(usize, AtInfinity)>,
    ended: Vec<(usize, RayEnd)>,
    /// Lanes whose paths have ended.
    finished: Vec<usize>,
    /// Lanes whose paths have no camera ray.
    beside: Vec<usize>,
}

impl<C> Events<C> {
    /// Adds the end of a ray that met nothing.
    fn lose<F>(&mut self, lane: usize, outcome: Outcome<F>, fates: &mut Fates) {
        let Ok(end) = outcome.end() else { return };
        let fate = RayEnd::of(&end);
        fates.count(fate);
        match end {
            Outcome::Escaped(there) => self.escaped.push((lane, there)),
            _ => self.ended.push((lane, fate)),
        }
    }
}

impl<T: Transport> Wavefront<T> {
    /// A wavefront of at most `capacity` lanes.
    pub fn new(capacity: usize) -> Self {
        Self {
            flights: Columns::default(),
            moves: Columns::default(),
            paths: Vec::new(),
            vertices: Vec::new(),
            cones: Vec::new(),
            carried: Vec::new(),
            arrived: Vec::new(),
            exactly: Vec::new(),
            draws: Draws::default(),
            shading: Shading::default(),
            search: Search::default(),
            scratch: T::Scratch::default(),
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
        self.resize(self.capacity.min(work.paths() as usize));
        let mut next = 0;
        let mut lap = Lap::start();
        loop {
            if job.halt.is_due() {
                return None;
            }
            let fresh = self.generate(job, transport, work, &mut next, samples, counters);
            lap.end(|times| &mut times.generate, fresh);
            let live = self.paths.len();
            if live == 0 {
                times.add(&lap.finish());
                return Some(());
            }
            lap.count(live, self.exactly.len(), LANES);
            transport.advance_all(self.flights.blocks(live), self.moves.blocks_mut(live));
            lap.end(|times| &mut times.advance, live);
            self.intersect(job, transport, counters);
            lap.end(|times| &mut times.intersect, live);
            self.settle(job, transport, samples, counters);
            lap.end(|times| &mut times.settle, live);
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
            self.film(samples);
            lap.end(|times| &mut times.film, self.events.finished.len());
        }
    }

    /// Makes room for `lanes` rays, and forgets those of work that was given up.
    fn resize(&mut self, lanes: usize) {
        self.flights.resize(lanes);
        self.moves.resize(lanes);
        self.paths.clear();
        self.vertices.clear();
        self.cones.clear();
        self.events.finished.clear();
        self.carried.resize(lanes, T::Carried::default());
        self.arrived.resize(lanes, T::Carried::default());
        self.exactly.resize(lanes, true);
    }

    /// Fills lanes of finished paths and free ones with camera paths, from number `next` on: how many. Lanes that are
    /// left over are closed up.
    fn generate(
        &mut self,
        job: &Job,
        transport: &T,
        work: &Work,
        next: &mut u32,
        samples: &mut Samples,
        counters: &mut Counters,
    ) -> usize {
        let mut fresh = 0;
        loop {
            fresh += self.fill(job, transport, work, next, samples, counters);
            // Beside the picture of a fisheye paths end before they start, past all geometry as they start.
            if self.events.finished.is_empty() {
                return fresh;
            }
        }
    }

    /// Fills lanes once; those whose paths have no camera ray are finished.
    fn fill(
        &mut self,
        job: &Job,
        transport: &T,
        work: &Work,
        next: &mut u32,
        samples: &mut Samples,
        counters: &mut Counters,
    ) -> usize {
        let left = (work.paths() - *next) as usize;
        self.close_up(left);
        let Self { paths, vertices, cones, exactly, draws, events, .. } = self;
        let Events { finished: lanes, starts, beside, .. } = events;
        let free = paths.len()..exactly.len().min(paths.len() + left - lanes.len());
        for (&lane, index) in lanes.iter().zip(*next..) {
            paths[lane] = start(job, work, index);
        }
        let first = *next + lanes.len() as u32;
        paths.extend(free.clone().zip(first..).map(|(_, index)| start(job, work, index)));
        if job.illumination.is_some() {
            lanes.iter().for_each(|&lane| vertices[lane] = Vertex::default());
            vertices.resize(paths.len(), Vertex::default());
        }
        if job.cones.is_some() {
            cones.resize(paths.len(), RayCone::default());
        }
        lanes.extend(free);
        draws.cameras(job, lanes.iter().map(|&lane| &paths[lane]));
        for (place, &lane) in lanes.iter().enumerate() {
            let path = &paths[lane];
            let Some((position, direction)) = camera_ray(job, path, draws.camera(place)) else {
                record_beside(path, samples);
                beside.push(lane);
                continue;
            };
            exactly[lane] = job.lands_exactly(samples.needs());
            if let Some(of_scene) = &job.cones {
                cones[lane] = of_scene.of_camera(job.scene, path.sample, (position, direction));
            }
            let carried = T::Carried::default();
            let origin_prim = PrimitiveId::none_on(job.scene.camera.side);
            starts.push((lane, Start { position, direction, origin_prim, carried }));
            counters.paths += u64::from(path.gathers != Gathers::Lamps);
        }
        *next += lanes.len() as u32;
        let fresh = starts.len();
        lanes.clear();
        lanes.append(beside);
        counters.rays += fresh as u64;
        self.enter(transport, samples, counters);
        self.escape(job, samples);
        self.film(samples);
        fresh
    }

    /// Launches camera rays.
    fn enter(&mut self, transport: &T, samples: &mut Samples, counters: &mut Counters) {
        let Self { flights, scratch, paths, events, .. } = self;
        let starts = std::mem::take(&mut events.starts);
        transport.enter_all(&starts, flights, scratch, |lane, outcome, _| {
            events.lose(lane, outcome, &mut counters.fates);
        });
        if samples.needs().length {
            for (lane, start) in &starts {
                let length = || transport.length_before(start, &flights.get(*lane));
                record_entrance(&paths[*lane], length, samples);
            }
        }
        events.starts = starts;
        events.starts.clear();
    }

    /// Gives lanes of finished paths to the last paths, from the back so that no finished lane is moved, until only
    /// `kept` are left.
    fn close_up(&mut self, kept: usize) {
        let Self { flights, paths, vertices, cones, carried, exactly, events, .. } = self;
        if events.finished.len() <= kept {
            return;
        }
        events.finished.sort_unstable();
        for lane in events.finished.drain(kept..).rev() {
            paths.swap_remove(lane);
            let last = paths.len();
            flights.set(lane, flights.get(last));
            (carried[lane], exactly[lane]) = (carried[last], exactly[last]);
            if !vertices.is_empty() {
                vertices.swap_remove(lane);
            }
            if !cones.is_empty() {
                cones.swap_remove(lane);
            }
        }
    }

    fn intersect(&mut self, job: &Job, transport: &T, counters: &mut Counters) {
        let Self { flights, moves, search, paths, vertices, .. } = self;
        let sought = |lane: usize| match vertices.get(lane) {
            Some(vertex) if vertex.light_ray_in_flight => light::sought(job, vertex),
            _ => Sought::First,
        };
        let geometry = &job.scene.geometry;
        intersect_all(transport, geometry, (flights, moves), search, (paths.len(), sought), counters);
    }

    /// Sorts lanes by what became of their rays; those still flying take their step.
    fn settle(&mut self, job: &Job, transport: &T, samples: &mut Samples, counters: &mut Counters) {
        self.record_steps(transport, samples);
        self.record_halos(job, transport, samples);
        self.absorb(job, transport);
        let Self { flights, moves, paths, vertices, arrived, search, exactly, events, scratch, .. } = self;
        let (live, vertices) = (paths.len(), &*vertices);
        let lit = |lane: usize| {
            let illumination = job.illumination.as_ref()?;
            Some((illumination, vertices.get(lane).filter(|vertex| vertex.light_ray_in_flight)?))
        };
        // Only punctual lights are passed.
        if job.illumination.as_ref().is_some_and(|illumination| illumination.lights.has_points()) {
            for lane in 0..live {
                let Some((illumination, vertex)) = lit(lane) else { continue };
                let ray = (&flights.get(lane), &moves.get(lane), search.found.get(lane));
                if light::passes_its_light(illumination, transport, ray, vertex) {
                    events.lit.push((lane, true));
                }
            }
        }
        let passed = events.lit.len();
        let fates = &mut counters.fates;
        let geometry = &job.scene.geometry;
        let (found, exactly) = (&search.found, &exactly[..live]);
        transport.settle_all(
            Moved { geometry, flights, moves, found, exactly },
            scratch,
            |lane, outcome, carried| {
                arrived[lane] = carried;
                if let Some((illumination, vertex)) = lit(lane) {
                    let may_have_passed = passed > 0 && matches!(vertex.target, Target::Point(_));
                    if may_have_passed && events.lit[..passed].binary_search(&(lane, true)).is_ok() {
                        return;
                    }
                    match light::conclude(job, illumination, &mut paths[lane], vertex, outcome) {
                        LightRayProgress::Flying(_) => {}
                        LightRayProgress::Passes(landing) => {
                            events.starts.push((lane, behind(&landing, carried)));
                        }
                        LightRayProgress::Ended(is_reached) => events.lit.push((lane, is_reached)),
                        LightRayProgress::Landed(landing) => events.specular.push((lane, landing)),
                        LightRayProgress::Escaped(there) => events.gone.push((lane, there)),
                    }
                    return;
                }
                match outcome {
                    Outcome::Flying(_) => {}
                    Outcome::Landed(landing) if passes(job, &mut paths[lane], &landing) => {
                        events.starts.push((lane, behind(&landing, carried)));
                    }
                    Outcome::Landed(landing) => {
                        fates.hit += 1;
                        geometry.prefetch_surface(landing.primitive);
                        events.landed.push((lane, landing));
                    }
                    lost => events.lose(lane, lost, fates),
                }
            },
        );
    }

    /// Records moves for the planes that want them.
    fn record_steps(&self, transport: &T, samples: &mut Samples) {
        if !(samples.needs().steps || samples.needs().length) {
            return;
        }
        for (lane, path) in self.paths.iter().enumerate() {
            let light_ray_in_flight =
                self.vertices.get(lane).is_some_and(|vertex| vertex.light_ray_in_flight);
            let length = || {
                let point = self.search.found.get(lane).map(|found| found.point);
                transport.length(&self.flights.get(lane), &self.moves.get(lane), point)
            };
            record_step(path, light_ray_in_flight, length, samples);
        }
    }

    fn record_halos(&self, job: &Job, transport: &T, samples: &mut Samples) {
        if samples.near_lamps.is_empty() {
            return;
        }
        for (lane, path) in self.paths.iter().enumerate() {
            let ray = (&self.flights.get(lane), &self.moves.get(lane), self.search.found.get(lane));
            record_halo(job, transport, ray, path, samples);
        }
    }

    /// Dims paths inside of glass that absorbs.
    fn absorb(&mut self, job: &Job, transport: &T) {
        if !job.absorbs {
            return;
        }
        let Self { flights, moves, paths, vertices, search, .. } = self;
        for (lane, path) in paths.iter_mut().enumerate() {
            let ray = (&flights.get(lane), &moves.get(lane), search.found.get(lane));
            absorb(job, transport, ray, path, vertices.get_mut(lane));
        }
    }

    /// Ends the paths whose rays met nothing.
    fn escape(&mut self, job: &Job, samples: &mut Samples) {
        let Self { paths, vertices, events, .. } = self;
        let Events { escaped, ended, finished, .. } = events;
        let free = Vertex::default();
        for (lane, there) in escaped.drain(..) {
            let path = &mut paths[lane];
            escape(job, path, vertices.get(lane).unwrap_or(&free), there);
            record_end(job, path, RayEnd::Escaped, Some(there.side), samples);
            finished.push(lane);
        }
        for (lane, fate) in ended.drain(..) {
            record_end(job, &paths[lane], fate, None, samples);
            finished.push(lane);
        }
    }

    /// Takes light rays through mirrors and glass, and adds what they see.
    fn through_specular(&mut self, job: &Job) {
        let Self { paths, vertices, arrived, events, .. } = self;
        let Events { specular, gone, lit, starts, .. } = events;
        for (lane, landing) in specular.drain(..) {
            match light::land(job, &mut paths[lane], &mut vertices[lane], &landing) {
                Some(direction) => {
                    let Landing { position, primitive: origin_prim, .. } = landing;
                    let carried = arrived[lane];
                    starts.push((lane, Start { position, direction, origin_prim, carried }));
                }
                None => lit.push((lane, false)),
            }
        }
        for (lane, there) in gone.drain(..) {
            light::escape(job, &mut paths[lane], &vertices[lane], there);
            lit.push((lane, false));
        }
    }

    /// Adds what light rays brought and launches the continuations of their paths in the same lanes.
    fn gather(&mut self, counters: &mut Counters) {
        let Self { paths, vertices, carried, exactly, events, .. } = self;
        let Events { lit, starts, finished, .. } = events;
        for (lane, is_reached) in lit.drain(..) {
            let vertex = &mut vertices[lane];
            if !gather(&mut paths[lane], vertex, is_reached) {
                finished.push(lane);
                continue;
            }
            let &mut Vertex { position, direction, origin_prim, .. } = vertex;
            exactly[lane] = true;
            starts.push((lane, Start { position, direction, origin_prim, carried: carried[lane] }));
            counters.rays += 1;
        }
    }

    /// Gathers emission where rays landed and launches light rays or continuations in the same lanes.
    fn shade(&mut self, job: &Job, samples: &mut Samples, counters: &mut Counters) {
        let Self { paths, vertices, cones, carried, arrived, exactly, draws, shading, events, .. } = self;
        let Events { landed, starts, finished, .. } = events;
        draws.vertices(job, landed.iter().map(|&(lane, _)| &paths[lane]));
        shading.shade_all(
            job,
            landed,
            (paths, vertices, cones),
            draws,
            samples,
            |place, vertex, direction| {
                let (lane, landing) = landed[place];
                let Some(direction) = direction else {
                    finished.push(lane);
                    return;
                };
                let Landing { position, primitive: origin_prim, .. } = landing;
                exactly[lane] = !vertex.light_ray_in_flight || light::lands_exactly(job, vertex);
                carried[lane] = arrived[lane];
                starts.push((lane, Start { position, direction, origin_prim, carried: carried[lane] }));
                counters.count_ray(vertex.light_ray_in_flight);
            },
        );
        landed.clear();
    }

    /// Hands in finished paths.
    fn film(&mut self, samples: &mut Samples) {
        for &lane in &self.events.finished {
            let Path { slot, radiance, .. } = self.paths[lane];
            samples.radiance[slot as usize] = radiance;
        }
    }
}
