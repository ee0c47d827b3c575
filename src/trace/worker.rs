//! Worker threads: each traces with its own wavefront and keeps its own counts.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::job::Job;
use super::per_pixel;
use super::samples::Samples;
use super::stats::{Counters, StageTimes};
use super::transport::Transport;
use super::wavefront::Wavefront;
use super::work::Work;
use crate::film::Wanted;
use crate::scene::Schedule;

/// The worker threads of a render.
pub struct Workers<'a, T: Transport>(Vec<Mutex<Worker<'a, T>>>);

/// One of them.
pub struct Worker<'a, T: Transport> {
    job: &'a Job<'a>,
    transport: &'a T,
    schedule: Schedule,
    wavefront: Wavefront<T>,
    counters: Counters,
    times: StageTimes,
}

impl<'a, T: Transport> Workers<'a, T> {
    /// One for each of rayon's threads, with wavefronts of `batch` lanes, by the schedule of the settings.
    pub fn new(job: &'a Job<'a>, transport: &'a T, batch: usize) -> Self {
        Self::scheduled(job, transport, batch, job.settings.schedule)
    }

    /// The same by another schedule.
    pub fn scheduled(job: &'a Job<'a>, transport: &'a T, batch: usize, schedule: Schedule) -> Self {
        let worker = || Worker {
            job,
            transport,
            schedule,
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
