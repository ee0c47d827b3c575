//! The per-pixel schedule: one path after the other, from the camera to its end.

use super::job::Job;
use super::path::{Gathers, Path};
use super::ray_cone::RayCone;
use super::ray_end::RayEnd;
use super::samples::Samples;
use super::stages::absorb::absorb;
use super::stages::draw::Numbers;
use super::stages::escape::escape;
use super::stages::generate::generate;
use super::stages::intersect::intersect;
use super::stages::light::{self, LightRayProgress};
use super::stages::pass::{behind, passes};
use super::stages::record::{record_beside, record_end, record_entrance, record_halo, record_step};
use super::stages::shade::{gather, shade};
use super::stats::{Counters, Fates};
use super::transport::{Landing, Outcome, Start, Transport};
use super::vertex::Vertex;
use super::work::Work;
use crate::geometry::PrimitiveId;

/// Steps between two looks at the clock.
const PATIENCE: u64 = 64;

/// Traces all paths of `work` into `samples`; `None`, and the samples are worth nothing, if it had to give up.
pub fn trace<T: Transport>(
    job: &Job,
    transport: &T,
    work: &Work,
    samples: &mut Samples,
    counters: &mut Counters,
) -> Option<()> {
    (0..work.paths()).try_for_each(|index| trace_path(job, transport, work, index, samples, counters))
}

fn trace_path<T: Transport>(
    job: &Job,
    transport: &T,
    work: &Work,
    index: u32,
    samples: &mut Samples,
    counters: &mut Counters,
) -> Option<()> {
    let geometry = &job.scene.geometry;
    let (mut path, ray) = generate(job, work, index);
    let Some((position, direction)) = ray else {
        record_beside(&path, samples);
        return Some(());
    };
    let mut carried = T::Carried::default();
    let origin_prim = PrimitiveId::none_on(job.scene.camera.side);
    let start = Start { position, direction, origin_prim, carried };
    let mut vertex = Vertex::default();
    let mut cone = match &job.cones {
        Some(cones) => cones.of_camera(job.scene, path.sample, (position, direction)),
        None => RayCone::default(),
    };
    counters.paths += u64::from(path.gathers != Gathers::Lamps);
    counters.rays += 1;
    let mut flight = match transport.enter(&start) {
        Outcome::Flying(flight) => flight,
        lost => {
            lose(job, (&mut path, &vertex), lost, samples, &mut counters.fates);
            samples.radiance[path.slot as usize] = path.radiance;
            return Some(());
        }
    };
    record_entrance(&path, || transport.length_before(&start, &flight), samples);
    loop {
        let step = transport.advance(&flight);
        let found = intersect(transport, geometry, &flight, &step, counters);
        if counters.steps.is_multiple_of(PATIENCE) && job.halt.is_due() {
            return None;
        }
        record_step(
            &path,
            vertex.light_ray_in_flight,
            || transport.length(&flight, &step, found.map(|f| f.point)),
            samples,
        );
        record_halo(job, transport, (&flight, &step, found), &path, samples);
        if job.absorbs {
            absorb(job, transport, (&flight, &step, found), &mut path, Some(&mut vertex));
        }
        let illumination = job.illumination.as_ref().filter(|_| vertex.light_ray_in_flight);
        if let Some(illumination) = illumination {
            let (progress, arrived) =
                light::settle(job, illumination, transport, (&flight, &step, found), &mut path, &vertex);
            let is_reached = match progress {
                LightRayProgress::Flying(next) => {
                    flight = next;
                    continue;
                }
                LightRayProgress::Passes(landing) => {
                    flight = transport.launch(&behind(&landing, arrived));
                    continue;
                }
                LightRayProgress::Landed(landing) => {
                    if let Some(direction) = light::land(job, &mut path, &mut vertex, &landing) {
                        let Landing { position, primitive: origin_prim, .. } = landing;
                        flight =
                            transport.launch(&Start { position, direction, origin_prim, carried: arrived });
                        continue;
                    }
                    false
                }
                LightRayProgress::Escaped(there) => {
                    light::escape(job, &mut path, &vertex, there);
                    false
                }
                LightRayProgress::Ended(is_reached) => is_reached,
            };
            if !gather(&mut path, &mut vertex, is_reached) {
                break;
            }
            let Vertex { position, direction, origin_prim, .. } = vertex;
            flight = transport.launch(&Start { position, direction, origin_prim, carried });
            counters.rays += 1;
            continue;
        }
        let exactly = job.lands_exactly(samples.needs()).then_some(geometry);
        let (outcome, arrived) = transport.settle(exactly, &flight, &step, found);
        match outcome {
            Outcome::Flying(next) => flight = next,
            Outcome::Landed(landing) if passes(job, &mut path, &landing) => {
                flight = transport.launch(&behind(&landing, arrived));
            }
            Outcome::Landed(landing) => {
                counters.fates.hit += 1;
                let numbers = Numbers::draw(job, &path);
                let next = shade(job, &mut path, (&mut vertex, &mut cone), &landing, &numbers, samples);
                let Some(direction) = next else { break };
                carried = arrived;
                let Landing { position, primitive: origin_prim, .. } = landing;
                flight = transport.launch(&Start { position, direction, origin_prim, carried });
                counters.count_ray(vertex.light_ray_in_flight);
            }
            lost => {
                lose(job, (&mut path, &vertex), lost, samples, &mut counters.fates);
                break;
            }
        }
    }
    samples.radiance[path.slot as usize] = path.radiance;
    Some(())
}

/// Ends a path whose ray met nothing.
fn lose<F>(
    job: &Job,
    (path, vertex): (&mut Path, &Vertex),
    outcome: Outcome<F>,
    samples: &mut Samples,
    fates: &mut Fates,
) {
    let Ok(end) = outcome.end() else { return };
    let (fate, mut side) = (RayEnd::of(&end), None);
    if let Outcome::Escaped(there) = end {
        escape(job, path, vertex, there);
        side = Some(there.side);
    }
    fates.count(fate);
    record_end(job, path, fate, side, samples);
}
