//! Worker threads: each traces with its own wavefront and keeps its own counts.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::job::Job;
use super::per_pixel;
use super::samples::Samples;
use super::stats::{Counters, StageTimes};
use super::transport::Transport;
use super::wavefront::Wavefront;
use super::work::{Share, Work};
use crate::film::Wanted;
use crate::scene::Schedule;

/// The worker threads of a render.
pub struct Workers<T: Transport>(Vec<Mutex<Worker<T>>>);

/// One of them.
pub struct Worker<T: Transport> {
    schedule: Schedule,
    wavefront: Wavefront<T>,
    counters: Counters,
    times: StageTimes,
}

impl<T: Transport> Workers<T> {
    /// One for each of rayon's threads, with wavefronts of `batch` lanes.
    pub fn new(schedule: Schedule, batch: usize) -> Self {
        let worker = || Worker {
            schedule,
            wavefront: Wavefront::new(batch),
            counters: Counters::default(),
            times: StageTimes::default(),
        };
        Self((0..rayon::current_num_threads()).map(|_| Mutex::new(worker())).collect())
    }

    /// The worker of the thread that asks; threads never wait here.
    pub fn own(&self) -> MutexGuard<'_, Worker<T>> {
        self.0[rayon::current_thread_index().unwrap_or(0)].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Work that all of them have done, the time that it took them, and how many they are.
    pub fn totals(&self) -> (Counters, StageTimes, usize) {
        let (mut counters, mut times) = (Counters::default(), StageTimes::default());
        for worker in &self.0 {
            let worker = worker.lock().unwrap_or_else(PoisonError::into_inner);
            counters.add(&worker.counters);
            times.add(&worker.times);
        }
        (counters, times, self.0.len())
    }
}

impl<T: Transport> Worker<T> {
    /// The samples of `work`; `None` if it had to give up.
    pub fn trace(&mut self, job: &Job, transport: &T, work: &Work, wanted: Wanted) -> Option<Samples> {
        let mut samples = Samples::new(wanted, work.paths() as usize);
        if job.halos.is_some() && matches!(work.share, Share::Lamps) {
            samples = samples.with_halos();
        }
        let Self { schedule, wavefront, counters, times } = self;
        match schedule {
            Schedule::Wavefront => wavefront.trace(job, transport, work, &mut samples, counters, times)?,
            Schedule::PerPixel => per_pixel::trace(job, transport, work, &mut samples, counters)?,
        }
        Some(samples)
    }
}
