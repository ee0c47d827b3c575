//! The progress bar on stderr; silent where stderr is not a terminal.

use std::fmt::Write;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::units::decimal;
use crate::trace::Progress;

/// Shows how far work has come, how fast it goes, and when it will be done.
pub(super) struct Bar(ProgressBar);

impl Bar {
    /// A bar for work that is counted in `unit`.
    pub(super) fn new(unit: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        let rate = move |state: &ProgressState, out: &mut dyn Write| {
            // The bar offers no way to report that it could not format.
            let _ = write!(out, "{} {unit}/s", decimal(state.per_sec()));
        };
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {rate}  {eta} left") {
            bar.set_style(style.with_key("rate", rate));
        }
        Self(bar)
    }

    /// Called from worker threads, whose reports may overtake each other: the bar never goes back.
    pub(super) fn update(&self, progress: Progress) {
        self.0.set_length(progress.total);
        if progress.done > self.0.position() {
            self.0.set_position(progress.done);
        }
    }

    /// Takes the bar off the screen.
    pub(super) fn finish(&self) {
        self.0.finish_and_clear();
    }
}
