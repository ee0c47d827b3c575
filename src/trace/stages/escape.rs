//! Light from infinity.

use super::super::job::Job;
use super::super::path::Path;
use super::super::vertex::Vertex;
use super::deposit::{EmitterId, LightSource, deposit};
use super::light::share;
use crate::scene::Background;
use crate::spacetime::AtInfinity;
use crate::trace::illumination::LightEnd;

/// Adds what a path sees at infinity, less what light sampling finds; a camera ray sees nothing of a transparent
/// background.
#[inline]
pub fn escape(job: &Job, path: &mut Path, vertex: &Vertex, there: AtInfinity) {
    let source = LightSource { emitter: EmitterId::Infinity, segments: path.depth };
    let sees_through = source.segments == 1 && job.settings.background == Background::Transparent;
    let environment = job.scene.environment(there.side);
    if !sees_through && !environment.is_black() {
        let throughput = path.throughput;
        deposit(path, source, || {
            let share = share(job, vertex, LightEnd::AtInfinity(there));
            throughput * environment.radiance(there.direction) * share
        });
    }
}
