//! Renders that are run to their end to be measured.

use std::sync::atomic::AtomicBool;

use crate::scene::Baked;
use crate::trace::{self, Progress, Rendered, Run};

/// Renders `scene` with nobody to interrupt it; `progress` is told from worker threads how far it has come.
pub(super) fn render(scene: &Baked, run: &Run, progress: &(dyn Fn(Progress) + Sync)) -> Rendered {
    trace::render(scene, run, &AtomicBool::new(false), progress)
}
