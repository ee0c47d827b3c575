//! Absorption inside of glass, along rays as they run.

use glam::{DVec3, Vec3};

use super::super::job::Job;
use super::super::path::Path;
use super::super::transport::Transport;
use super::super::vertex::Vertex;
use crate::geometry::{Found, Segment};
use crate::light::Target;
use crate::shade::Media;

/// Pieces of a move through curved space, each of which is measured where its middle is.
const PIECES: u32 = 16;

/// Dims a path, or its light ray in flight, by what the glass around absorbs along a move up to what is found.
#[inline]
pub fn absorb<T: Transport>(
    job: &Job,
    transport: &T,
    ray: (&T::Flight, &T::Move, Option<Found>),
    path: &mut Path,
    vertex: Option<&mut Vertex>,
) {
    match vertex.filter(|vertex| vertex.light_ray_in_flight) {
        Some(vertex) => {
            let target = match vertex.target {
                Target::Point(index) => point_of(job, index),
                Target::Nothing
                | Target::Surface(..)
                | Target::ThroughSpecular
                | Target::SkyTile(..)
                | Target::Infinity(_) => None,
            };
            vertex.brings *= transmittance(job, transport, ray, vertex.media, target);
        }
        None => path.throughput *= transmittance(job, transport, ray, path.media, None),
    }
}

/// Position of a punctual light.
fn point_of(job: &Job, index: u32) -> Option<DVec3> {
    Some(job.illumination.as_ref()?.lights.point(index)?.1)
}

/// Share of light that a medium leaves along a move, up to what is found or to the light that it passes.
fn transmittance<T: Transport>(
    job: &Job,
    transport: &T,
    (flight, step, found): (&T::Flight, &T::Move, Option<Found>),
    media: Media,
    target: Option<DVec3>,
) -> Vec3 {
    let attenuation =
        media.current().map_or(Vec3::ZERO, |medium| job.scene.materials[medium as usize].attenuation);
    if attenuation == Vec3::ZERO {
        return Vec3::ONE;
    }
    let Some(course) = transport.course(flight, step) else { return Vec3::ONE };
    let beside = |point: Option<DVec3>| point.map_or(1.0, |point| course.parameter_beside(point));
    let end = beside(found.map(|found| found.point)).min(beside(target));
    let (side, mut start, mut length) = (transport.side(flight), course.point(0.0), 0.0);
    let pieces = if T::IS_STRAIGHT { 1 } else { PIECES };
    for piece in 1..pieces + 1 {
        let next = course.point(end * f64::from(piece) / f64::from(pieces));
        length += job.scene.spacetime.proper_length(side, 0.5 * (start + next), next - start);
        start = next;
    }
    // Nothing is lost where nothing is absorbed, however long the way is.
    attenuation.map(|sigma| if sigma > 0.0 { libm::expf(-sigma * length as f32) } else { 1.0 })
}
