//! Shading of a landing: the surface is looked up, recorded, gathered from, and scattered at.

use glam::{DVec3, Vec3};

use super::super::job::Job;
use super::super::path::{Gathers, Path};
use super::super::samples::Samples;
use super::super::transport::Landing;
use super::super::vertex::Vertex;
use super::deposit::{LightSource, deposit};
use super::draw::Numbers;
use super::emit::emit;
use super::light::propose;
use super::meet::meet;
use super::record::record_hit;
use super::scatter::scatter;
use crate::light::Target;

/// Takes a path through the surface it landed on: the unit direction of its next ray, which is a light ray or its
/// continuation, as `vertex` says; `None` if it ends here.
#[inline]
pub fn shade(
    job: &Job,
    path: &mut Path,
    vertex: &mut Vertex,
    landing: &Landing,
    numbers: &Numbers,
    samples: &mut Samples,
) -> Option<DVec3> {
    let meeting = meet(job.scene, landing, path.media);
    let upon;
    let landing = if meeting.primitive == landing.primitive {
        landing
    } else {
        upon = Landing { primitive: meeting.primitive, ..*landing };
        &upon
    };
    record_hit(job, path, landing, &meeting.surface, samples);
    emit(job, &meeting.surface, landing, vertex, path);
    let incidence = meeting.incidence(landing.direction, path.media);
    let is_specular = job.scene.materials[incidence.material as usize].is_specular();
    match path.gathers {
        Gathers::Lamps if !is_specular => return None,
        Gathers::Beyond if !is_specular => path.gathers = Gathers::All,
        _ => {}
    }
    let Some(illumination) = &job.illumination else {
        return scatter(job, path, &incidence, numbers.ray).map(|bounce| bounce.direction);
    };
    if is_specular && illumination.is_guided() {
        vertex.after_specular = true;
        return scatter(job, path, &incidence, numbers.ray).map(|bounce| bounce.direction);
    }
    let (depth, chance) = (path.depth + 1, illumination.chance(path.throughput));
    let light_ray = propose(job, illumination, path, &incidence, landing, numbers.light);
    let bounce = scatter(job, path, &incidence, numbers.ray);
    *vertex = Vertex {
        position: landing.position,
        normal: incidence.facing().0,
        origin_prim: landing.primitive,
        continues: bounce.is_some(),
        direction: bounce.map_or(DVec3::ZERO, |bounce| bounce.direction),
        density: bounce.map_or(0.0, |bounce| bounce.density),
        chance,
        after_specular: false,
        light_ray_in_flight: light_ray.is_some(),
        depth,
        media: incidence.media,
        target: light_ray.map_or(Target::Nothing, |ray| ray.target),
        brings: light_ray.map_or(Vec3::ZERO, |ray| ray.brings),
    };
    light_ray.map(|ray| ray.direction).or(bounce.map(|bounce| bounce.direction))
}

/// Ends a path's light ray, at its target or not: the unit direction in which the path goes on, or `None` if it ends.
#[inline]
pub fn gather(path: &mut Path, vertex: &mut Vertex, is_reached: bool) -> Option<DVec3> {
    if is_reached && let Some(source) = LightSource::reached(vertex) {
        deposit(path, source, || vertex.brings);
    }
    vertex.light_ray_in_flight = false;
    vertex.after_specular = false;
    vertex.continues.then_some(vertex.direction)
}
