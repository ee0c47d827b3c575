//! Light sampling: a ray to a light from where a path lands, and what it brings.

use glam::{DVec3, Vec3};

use super::super::illumination::Illumination;
use super::super::path::Path;
use super::super::transport::{Found, Landing, Outcome, Transport};
use super::super::vertex::Vertex;
use super::super::work::Job;
use crate::geometry::Segment;
use crate::light::{Incoming, LightSample, Receiver, Target};
use crate::shade::{self, Incidence};

/// A ray to a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightRay {
    /// Unit direction.
    pub direction: DVec3,
    /// What it is aimed at.
    pub target: Target,
    /// What it adds to the path if it gets there.
    pub brings: Vec3,
}

/// Sets of random numbers of light sampling, beyond those of scattering.
const SETS: u32 = 1 << 16;
/// How far from a light without extent a ray may pass that was aimed at it, relative to the move.
const NEAR: f64 = 1e-3;

/// A ray from `landing` to a light; `None` if it would bring nothing.
#[inline]
pub fn propose(
    job: &Job,
    illumination: &Illumination,
    path: &Path,
    incidence: &Incidence,
    position: DVec3,
) -> Option<LightRay> {
    let material = &job.scene.materials[incidence.material as usize];
    if path.depth >= job.settings.max_depth || !material.spreads_light() {
        return None;
    }
    let numbers = job.sampler.four(path.pixel, path.sample, SETS + path.depth).map(f64::from);
    let Illumination { lights, sight, .. } = illumination;
    let receiver = Receiver { place: sight.place(position), normal: incidence.facing().0 };
    let LightSample { direction, target, light } = lights.sample(sight.as_ref(), &receiver, numbers)?;
    let (bsdf, found) = shade::evaluate(&job.scene.materials, incidence, direction)?;
    let light = match (light, target) {
        (Incoming::Radiance(radiance, density), _) => {
            // What is 0/0 where images merge is 0: the surface finds it.
            let share = illumination.share_of_sample(density, found) / density;
            (if share.is_finite() { share as f32 } else { 0.0 }) * radiance
        }
        (Incoming::Irradiance(irradiance), _) => irradiance,
    };
    let brings = path.throughput * bsdf * light;
    (brings != Vec3::ZERO && brings.is_finite()).then_some(LightRay { direction, target, brings })
}

/// Where a light ray stands after a move: flying on, or ended at its target or not.
#[inline]
pub fn settle<T: Transport>(
    illumination: &Illumination,
    transport: &T,
    (flight, step, found): (&T::Flight, &T::Move, Option<Found>),
    vertex: &Vertex,
) -> Result<T::Flight, bool> {
    let point = match vertex.target {
        Target::Point(index) => illumination.lights.point(index),
        _ => None,
    };
    if point.is_some_and(|point| passes(transport, flight, step, found, point)) {
        return Err(true);
    }
    match transport.settle(None, flight, step, found) {
        Outcome::Flying(next) => Ok(next),
        Outcome::Landed(landing) => Err(is_met(illumination, vertex.target, &landing)),
        // What a ray that leaves was aimed at without passing it lies beyond all geometry.
        Outcome::Escaped(_) => Err(matches!(vertex.target, Target::Infinity | Target::Point(_))),
        Outcome::Captured | Outcome::StepLimit | Outcome::NonFinite => Err(false),
    }
}

/// Whether a move passes `point` before it finds anything.
fn passes<T: Transport>(
    transport: &T,
    flight: &T::Flight,
    step: &T::Move,
    found: Option<Found>,
    point: DVec3,
) -> bool {
    let Some(course) = transport.course(flight, step) else { return false };
    let chord = course.chord();
    let s = course.parameter_beside(point);
    course.point(s).distance(point) <= NEAR * chord.start.distance(chord.end)
        && found.is_none_or(|found| course.parameter_beside(found.point) > s)
}

/// Whether a landing is where the ray was aimed at.
fn is_met(illumination: &Illumination, target: Target, landing: &Landing) -> bool {
    let Target::Surface(primitive, position) = target else { return false };
    landing.primitive == primitive && illumination.sight.is_there(position, landing.position)
}

/// The share that light sampling leaves of light that the last bounce found: from a surface, or at infinity in
/// `direction` if there is none.
#[inline]
pub fn share(job: &Job, vertex: &Vertex, direction: DVec3, surface: Option<(&Landing, DVec3)>) -> f32 {
    let Some(illumination) = job.illumination.as_ref().filter(|_| vertex.density > 0.0) else { return 1.0 };
    let Illumination { lights, sight, .. } = illumination;
    let receiver = Receiver { place: sight.place(vertex.position), normal: vertex.normal };
    let density = match surface {
        Some((landing, normal)) => {
            let place = (landing.primitive, landing.position, normal, direction);
            lights.surface_density(sight.as_ref(), &receiver, vertex.direction, place)
        }
        None => lights.sky_density(sight.as_ref(), &receiver, vertex.direction, direction),
    };
    illumination.share_of_find(density, vertex.density) as f32
}
