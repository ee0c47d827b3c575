//! Work that ends before it is done: interrupted, or out of time.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time beyond the limit in which every pixel may still get its first sample: with what a round of rays takes, an
/// answer comes within a second.
const GRACE: Duration = Duration::from_millis(700);

/// Tells loops that may last long when to give up: once due, it stays due. The default never is.
#[derive(Debug, Default)]
pub struct Halt<'a> {
    cancel: Option<&'a AtomicBool>,
    deadline: Option<Instant>,
    /// True once every pixel has a sample: then the deadline holds as it is.
    has_picture: AtomicBool,
}

impl<'a> Halt<'a> {
    /// Due when `limit` has passed from now on.
    pub fn after(limit: Duration) -> Self {
        // A time beyond all clocks is no limit.
        Self { deadline: Instant::now().checked_add(limit), ..Self::default() }
    }

    /// Due when `cancel` is set or, from now on, `limit` has passed.
    pub fn new(cancel: &'a AtomicBool, limit: Option<Duration>) -> Self {
        Self { cancel: Some(cancel), ..limit.map_or_else(Self::default, Self::after) }
    }

    /// From now on there is a picture that is worth something.
    pub fn has_picture(&self) {
        self.has_picture.store(true, Ordering::Relaxed);
    }

    /// True if it is time to give up.
    pub fn is_due(&self) -> bool {
        let is_late = |deadline: Instant| {
            let late = Instant::now().checked_duration_since(deadline);
            let grace = if self.has_picture.load(Ordering::Relaxed) { Duration::ZERO } else { GRACE };
            late.is_some_and(|late| late >= grace)
        };
        self.cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) || self.deadline.is_some_and(is_late)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_ends_the_grace_and_an_interruption_needs_none() {
        let cancel = AtomicBool::new(false);
        let halt = Halt::new(&cancel, Some(Duration::ZERO));
        assert!(!halt.is_due());
        halt.has_picture();
        assert!(halt.is_due());
        let endless = Halt::new(&cancel, Some(Duration::MAX));
        assert!(!endless.is_due() && !Halt::default().is_due());
        cancel.store(true, Ordering::Relaxed);
        assert!(endless.is_due());
    }
}
