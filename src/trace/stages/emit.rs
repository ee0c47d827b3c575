//! Light from surfaces.

use glam::Vec3;

use super::super::illumination::LightEnd;
use super::super::job::Job;
use super::super::path::Path;
use super::super::transport::Landing;
use super::super::vertex::Vertex;
use super::deposit::{EmitterId, LightSource, deposit};
use super::light::share;
use super::meet::Meeting;
use crate::light::EmitterHit;
use crate::shade::Material;

/// Adds what the surface emits towards a path that lands on it, less what light sampling finds.
#[inline]
pub fn emit(
    job: &Job,
    meeting: &Meeting,
    material: &Material,
    landing: &Landing,
    vertex: &Vertex,
    path: &mut Path,
) {
    let surface = &meeting.surface;
    let front = landing.direction.dot(surface.normal) < 0.0;
    if material.emission != Vec3::ZERO && (front || material.emits_both_sides) {
        let &Meeting { primitive, .. } = meeting;
        let source = LightSource { emitter: EmitterId::Surface(primitive), segments: path.depth };
        let throughput = path.throughput;
        deposit(path, source, || {
            let &Landing { position, direction: arrival, .. } = landing;
            let hit = EmitterHit { primitive, position, normal: surface.normal, arrival };
            let share = share(job, vertex, LightEnd::Surface(hit));
            throughput * material.emission * share
        });
    }
}
