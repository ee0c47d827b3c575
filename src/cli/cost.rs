//! What a render will cost, before it is started.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use super::units::decimal;
use crate::scene::Baked;
use crate::trace::{self, Run};

/// How long the probe may take.
const PROBE: Duration = Duration::from_secs(1);

/// The estimated time of rendering `scene` as its settings say, in words: a short render sets the pace. `None` if not
/// a path ended within the probe.
pub(super) fn estimate(scene: &Baked) -> Option<String> {
    let run = Run { time_limit: Some(PROBE), ..Run::default() };
    let stats = trace::render(scene, &run, &AtomicBool::new(false), &|_| {}).stats;
    let settings = &scene.settings;
    let paths = settings.width as f64 * settings.height as f64 * f64::from(settings.spp);
    let pace = stats.paths_per_second;
    (pace > 0.0).then(|| {
        let time = humantime::format_duration(Duration::from_secs((paths / pace).ceil() as u64));
        format!(
            "about {time} on {} threads ({} paths at {} paths/s)",
            stats.threads,
            decimal(paths),
            decimal(pace)
        )
    })
}
