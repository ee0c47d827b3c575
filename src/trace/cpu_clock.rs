//! CPU time: what is computed is timed by it, since wall time grows where other programs want the machine as well.
//!
//! Where the system does not tell it, wall time stands for it.

use std::sync::LazyLock;
use std::time::{Duration, Instant};

use cpu_time::{ProcessTime, ThreadTime};

static START: LazyLock<Instant> = LazyLock::new(Instant::now);

/// CPU time of the thread that asks, since it began.
pub fn of_thread() -> Duration {
    ThreadTime::try_now().map_or_else(|_| START.elapsed(), |now| now.as_duration())
}

/// CPU time of all threads of the process, since it began.
pub fn of_process() -> Duration {
    ProcessTime::try_now().map_or_else(|_| START.elapsed(), |now| now.as_duration())
}
