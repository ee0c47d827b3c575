//! All that takes samples of a scene, behind one interface that does not name the transport.

use super::halt::Halt;
use super::job::Job;
use super::learn::{Lesson, learn_lights};
use super::samples::Samples;
use super::stats::{Counters, StageTimes};
use super::transport::Transport;
use super::work::Work;
use super::worker::Workers;
use crate::film::Wanted;

/// Takes samples, on the thread that asks.
pub trait Tracer: Send + Sync {
    /// Learns of the lights what passes up to so many samples are worth, see [`Lesson`], unless it is known.
    fn learn(&mut self, samples: u32);

    /// The samples of `work`; `None` if it had to give up.
    fn trace(&self, work: &Work, wanted: Wanted) -> Option<Samples>;

    /// Interruption and deadline, at which to give up.
    fn halt(&self) -> &Halt<'_>;

    /// Work that all threads have done, the time that it took them, and how many they are.
    fn totals(&self) -> (Counters, StageTimes, usize);
}

/// A job, a transport, and the workers that trace by it.
pub struct Tracing<'a, T: Transport> {
    pub job: Job<'a>,
    pub transport: T,
    pub workers: Workers<T>,
    /// The last lesson that was learned.
    pub lesson: Option<Lesson>,
}

impl<T: Transport> Tracer for Tracing<'_, T> {
    fn learn(&mut self, samples: u32) {
        let lesson = Lesson::of(self.job.settings.width * self.job.settings.height, samples);
        if self.lesson != Some(lesson) {
            learn_lights(&mut self.job, &self.transport, lesson);
            self.lesson = Some(lesson);
        }
    }

    fn trace(&self, work: &Work, wanted: Wanted) -> Option<Samples> {
        self.workers.own().trace(&self.job, &self.transport, work, wanted)
    }

    fn halt(&self) -> &Halt<'_> {
        &self.job.halt
    }

    fn totals(&self) -> (Counters, StageTimes, usize) {
        self.workers.totals()
    }
}
