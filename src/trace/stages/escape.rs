//! Light from infinity.

use glam::DVec3;

use super::super::path::Path;
use super::super::work::Job;

/// Adds what a path sees in the unit `direction` at infinity.
#[inline]
pub fn escape(job: &Job, path: &mut Path, direction: DVec3) {
    if !job.scene.environment.is_black() {
        path.radiance += path.throughput * job.scene.environment.radiance(direction);
    }
}
