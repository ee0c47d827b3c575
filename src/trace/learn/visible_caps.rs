//! Caps of spherical lamps that can be seen.
//!
//! A lamp often sticks out of a wall: a room may be lit by the tip of a sphere whose rest lies behind the ceiling. Rays
//! aimed at the rest are wasted. Paths from the camera tell which part is met at all; light samples are then limited to
//! a cap around it. Light from beyond the cap is still found by BSDF sampling.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::super::edge_pixels::EdgePixels;
use super::super::illumination::Illumination;
use super::super::job::Job;
use super::super::shoot::{Shot, follow};
use super::super::stages::draw::Numbers;
use super::super::stages::generate::generate;
use super::super::stages::look_up::look_up;
use super::super::stages::meet::meet;
use super::super::stages::scatter::scatter;
use super::super::transport::{Landing, Outcome, Start, Transport};
use super::super::work::{Lattice, Share, Work};
use crate::geometry::PrimitiveId;
use crate::light::Cap;
use crate::shade::Footprint;

/// Fewest meetings that tell which part of a lamp is visible: so many places on a disk reach to 0.9 of its radius.
const FEWEST: usize = 6;
/// Probability with which chance finds a lamp, about: some see a lamp from behind the wall it sticks in, and need not be held.
const CHANCE: f64 = 0.03;
/// Rounds in which the middle of a cap is found.
const ROUNDS: usize = 3;
/// Room around the part that is met, relative to its angle, times the root of the number of meetings.
const MARGIN: f64 = 0.4;
/// Angle of a cap, radians, from which on the whole lamp may as well be sampled.
const WIDEST: f64 = 1.0;

/// Limits light samples to the visible parts of spherical lamps, as so many paths from the camera find them; not worth
/// anything once the job's halt is due.
pub fn learn<T: Transport>(job: &Job, transport: &T, illumination: &mut Illumination, paths: usize) {
    let lights = &mut illumination.lights;
    if illumination.heuristic.is_none() || !lights.emitters().iter().any(|emitter| emitter.sphere().is_some())
    {
        return;
    }
    let settings = job.settings;
    let size = (settings.width, settings.height);
    let pixels = size.0 * size.1;
    let none = EdgePixels::default();
    let share = Share::Whole(&none);
    let work = Work { origin: (0, 0), size, lattice: Lattice::ALL, first_sample: 0, samples: 1, share };
    let stride = pixels.div_ceil(paths);
    let met: Vec<Vec<(PrimitiveId, DVec3)>> = (0..pixels)
        .into_par_iter()
        .step_by(stride)
        .map(|pixel| lamps_met(job, transport, &work, pixel as u32))
        .collect();
    let mut normals: HashMap<PrimitiveId, Vec<DVec3>> = HashMap::new();
    for (primitive, normal) in met.into_iter().flatten() {
        normals.entry(primitive).or_default().push(normal);
    }
    lights.limit(|emitter| normals.get(&emitter.primitive).and_then(|normals| cap(normals)));
}

/// Spherical lamps that the path of a pixel meets, with the normals there.
fn lamps_met<T: Transport>(job: &Job, transport: &T, work: &Work, pixel: u32) -> Vec<(PrimitiveId, DVec3)> {
    let scene = job.scene;
    let (mut path, ray) = generate(job, work, pixel);
    let Some((position, direction)) = ray else { return Vec::new() };
    let origin_prim = PrimitiveId::none_on(scene.camera.side);
    let mut start = Start { position, direction, origin_prim, carried: T::Carried::default() };
    let mut met = Vec::new();
    loop {
        if job.halt.is_due() {
            return met;
        }
        let (Shot { end, .. }, carried) =
            follow(transport, &scene.geometry, &start, &job.halt, |_, _, _, _| {});
        let Outcome::Landed(landing) = end else { return met };
        let mut meeting = meet(scene, &landing, path.media);
        let mut varied = None;
        look_up(scene, &landing, Footprint::default(), &mut meeting, &mut varied);
        let material = varied.as_ref().unwrap_or(meeting.material(scene));
        if material.emits() {
            met.push((meeting.primitive, meeting.surface.normal));
        }
        let Numbers { ray: numbers, .. } = Numbers::draw(job, &path);
        let Some(bounce) = scatter(job, &mut path, (&meeting, material), landing.direction, numbers) else {
            return met;
        };
        let Landing { position, primitive: origin_prim, .. } = landing;
        start = Start { position, direction: bounce.direction, origin_prim, carried };
    }
}

/// A cap around most of `normals`; `None` if they are too few or too far apart.
fn cap(normals: &[DVec3]) -> Option<Cap> {
    if normals.len() < FEWEST {
        return None;
    }
    let (mut axis, mut widest) = (middle(normals.iter().copied())?, 0.0);
    for _ in 0..ROUNDS {
        let mut by_angle: Vec<(f64, DVec3)> =
            normals.iter().map(|normal| (angle(axis, *normal), *normal)).collect();
        by_angle.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let inner = &by_angle[..worth(&by_angle)];
        widest = inner.last()?.0;
        axis = middle(inner.iter().map(|(_, normal)| *normal))?;
    }
    let widest = widest * (1.0 + MARGIN / (normals.len() as f64).sqrt());
    (0.0 < widest && widest < WIDEST).then(|| Cap::new(axis, widest))
}

/// How many of the places that are met, in order of their angles from the middle of a cap, it had better hold: what it holds
/// in vain, relative to a disk on which half of them lie within the angle of the median, costs as much noise as what is
/// left to chance.
fn worth(by_angle: &[(f64, DVec3)]) -> usize {
    let count = by_angle.len();
    let median = by_angle[count / 2].0.max(f64::MIN_POSITIVE);
    let noise = |held: usize| {
        let angle = by_angle[held - 1].0 / median;
        0.5 * angle * angle + (count - held) as f64 / (count as f64 * CHANCE)
    };
    (count / 2 + 1..=count).min_by(|a, b| noise(*a).total_cmp(&noise(*b))).unwrap_or(count)
}

/// Mean direction.
fn middle(normals: impl Iterator<Item = DVec3>) -> Option<DVec3> {
    normals.sum::<DVec3>().try_normalize()
}

/// Angle between unit vectors: accurate for the smallest of caps, as acos is not.
fn angle(axis: DVec3, normal: DVec3) -> f64 {
    libm::atan2(axis.cross(normal).length(), axis.dot(normal))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_seen_from_behind_its_wall_does_not_widen_a_cap() {
        // Places evenly over a disk, in a spiral, and one of ten on a ring around it.
        let place = |radius: f64, turn: f64| {
            let (sin, cos) = libm::sincos(turn);
            DVec3::new(radius * cos, 1.0, radius * sin).normalize()
        };
        for count in [20, 60, 400] {
            let disk = (0..count).map(|i| {
                let i = f64::from(i);
                place(0.03 * ((i + 0.5) / f64::from(count)).sqrt(), 2.4 * i)
            });
            let ring = (0..count / 10).map(|i| place(0.1, f64::from(i)));
            let cap = cap(&disk.chain(ring).collect::<Vec<_>>()).unwrap();
            for turn in 0..8 {
                assert!(cap.holds(place(0.026, f64::from(turn))), "{count}");
                assert!(!cap.holds(place(0.036, f64::from(turn))), "{count}");
            }
        }
    }

    #[test]
    fn a_cap_holds_most_of_what_was_met_and_little_more() {
        let normal = |angle: f64| DVec3::new(angle.sin(), angle.cos(), 0.0);
        let mut met: Vec<DVec3> = (0..40).map(|i| normal(1e-4 * f64::from(i - 20))).collect();
        let near = cap(&met).unwrap();
        assert!(met.iter().all(|normal| near.holds(*normal)));
        met.push(normal(0.5));
        let cap = cap(&met).unwrap();
        assert!(met[1..40].iter().all(|normal| cap.holds(*normal)));
        assert!(!cap.holds(normal(3e-3)));
        assert_eq!(super::cap(&met[..FEWEST - 1]), None);
        let all_around: Vec<DVec3> = (0..40).map(|i| normal(0.157 * f64::from(i))).collect();
        assert_eq!(super::cap(&all_around), None);
    }
}
