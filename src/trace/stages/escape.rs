//! Light from infinity.

use glam::DVec3;

use super::super::job::Job;
use super::super::path::Path;
use super::super::vertex::Vertex;
use super::deposit::{EmitterId, LightSource, deposit};
use super::light::share;
use crate::scene::Background;

/// Adds what a path sees in the unit `direction` at infinity, less what light sampling finds; a camera ray sees nothing
/// of a transparent background.
#[inline]
pub fn escape(job: &Job, path: &mut Path, vertex: &Vertex, direction: DVec3) {
    let source = LightSource { emitter: EmitterId::Infinity, segments: path.depth };
    let sees_through = source.segments == 1 && job.settings.background == Background::Transparent;
    if !sees_through && !job.scene.environment.is_black() {
        let throughput = path.throughput;
        deposit(path, source, || {
            let share = share(job, vertex, direction, None);
            throughput * job.scene.environment.radiance(direction) * share
        });
    }
}
