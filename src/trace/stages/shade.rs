//! Shading of landings: surfaces are looked up, recorded, gathered from, and scattered at.

use glam::{DVec3, Vec3};

use super::super::illumination::GuidedSampling;
use super::super::job::Job;
use super::super::path::{Gathers, Path};
use super::super::ray_cone::RayCone;
use super::super::samples::Samples;
use super::super::transport::Landing;
use super::super::vertex::Vertex;
use super::deposit::{LightSource, deposit};
use super::draw::{Draws, Numbers};
use super::emit::emit;
use super::light;
use super::look_up::look_up;
use super::meet::{Meeting, meet_surface};
use super::record::record_hit;
use super::scatter::take;
use crate::geometry::{SurfacePoint, SurfacesMet};
use crate::light::{LightQuery, LightSample, Receiver, Target};
use crate::shade::{Bounce, Footprint, Material, Response, SortedHits};

/// Takes a path through the surface it landed on: the unit direction of its next ray, which is a light ray or its
/// continuation, as `vertex` says; `None` if it ends here.
#[inline]
pub fn shade(
    job: &Job,
    path: &mut Path,
    (vertex, cone): (&mut Vertex, &mut RayCone),
    landing: &Landing,
    numbers: &Numbers,
    samples: &mut Samples,
) -> Option<DVec3> {
    let mut varied = None;
    let surface = job.scene.geometry.surface_point(landing.primitive, landing.position);
    let at = (landing, surface, None);
    let (arrival, material) = arrive(job, path, (vertex, cone), at, (samples, &mut varied))?;
    let (lobe, incidence) = (&material.lobe, arrival.meeting.incidence(landing.direction));
    let query = light_query(job, path, material, landing, &arrival, numbers);
    let light = job.illumination.as_ref().zip(query);
    let light = light.and_then(|(illumination, query)| illumination.sample(&query.receiver, query.numbers));
    let response = match &light {
        Some(light) => lobe.evaluate(&incidence, light.direction),
        None => Response::default(),
    };
    let scattered = (&lobe.sample(&incidence, numbers.ray), &response);
    leave(job, path, (vertex, cone), (landing, &arrival, light.as_ref()), scattered, numbers)
}

/// Landings that are shaded side by side at most: all that is known of them stays in the first-level cache.
const AT_ONCE: usize = 64;

/// Shading of many landings.
#[derive(Default)]
pub struct Shading {
    met: SurfacesMet,
    /// Of cones where their rays land, if rays are bent.
    widths: Vec<f64>,
    /// Those that are scattered at, with their places among all, and those of their queries for light.
    arrivals: Vec<(usize, ScatterPoint, Option<usize>)>,
    queries: Vec<LightQuery>,
    sampling: GuidedSampling,
    lights: Vec<Option<LightSample>>,
    hits: SortedHits,
}

impl Shading {
    /// Shades landings of `paths` by lane as [`shade`] does, lobes side by side: calls `end` with the place of each among
    /// them, its path's vertex, and the direction of the next ray. Without light sampling there are no `vertices`, without
    /// filtered textures no `cones`.
    pub fn shade_all(
        &mut self,
        job: &Job,
        landed: &[(usize, Landing)],
        (paths, vertices, cones): (&mut [Path], &mut [Vertex], &mut [RayCone]),
        draws: &Draws,
        samples: &mut Samples,
        mut end: impl FnMut(usize, &Vertex, Option<DVec3>),
    ) {
        let Self { met, widths, arrivals, queries, sampling, lights, hits: scattering } = self;
        let geometry = &job.scene.geometry;
        let (mut free, mut point, mut varied) = (Vertex::default(), RayCone::default(), None);
        for first in (0..landed.len()).step_by(AT_ONCE) {
            arrivals.clear();
            queries.clear();
            let part = landed.iter().enumerate().skip(first).take(AT_ONCE);
            let hits = part.clone().map(|(_, (_, landing))| (landing.primitive, landing.position));
            geometry.surface_points(hits, met);
            if let Some(of_scene) = &job.cones {
                let landed = part.clone().map(|(_, (lane, landing))| (&cones[*lane], landing));
                of_scene.bent_widths(landed, widths);
            }
            for (number, (place, (lane, landing))) in part.enumerate() {
                let numbers = draws.vertex(place);
                let (path, vertex) = (&mut paths[*lane], vertices.get(*lane).unwrap_or(&free));
                let cone = cones.get(*lane).unwrap_or(&point);
                let surface = match met.get(number) {
                    Some(surface) => surface,
                    None => geometry.surface_point(landing.primitive, landing.position),
                };
                let at = (landing, surface, widths.get(number).copied());
                match arrive(job, path, (vertex, cone), at, (samples, &mut varied)) {
                    Some((arrival, material)) => {
                        scattering.push(
                            &material.lobe,
                            &arrival.meeting.incidence(landing.direction),
                            numbers.ray,
                        );
                        let query = light_query(job, path, material, landing, &arrival, &numbers);
                        arrivals.push((place, arrival, query.is_some().then_some(queries.len())));
                        queries.extend(query);
                    }
                    None => end(place, vertex, None),
                }
            }
            if let Some(illumination) = &job.illumination {
                illumination.sample_all(queries, sampling, lights);
            }
            let light_of = |query: Option<usize>| lights[query?].as_ref();
            let out =
                |number: usize| light_of(arrivals[number].2).map_or(DVec3::ZERO, |light| light.direction);
            scattering.scatter(out, |number, bounce, response| {
                let (place, arrival, query) = &arrivals[number];
                let ((lane, landing), numbers) = (&landed[*place], draws.vertex(*place));
                let (path, vertex) = (&mut paths[*lane], vertices.get_mut(*lane).unwrap_or(&mut free));
                let cone = cones.get_mut(*lane).unwrap_or(&mut point);
                let at = (landing, arrival, light_of(*query));
                let direction = leave(job, path, (vertex, cone), at, (bounce, response), &numbers);
                end(*place, vertex, direction);
            });
        }
    }
}

/// Landing that is scattered at.
struct ScatterPoint {
    /// Surface that is met.
    meeting: Meeting,
    /// Width of the ray's cone there; 0 if no texture can be filtered.
    width: f64,
    /// True if its material is a mirror or glass.
    is_specular: bool,
    /// True if light from beyond the surface gets through it.
    both_sides: bool,
    /// Share of light that comes head-on for which light that grazes it counts.
    grazing: f32,
}

/// Looks up and records the surface that a path landed on with its material, which is `varied` where textures vary it, and
/// gathers what it emits; `None` if the path ends here. With the surface comes the width of the path's cone, if it is known.
#[inline(always)]
fn arrive<'a>(
    job: &Job<'a>,
    path: &mut Path,
    (vertex, cone): (&Vertex, &RayCone),
    (landing, surface, width): (&Landing, SurfacePoint, Option<f64>),
    (samples, varied): (&mut Samples, &'a mut Option<Material>),
) -> Option<(ScatterPoint, &'a Material)> {
    let base = &job.scene.materials[surface.surface.material as usize];
    if path.gathers == Gathers::Lamps && base.shows_no_lamps() {
        return None;
    }
    let mut meeting = meet_surface(job.scene, landing, path.media, surface);
    let width = width.or_else(|| Some(job.cones.as_ref()?.width(cone, landing))).unwrap_or(0.0);
    if job.has_maps {
        let footprint = match job.cones {
            Some(_) => cone.footprint(width, landing.direction.dot(meeting.surface.normal)),
            None => Footprint::default(),
        };
        look_up(job.scene, landing, footprint, &mut meeting, varied);
    }
    let material = varied.as_ref().unwrap_or(meeting.material(job.scene));
    record_hit(path, landing, &meeting, material, samples);
    emit(job, &meeting, material, landing, vertex, path);
    let is_specular = material.is_specular();
    match path.gathers {
        Gathers::Lamps if !is_specular => return None,
        Gathers::Beyond if !is_specular => path.gathers = Gathers::All,
        _ => {}
    }
    let (both_sides, grazing) = (material.lobe.transmits(), meeting.lean().max(material.lobe.gloss()));
    Some((ScatterPoint { meeting, width, is_specular, both_sides, grazing }, material))
}

/// Query for light that may come to where a path arrived.
#[inline(always)]
fn light_query(
    job: &Job,
    path: &Path,
    material: &Material,
    landing: &Landing,
    arrival: &ScatterPoint,
    numbers: &Numbers,
) -> Option<LightQuery> {
    let illumination = job.illumination.as_ref()?;
    let &ScatterPoint { ref meeting, both_sides, grazing, .. } = arrival;
    let normal = meeting.incidence(landing.direction).normal;
    let receiver =
        Receiver { position: landing.position, normal, grazing, both_sides, on: meeting.primitive };
    light::query(job, illumination, path, material, &receiver, numbers.light)
}

/// Takes a path on from where it scatters, as its lobe samples and responds: the unit direction of its next ray; `None`
/// if it ends.
#[inline(always)]
fn leave(
    job: &Job,
    path: &mut Path,
    (vertex, cone): (&mut Vertex, &mut RayCone),
    (landing, arrival, light): (&Landing, &ScatterPoint, Option<&LightSample>),
    (bounce, response): (&Bounce, &Response),
    numbers: &Numbers,
) -> Option<DVec3> {
    let &ScatterPoint { ref meeting, width, is_specular, both_sides, grazing } = arrival;
    if let Some(cones) = &job.cones {
        let eta = meeting.incidence(landing.direction).eta;
        *cone = cones.after(cone, (landing, width), (bounce, eta), job.scene);
    }
    let Some(illumination) = &job.illumination else {
        return take(job, path, meeting, bounce, numbers.ray[3]).then_some(bounce.direction);
    };
    if illumination.is_guided() && is_specular {
        vertex.after_specular = true;
        return take(job, path, meeting, bounce, numbers.ray[3]).then_some(bounce.direction);
    }
    let (depth, media, chance) = (path.depth + 1, path.media, illumination.chance(path.throughput));
    let brings = light.map_or(Vec3::ZERO, |light| light::brings(job, illumination, path, light, response));
    let light = light.filter(|_| brings != Vec3::ZERO);
    let continues = take(job, path, meeting, bounce, numbers.ray[3]);
    *vertex = Vertex {
        position: landing.position,
        normal: meeting.incidence(landing.direction).normal,
        grazing,
        both_sides,
        origin_prim: meeting.primitive,
        continues,
        direction: bounce.direction,
        density: if continues { bounce.density } else { 0.0 },
        chance,
        after_specular: false,
        light_ray_in_flight: light.is_some(),
        depth,
        media,
        target: light.map_or(Target::Nothing, |light| light.target),
        brings,
    };
    light.map(|light| light.direction).or(continues.then_some(bounce.direction))
}

/// Ends a path's light ray, at its target or not: true if the path goes on from its vertex.
#[inline]
pub fn gather(path: &mut Path, vertex: &mut Vertex, is_reached: bool) -> bool {
    if is_reached && let Some(source) = LightSource::reached(vertex) {
        deposit(path, source, || vertex.brings);
    }
    vertex.light_ray_in_flight = false;
    vertex.after_specular = false;
    vertex.continues
}
