//! Worker threads: each traces with its own wavefront and keeps its own counts.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::edges::Edges;
use super::per_pixel;
use super::samples::Samples;
use super::stats::{Counters, StageTimes};
use super::tile::Tile;
use super::transport::Transport;
use super::wavefront::Wavefront;
use super::work::{Job, Lattice, Share, Work};
use crate::film::Wanted;
use crate::scene::Schedule;

/// The worker threads of a render.
pub struct Workers<'a, T: Transport>(Vec<Mutex<Worker<'a, T>>>);

/// One of them.
pub struct Worker<'a, T: Transport> {
    job: &'a Job<'a>,
    transport: &'a T,
    schedule: Schedule,
    wanted: Wanted,
    wavefront: Wavefront<T>,
    counters: Counters,
    times: StageTimes,
}

impl<'a, T: Transport> Workers<'a, T> {
    /// One for each of rayon's threads, with wavefronts of `batch` lanes, by the schedule of the settings.
    pub fn new(job: &'a Job<'a>, transport: &'a T, wanted: Wanted, batch: usize) -> Self {
        Self::scheduled(job, transport, wanted, batch, job.settings.schedule)
    }

    /// The same by another schedule.
    pub fn scheduled(
        job: &'a Job<'a>,
        transport: &'a T,
        wanted: Wanted,
        batch: usize,
        schedule: Schedule,
    ) -> Self {
        let worker = || Worker {
            job,
            transport,
            schedule,
            wanted,
            wavefront: Wavefront::new(batch),
            counters: Counters::default(),
            times: StageTimes::default(),
        };
        Self((0..rayon::current_num_threads()).map(|_| Mutex::new(worker())).collect())
    }

    /// The worker of the thread that asks; threads never wait here.
    pub fn own(&self) -> MutexGuard<'_, Worker<'a, T>> {
        self.0[rayon::current_thread_index().unwrap_or(0)].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What all of them did, how long it took them, and how many they are.
    pub fn finish(self) -> (Counters, StageTimes, usize) {
        let (mut counters, mut times) = (Counters::default(), StageTimes::default());
        let threads = self.0.len();
        for worker in self.0 {
            let worker = worker.into_inner().unwrap_or_else(PoisonError::into_inner);
            counters.add(&worker.counters);
            times.add(&worker.times);
        }
        (counters, times, threads)
    }
}

impl<T: Transport> Worker<'_, T> {
    /// Finds more `edges` of lamps in the part of the picture that starts at `origin`, of `size` pixels, before its sample
    /// of number `first_sample`; `None` if it had to give up.
    pub fn refine(
        &mut self,
        edges: &mut Edges,
        (origin, size): ((usize, usize), (usize, usize)),
        first_sample: u32,
    ) -> Option<Edges> {
        let Job { scene, settings, .. } = *self.job;
        if !Edges::are_useful(scene) {
            return Some(Edges::default());
        }
        edges.refine((origin, size), settings, first_sample, |work| self.trace(work, Wanted::default()))
    }

    /// Adds samples to each pixel of `tile`, up to `end` in all, of which few may be left to a pass, and takes those of pixels
    /// that turn out to be at edges of lamps again: how many camera paths were added; `None`, and nothing changed in the
    /// tile, if it had to give up.
    pub fn pass(&mut self, tile: &mut Tile, edges: &mut Edges, end: u32) -> Option<u64> {
        let found = self.refine(edges, (tile.origin, tile.size), tile.spp)?;
        let again = self.samples(tile, Share::Beyond(&found), 0..tile.spp)?;
        let count = end - tile.spp;
        let samples = self.samples(tile, Share::Whole(edges), tile.spp..end)?;
        tile.replace(found.pixels(), &again);
        tile.add(&samples, count);
        Some(u64::from(count) * (tile.size.0 * tile.size.1) as u64)
    }

    /// Samples of pixels of `tile`, with what short paths see of lamps at their edges; `None` if it had to give up.
    pub fn samples(&mut self, tile: &Tile, share: Share, numbers: Range<u32>) -> Option<Samples> {
        let Tile { origin, size, .. } = *tile;
        let (first_sample, count) = (numbers.start, numbers.len() as u32);
        let work = Work { origin, size, lattice: Lattice::ALL, first_sample, samples: count, share };
        let mut samples = self.trace(&work, self.wanted)?;
        if let Share::Whole(edges) | Share::Beyond(edges) = share
            && let Some(short) = edges.work(&work)
        {
            edges.add(&self.trace(&short, Wanted::default())?, &work, &mut samples);
        }
        Some(samples)
    }

    /// The samples of `work`; `None` if it had to give up.
    pub fn trace(&mut self, work: &Work, wanted: Wanted) -> Option<Samples> {
        let mut samples = Samples::new(wanted, work.paths() as usize);
        let Self { job, transport, schedule, wavefront, counters, times, .. } = self;
        match schedule {
            Schedule::Wavefront => wavefront.trace(job, *transport, work, &mut samples, counters, times)?,
            Schedule::PerPixel => per_pixel::trace(job, *transport, work, &mut samples, counters)?,
        }
        Some(samples)
    }
}
