//! Light from infinity.

use glam::DVec3;

use super::super::job::Job;
use super::super::path::{Gathers, Path};
use super::super::vertex::Vertex;
use super::light::share;
use crate::scene::Background;

/// Adds what a path sees in the unit `direction` at infinity, less what light sampling finds; a camera ray sees nothing of
/// a transparent background.
#[inline]
pub fn escape(job: &Job, path: &mut Path, vertex: &Vertex, direction: DVec3) {
    let sees_through = path.depth == 1 && job.settings.background == Background::Transparent;
    if path.gathers != Gathers::Lamps && !sees_through && !job.scene.environment.is_black() {
        let share = share(job, vertex, direction, None);
        path.radiance += path.throughput * job.scene.environment.radiance(direction) * share;
    }
}
