//! Light from surfaces.

use glam::Vec3;

use super::super::illumination::LightEnd;
use super::super::job::Job;
use super::super::path::Path;
use super::super::transport::Landing;
use super::super::vertex::Vertex;
use super::deposit::{EmitterId, LightSource, deposit};
use super::light::share;
use crate::geometry::SurfacePoint;

/// Adds what the surface emits towards a path that lands on it, less what light sampling finds.
#[inline]
pub fn emit(job: &Job, surface: &SurfacePoint, landing: &Landing, vertex: &Vertex, path: &mut Path) {
    let material = &job.scene.materials[surface.surface.material as usize];
    let front = landing.direction.dot(surface.normal) < 0.0;
    if material.emission != Vec3::ZERO && (front || material.emits_both_sides) {
        let source = LightSource { emitter: EmitterId::Surface(landing.primitive), segments: path.depth };
        let throughput = path.throughput;
        deposit(path, source, || {
            let share = share(job, vertex, LightEnd::Surface(landing, surface.normal));
            throughput * material.emission * share
        });
    }
}
