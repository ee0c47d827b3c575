//! What happens where a ray lands: the surface is looked up, recorded, gathered from, and scattered at.

use glam::DVec3;

use super::super::path::Path;
use super::super::samples::Samples;
use super::super::transport::Landing;
use super::super::work::Job;
use super::emit::emit;
use super::record::record_hit;
use super::scatter::scatter;

/// Takes a path through the surface it landed on: the unit direction it leaves in, or `None` if it ends here.
#[inline]
pub fn shade(job: &Job, path: &mut Path, landing: &Landing, samples: &mut Samples) -> Option<DVec3> {
    let surface = job.scene.geometry.surface_point(landing.primitive, landing.position);
    record_hit(job, path, landing, &surface, samples);
    emit(&job.scene.materials[surface.surface.material as usize], &surface, landing.direction, path);
    scatter(job, path, landing, &surface)
}
