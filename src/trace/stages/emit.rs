//! Light from surfaces.

use glam::Vec3;

use super::super::job::Job;
use super::super::path::{Gathers, Path};
use super::super::transport::Landing;
use super::super::vertex::Vertex;
use super::light::share;
use crate::geometry::SurfacePoint;

/// Adds what the surface emits towards a path that lands on it, less what light sampling finds, unless others gather that.
#[inline]
pub fn emit(job: &Job, surface: &SurfacePoint, landing: &Landing, vertex: &Vertex, path: &mut Path) {
    if path.gathers == Gathers::Beyond {
        return;
    }
    let material = &job.scene.materials[surface.surface.material as usize];
    let front = landing.direction.dot(surface.normal) < 0.0;
    if material.emission != Vec3::ZERO && (front || material.emits_both_sides) {
        let share = share(job, vertex, landing.direction, Some((landing, surface.normal)));
        path.radiance += path.throughput * material.emission * share;
    }
}
