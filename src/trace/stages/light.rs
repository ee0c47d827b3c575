//! Next-event estimation: a ray to a light from where a path lands, and its contribution.

use glam::{DVec3, Vec3};

use super::super::illumination::{Illumination, LightEnd};
use super::super::job::Job;
use super::super::path::Path;
use super::super::transport::{Landing, Outcome, Transport};
use super::super::vertex::Vertex;
use super::deposit::{EmitterId, LightSource, deposit};
use super::draw::Draw;
use super::look_up::look_up;
use super::meet::meet;
use super::pass::passes as passes_through;
use crate::geometry::{Found, Segment, Sought};
use crate::light::{Incoming, LightQuery, LightSample, Receiver, Target};
use crate::shade::{Footprint, Material, Response};
use crate::spacetime::AtInfinity;

/// Largest distance at which a ray aimed at a punctual light may pass it, relative to the move.
const NEAR: f64 = 1e-3;

/// Query for light that may come to where a path lands, from two numbers in [0, 1); `None` if no light ray is sent out.
#[inline(always)]
pub fn query(
    job: &Job,
    illumination: &Illumination,
    path: &Path,
    material: &Material,
    receiver: &Receiver,
    [u, v]: [f64; 2],
) -> Option<LightQuery> {
    if path.depth >= job.settings.max_depth || !material.spreads_light() {
        return None;
    }
    let chance = illumination.chance(path.throughput);
    (u < chance).then(|| LightQuery { receiver: *receiver, numbers: [u / chance, v] })
}

/// Contribution of that light, from how the surface responds to it; zero if no ray is worth it.
#[inline]
pub fn brings(
    job: &Job,
    illumination: &Illumination,
    path: &Path,
    light: &LightSample,
    &Response { bsdf, density: found }: &Response,
) -> Vec3 {
    if found == 0.0 {
        return Vec3::ZERO;
    }
    let chance = illumination.chance(path.throughput);
    // On caustics (merging images) weight and density are both 0; BSDF sampling covers it.
    let shared = |radiance: Vec3, density: f64| {
        let density = chance * density;
        let share = illumination.share_of_sample(density, found) / density;
        (if share.is_finite() { share as f32 } else { 0.0 }) * radiance
    };
    let incoming = match light.light {
        Incoming::Radiance(radiance, density) => shared(radiance, density),
        Incoming::Sky(there, density) => {
            shared(job.scene.environment(there.side).radiance(there.direction), density)
        }
        Incoming::Seen(density) => shared(Vec3::ONE, density),
        Incoming::Irradiance(irradiance) => irradiance / chance as f32,
    };
    let brings = path.throughput * bsdf * incoming;
    if brings.is_finite() { brings } else { Vec3::ZERO }
}

/// State of a light ray after a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightRayProgress<Flight> {
    /// It flies on.
    Flying(Flight),
    /// It passes through the surface that it landed on.
    Passes(Landing),
    /// It ended: at its target or not.
    Ended(bool),
    /// One that is aimed through mirrors and glass, or at a textured lamp, landed.
    Landed(Landing),
    /// One so aimed, or at a part of the sky, left to infinity.
    Escaped(AtInfinity),
}

/// Progress of a light ray after a move, and its payload there.
#[inline]
pub fn settle<T: Transport>(
    job: &Job,
    illumination: &Illumination,
    transport: &T,
    (flight, step, found): (&T::Flight, &T::Move, Option<Found>),
    path: &mut Path,
    vertex: &Vertex,
) -> (LightRayProgress<T::Flight>, T::Carried) {
    if passes_its_light(illumination, transport, (flight, step, found), vertex) {
        return (LightRayProgress::Ended(true), T::Carried::default());
    }
    let geometry = lands_exactly(job, vertex).then_some(&job.scene.geometry);
    let (outcome, carried) = transport.settle(geometry, flight, step, found);
    (conclude(job, illumination, path, vertex, outcome), carried)
}

/// True if the exact landing of a light ray matters: if it goes on from there.
#[inline]
pub fn lands_exactly(job: &Job, vertex: &Vertex) -> bool {
    job.has_passages || vertex.target == Target::ThroughSpecular
}

/// What tells whether a straight light ray brings its light.
#[inline]
pub fn sought(job: &Job, vertex: &Vertex) -> Sought {
    let point = |index| Some(job.illumination.as_ref()?.lights.point(index)?.1);
    match vertex.target {
        _ if job.has_passages => Sought::First,
        Target::Surface(primitive, _) => Sought::Primitive(primitive),
        Target::Point(index) => point(index).map_or(Sought::First, Sought::Point),
        Target::Infinity(_) | Target::SkyTile(..) => Sought::Nothing,
        Target::Nothing | Target::ThroughSpecular => Sought::First,
    }
}

/// True if a light ray passes the punctual light that it is aimed at.
#[inline]
pub fn passes_its_light<T: Transport>(
    illumination: &Illumination,
    transport: &T,
    (flight, step, found): (&T::Flight, &T::Move, Option<Found>),
    vertex: &Vertex,
) -> bool {
    let Target::Point(index) = vertex.target else { return false };
    let light = illumination.lights.point(index);
    light.is_some_and(|(side, point)| {
        side == transport.side(flight) && passes(transport, flight, step, found, point)
    })
}

/// Progress of a light ray, from the outcome of its move.
#[inline]
pub fn conclude<Flight>(
    job: &Job,
    illumination: &Illumination,
    path: &mut Path,
    vertex: &Vertex,
    outcome: Outcome<Flight>,
) -> LightRayProgress<Flight> {
    let after_specular = vertex.target == Target::ThroughSpecular;
    match outcome {
        Outcome::Flying(next) => LightRayProgress::Flying(next),
        Outcome::Landed(landing) if passes_through(job, path, &landing) => LightRayProgress::Passes(landing),
        Outcome::Landed(landing) if after_specular => LightRayProgress::Landed(landing),
        Outcome::Escaped(there) if after_specular || matches!(vertex.target, Target::SkyTile(..)) => {
            LightRayProgress::Escaped(there)
        }
        Outcome::Landed(landing) => match illumination.reaches(vertex.target, &landing) {
            true if illumination.lights.varies(landing.primitive) => LightRayProgress::Landed(landing),
            is_reached => LightRayProgress::Ended(is_reached),
        },
        // What a ray that leaves was aimed at without passing it lies beyond all geometry.
        Outcome::Escaped(there) => LightRayProgress::Ended(match vertex.target {
            Target::Infinity(side) => side == there.side,
            Target::Point(index) => {
                illumination.lights.point(index).is_some_and(|(side, _)| side == there.side)
            }
            Target::Nothing | Target::Surface(..) | Target::ThroughSpecular | Target::SkyTile(..) => false,
        }),
        Outcome::Captured | Outcome::StepLimit | Outcome::NonFinite => LightRayProgress::Ended(false),
    }
}

/// Adds what a light ray sees where it landed, and takes one that is aimed through mirrors and glass through them: the
/// unit direction in which it goes on, or `None` if it ends.
#[inline]
pub fn land(job: &Job, path: &mut Path, vertex: &mut Vertex, landing: &Landing) -> Option<DVec3> {
    if vertex.target == Target::ThroughSpecular {
        return through_specular(job, path, vertex, landing);
    }
    if let Some(source) = LightSource::reached(vertex) {
        let mut meeting = meet(job.scene, landing, vertex.media);
        let mut varied = None;
        look_up(job.scene, landing, Footprint::default(), &mut meeting, &mut varied);
        let material = varied.as_ref().unwrap_or(meeting.material(job.scene));
        deposit(path, source, || vertex.brings * material.emission);
    }
    None
}

/// Takes a light ray through a mirror or glass, and adds what emits behind the first of them.
fn through_specular(job: &Job, path: &mut Path, vertex: &mut Vertex, landing: &Landing) -> Option<DVec3> {
    let mut meeting = meet(job.scene, landing, vertex.media);
    let mut varied = None;
    look_up(job.scene, landing, Footprint::default(), &mut meeting, &mut varied);
    let material = varied.as_ref().unwrap_or(meeting.material(job.scene));
    let front = landing.direction.dot(meeting.surface.normal) < 0.0;
    if vertex.after_specular && (front || material.emits_both_sides) {
        let source = LightSource { emitter: EmitterId::Surface(meeting.primitive), segments: vertex.depth };
        deposit(path, source, || vertex.brings * material.emission);
    }
    if !material.is_specular() || vertex.depth >= job.settings.max_depth {
        return None;
    }
    let numbers = job.sampler.point(Draw::Bend.key(path, vertex.depth));
    let bounce = material.lobe.sample(&meeting.incidence(landing.direction), numbers);
    vertex.brings *= bounce.weight;
    vertex.media = meeting.media_after(&bounce, vertex.media);
    vertex.depth += 1;
    vertex.after_specular = true;
    (vertex.brings != Vec3::ZERO).then_some(bounce.direction)
}

/// Adds what a light ray sees at infinity that went through mirrors and glass, or that was aimed there.
#[inline]
pub fn escape(job: &Job, path: &mut Path, vertex: &Vertex, there: AtInfinity) {
    let environment = job.scene.environment(there.side);
    let is_wanted = match vertex.target {
        Target::SkyTile(side, tile) => {
            let illumination = job.illumination.as_ref().filter(|_| side == there.side);
            illumination.is_some_and(|illumination| illumination.lights.is_in_tile(there, tile))
        }
        Target::Nothing
        | Target::Surface(..)
        | Target::ThroughSpecular
        | Target::Infinity(_)
        | Target::Point(_) => vertex.after_specular,
    };
    if is_wanted && !environment.is_black() {
        let source = LightSource { emitter: EmitterId::Infinity, segments: vertex.depth };
        deposit(path, source, || vertex.brings * environment.radiance(there.direction));
    }
}

/// True if a move passes `point` before it finds anything.
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
    course.point(s).distance(point) <= NEAR * chord.start.distance(chord.end) + transport.course_error()
        && found.is_none_or(|found| course.parameter_beside(found.point) > s)
}

/// The share that light sampling leaves of light that the last bounce found.
#[inline]
pub fn share(job: &Job, vertex: &Vertex, end: LightEnd) -> f32 {
    let Some(illumination) = job.illumination.as_ref().filter(|_| vertex.density > 0.0) else { return 1.0 };
    let density = vertex.chance * illumination.density(vertex, end);
    illumination.share_of_find(density, vertex.density) as f32
}
