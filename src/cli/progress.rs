//! Progress of work, on stderr: a bar on a terminal, else a plain line now and then.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::say::say;
use super::units::decimal;
use crate::trace::Progress;

/// Time from one plain line to the next, and before the first.
const INTERVAL: Duration = Duration::from_secs(2);

/// Display of progress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Show {
    /// A bar on a terminal that can draw one, else plain lines.
    #[default]
    Auto,
    /// A bar, on any terminal.
    Bar,
    /// A line every 2 seconds.
    Plain,
    /// Nothing.
    None,
}

impl Show {
    fn resolve(self) -> Self {
        let is_terminal = stderr().is_terminal();
        let draws = is_terminal && std::env::var_os("TERM").is_none_or(|term| term != "dumb");
        match self {
            Self::Auto if draws => Self::Bar,
            Self::Bar if is_terminal => Self::Bar,
            Self::Auto | Self::Bar => Self::Plain,
            other => other,
        }
    }
}

/// The flag for it.
#[derive(Debug, Default, Args)]
pub(super) struct ProgressArgs {
    /// Display of progress on stderr: a bar on a terminal, a plain line every 2 seconds, or not at all
    #[arg(long, value_enum, value_name = "HOW", default_value = "auto")]
    pub(super) progress: Show,
}

/// Shows how far work has come, how fast it goes, and when it will be done.
pub(super) struct Meter {
    work: Arc<Mutex<WorkUnderWay>>,
    bar: ProgressBar,
    lines: Option<Lines>,
}

/// The work under way.
struct WorkUnderWay {
    /// Name of the work until it is counted.
    name: String,
    /// Unit in which it is counted.
    unit: &'static str,
    since: Instant,
    /// Nothing before there is something to count.
    progress: Option<Progress>,
    /// Samples per pixel of a picture.
    spp: Option<u32>,
    /// Start of the picture, and its time limit.
    limit: Option<(Instant, Duration)>,
}

/// The thread that says them.
struct Lines {
    stop: Sender<()>,
    thread: JoinHandle<()>,
}

fn lock(work: &Mutex<WorkUnderWay>) -> MutexGuard<'_, WorkUnderWay> {
    work.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Meter {
    /// A meter for work that begins now, is called `name` and will be counted in `unit`.
    pub(super) fn new(show: Show, name: impl Into<String>, unit: &'static str) -> Self {
        let (name, since) = (name.into(), Instant::now());
        let work = WorkUnderWay { name, unit, since, progress: None, spp: None, limit: None };
        let work = Arc::new(Mutex::new(work));
        let show = show.resolve();
        let bar = if show == Show::Bar { bar(unit) } else { ProgressBar::hidden() };
        let lines = (show == Show::Plain).then(|| Lines::start(work.clone())).flatten();
        Self { work, bar, lines }
    }

    /// Something else begins.
    pub(super) fn enter(&self, name: impl Into<String>) {
        let mut work = lock(&self.work);
        (work.name, work.since) = (name.into(), Instant::now());
    }

    /// A picture of so many samples per pixel begins, which ends earlier if it has a limit.
    pub(super) fn render(&self, spp: u32, limit: Option<Duration>) {
        self.enter("learning of lights");
        let mut work = lock(&self.work);
        (work.spp, work.limit) = (Some(spp), limit.map(|limit| (work.since, limit)));
    }

    /// Called from worker threads, whose reports may overtake each other: nothing goes back.
    pub(super) fn update(&self, progress: Progress) {
        let mut work = lock(&self.work);
        match &mut work.progress {
            None => (work.progress, work.since) = (Some(progress), Instant::now()),
            Some(before) if progress.done > before.done => *before = progress,
            Some(_) => return,
        }
        self.bar.set_length(progress.total);
        self.bar.set_position(progress.done);
    }

    /// Takes the bar off the screen, and ends the lines.
    pub(super) fn finish(self) {
        self.bar.finish_and_clear();
        if let Some(Lines { stop, thread }) = self.lines {
            drop(stop);
            // It cannot have panicked, and if it had, the work would be done all the same.
            let _ = thread.join();
        }
    }
}

/// A bar for work that is counted in `unit`.
fn bar(unit: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    let rate = move |state: &ProgressState, out: &mut dyn Write| {
        // The bar offers no way to report that it could not format.
        let _ = write!(out, "{} {unit}/s", decimal(state.per_sec()));
    };
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {rate}  {eta} left") {
        bar.set_style(style.with_key("rate", rate));
    }
    bar
}

impl Lines {
    /// Nothing if there can be no more threads.
    fn start(work: Arc<Mutex<WorkUnderWay>>) -> Option<Self> {
        let (stop, stopped) = channel();
        let mut next = Instant::now() + INTERVAL;
        let tell = move || {
            while stopped.recv_timeout(next.saturating_duration_since(Instant::now()))
                == Err(RecvTimeoutError::Timeout)
            {
                say(lock(&work).line(Instant::now()));
                next += INTERVAL;
            }
        };
        let thread = thread::Builder::new().name("progress".to_owned()).spawn(tell).ok()?;
        Some(Self { stop, thread })
    }
}

impl WorkUnderWay {
    fn line(&self, now: Instant) -> String {
        let elapsed = now.saturating_duration_since(self.since).as_secs_f64();
        let Some(Progress { done, total }) = self.progress.filter(|progress| progress.total > 0) else {
            return format!("{}: {}", self.name, seconds(elapsed));
        };
        let (done, total) = (done as f64, total as f64);
        let (taken, limit) = self.limit.map_or((0.0, f64::INFINITY), |(began, limit)| {
            (now.saturating_duration_since(began).as_secs_f64(), limit.as_secs_f64())
        });
        let share = (done / total).max(taken / limit).min(1.0);
        let count = match self.spp {
            Some(spp) => format!("{:.1} of {spp} samples per pixel", f64::from(spp) * done / total),
            None => format!("{done} of {total} {}", self.unit),
        };
        let rate = if elapsed > 0.0 { done / elapsed } else { 0.0 };
        let mut line = format!("{:.1} %, {count}, {} {}/s", 100.0 * share, decimal(rate), self.unit);
        let left = ((total - done) / rate).min(limit - taken);
        if left.is_finite() {
            line += &format!(", {} left", seconds(left.max(0.0)));
        }
        line
    }
}

/// A time in whole seconds, for people.
fn seconds(seconds: f64) -> String {
    humantime::format_duration(Duration::from_secs(seconds.round() as u64)).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(progress: Option<(u64, u64)>, spp: Option<u32>, limit: Option<u64>) -> String {
        let since = Instant::now();
        let progress = progress.map(|(done, total)| Progress { done, total });
        let limit = limit.map(|limit| (since, Duration::from_secs(limit)));
        let work = WorkUnderWay { name: "loading a".to_owned(), unit: "paths", since, progress, spp, limit };
        work.line(since + Duration::from_secs(10))
    }

    #[test]
    fn a_plain_line_tells_what_is_done_how_fast_and_what_is_left() {
        assert_eq!(line(None, None, None), "loading a: 10s");
        let counted = line(Some((250, 1000)), None, None);
        assert_eq!(counted, "25.0 %, 250 of 1000 paths, 25.0 paths/s, 30s left");
        let picture = line(Some((250, 1000)), Some(64), None);
        assert_eq!(picture, "25.0 %, 16.0 of 64 samples per pixel, 25.0 paths/s, 30s left");
        assert_eq!(line(Some((0, 1000)), Some(64), None), "0.0 %, 0.0 of 64 samples per pixel, 0 paths/s");
    }

    #[test]
    fn a_time_limit_counts_where_it_comes_first() {
        let limited = line(Some((1, 1_000_000)), Some(64), Some(40));
        assert_eq!(limited, "25.0 %, 0.0 of 64 samples per pixel, 0.10 paths/s, 30s left");
        assert!(line(Some((250, 1000)), Some(64), Some(1000)).starts_with("25.0 %"));
    }
}
