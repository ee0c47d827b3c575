//! Light from infinity.

use glam::DVec3;

use super::super::path::{Gathers, Path};
use super::super::vertex::Vertex;
use super::super::work::Job;
use super::light::share;

/// Adds what a path sees in the unit `direction` at infinity, less what light sampling finds.
#[inline]
pub fn escape(job: &Job, path: &mut Path, vertex: &Vertex, direction: DVec3) {
    if path.gathers != Gathers::Lamps && !job.scene.environment.is_black() {
        let share = share(job, vertex, direction, None);
        path.radiance += path.throughput * job.scene.environment.radiance(direction) * share;
    }
}
