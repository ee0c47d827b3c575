//! Ctrl-C (and a polite kill): the first ends the render and keeps the picture, the second ends the process.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::say;
use crate::film::atomic;

/// Exit code of a process that an interruption ended, as shells count it.
const INTERRUPTED: i32 = 130;

/// What the signal handler and the render know of each other.
#[derive(Clone, Default)]
pub(super) struct Interrupt {
    worth_keeping: Arc<AtomicBool>,
    cancelled: Arc<AtomicBool>,
}

impl Interrupt {
    /// Catches interruptions from now on.
    pub(super) fn install() -> Self {
        let interrupt = Self::default();
        let handler = interrupt.clone();
        if let Err(error) = ctrlc::set_handler(move || handler.interrupted()) {
            say(format!("warning: Ctrl-C will end the render without keeping the picture: {error}"));
        }
        interrupt
    }

    /// From now on there is a picture to keep; an interruption before ends the process.
    pub(super) fn render_begins(&self) {
        self.worth_keeping.store(true, Ordering::SeqCst);
    }

    /// Set by the first interruption of a render.
    pub(super) fn flag(&self) -> &AtomicBool {
        &self.cancelled
    }

    /// Whether the render was interrupted.
    pub(super) fn happened(&self) -> bool {
        self.cancelled.load(Ordering::SeqCst)
    }

    fn interrupted(&self) {
        if !self.worth_keeping.load(Ordering::SeqCst) || self.cancelled.swap(true, Ordering::SeqCst) {
            atomic::exit(INTERRUPTED);
        }
        say("\ninterrupted: writing what is there; once more to quit at once");
    }
}
