//! Ctrl-C, and a polite kill: the first ends the render and keeps the picture, the second ends the process. Either way
//! the process ends by the signal, so that its parent knows.

use std::io;
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

use super::say::say;
use crate::film::atomic;

/// State shared by the thread that waits for signals and the render.
#[derive(Clone, Default)]
pub(super) struct Interrupt {
    has_picture: Arc<AtomicBool>,
    cancelled: Arc<AtomicBool>,
    /// The signal that came; 0 for none.
    signal: Arc<AtomicI32>,
}

impl Interrupt {
    /// Catches interruptions from now on.
    pub(super) fn install() -> Self {
        let interrupt = Self::default();
        if let Err(error) = interrupt.catch() {
            say(format!("warning: Ctrl-C will end the process without keeping anything: {error}"));
        }
        interrupt
    }

    #[cfg(unix)]
    fn catch(&self) -> io::Result<()> {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

        let hangup = (!is_ignored(SIGHUP)).then_some(SIGHUP);
        let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM].into_iter().chain(hangup))?;
        let interrupt = self.clone();
        let wait = move || signals.forever().for_each(|signal| interrupt.caught(signal));
        std::thread::Builder::new().name("signals".to_owned()).spawn(wait)?;
        Ok(())
    }

    #[cfg(not(unix))]
    fn catch(&self) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// From now on there is a picture to keep; an interruption before ends the process.
    pub(super) fn has_picture(&self) {
        self.has_picture.store(true, Ordering::SeqCst);
    }

    /// Set by the first interruption of a render.
    pub(super) fn flag(&self) -> &AtomicBool {
        &self.cancelled
    }

    /// True if the render was interrupted.
    pub(super) fn happened(&self) -> bool {
        self.cancelled.load(Ordering::SeqCst)
    }

    /// Ends the process by the signal that interrupted it, if one did.
    pub(super) fn resume(&self) {
        match self.signal.load(Ordering::SeqCst) {
            0 => {}
            signal => end_by(signal),
        }
    }

    #[cfg(unix)]
    fn caught(&self, signal: i32) {
        if self.signal.swap(signal, Ordering::SeqCst) != 0 || !self.has_picture.load(Ordering::SeqCst) {
            end_by(signal);
        }
        self.cancelled.store(true, Ordering::SeqCst);
        say("\ninterrupted: writing what is there; once more to quit at once");
    }
}

/// Ends the process as `signal` does that nobody catches.
fn end_by(signal: i32) -> ! {
    let _held_to_the_end = atomic::abandon();
    #[cfg(unix)]
    // It returns only if the system refuses, and then the exit code tells.
    let _ = signal_hook::low_level::emulate_default_handler(signal);
    process::exit(128 + signal)
}

/// True if whoever started the process had it ignore `signal`, as `nohup` does; unknown but on Linux.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
