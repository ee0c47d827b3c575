//! Photons: from the lamps through mirrors and glass to where they can be seen, for [`Guide`].

use glam::DVec3;
use rayon::prelude::*;

use super::shoot::{Ray, Shot, follow};
use super::stages::scatter::incidence;
use super::transport::{Outcome, Transport};
use crate::light::{Emitter, Guide, Lights, Photon, View};
use crate::scene::{Baked, Settings};
use crate::shade::{self, Media, Sampler};

/// Photons for each pixel of the picture, and the fewest and the most in all.
const PER_PIXEL: usize = 8;
const FEWEST: usize = 1 << 14;
const MOST: usize = 1 << 19;
/// Most mirrors and glass surfaces on the way of a photon.
const MOST_HOPS: u32 = 8;

/// Whether there are mirrors or glass for photons to go through.
pub fn is_useful(scene: &Baked) -> bool {
    scene.materials.iter().any(|material| material.is_specular())
}

/// Photons that a picture is worth.
pub fn count(settings: &Settings) -> u32 {
    (PER_PIXEL * settings.width * settings.height).clamp(FEWEST, MOST) as u32
}

/// Sends `count` photons through `scene` and learns from where they land; `None` if there is nothing to learn: no mirrors, no
/// glass, no surfaces that emit.
pub fn guide<T: Transport>(scene: &Baked, transport: &T, lights: &Lights, count: u32) -> Option<Guide> {
    let powers: Vec<f64> = lights
        .emitters()
        .iter()
        .scan(0.0, |sum, emitter| {
            *sum += emitter.emission().power;
            Some(*sum)
        })
        .collect();
    let total = *powers.last()?;
    if !is_useful(scene) || !total.is_finite() || total <= 0.0 {
        return None;
    }
    let sampler = Sampler::independent(scene.settings.seed);
    let photons: Vec<Photon> = (0..count)
        .into_par_iter()
        .filter_map(|index| {
            let numbers = |set: u32| sampler.four(u32::MAX, index, set).map(f64::from);
            let [choice, ..] = numbers(0);
            let emitter = powers.partition_point(|&below| below <= choice * total);
            let emitter = lights.emitters().get(emitter)?;
            send(scene, transport, emitter, numbers)
        })
        .collect();
    Guide::new(&photons)
}

/// One photon of `emitter`, from four numbers in [0, 1) for each of its events; `None` if it is lost.
fn send<T: Transport>(
    scene: &Baked,
    transport: &T,
    emitter: &Emitter,
    numbers: impl Fn(u32) -> [f64; 4],
) -> Option<Photon> {
    let everywhere = View { distance: 0.0, direction: DVec3::ZERO, is_exact: true };
    let [_, back, u, v] = numbers(0);
    let spot = emitter.sample(&everywhere, u, v)?;
    let flips = emitter.both_sides && !emitter.is_closed() && back < 0.5;
    let outwards = if flips { -spot.normal } else { spot.normal };
    let [u, v, ..] = numbers(1);
    let direction = shade::diffuse::sample(outwards, u, v);
    let mut ray = Ray { position: spot.position, direction, leaves: emitter.primitive };
    let (mut media, mut way) = (Media::VACUUM, Way::default());
    way.add(scene.geometry.surface(emitter.primitive).entity);
    for hop in 0..=MOST_HOPS {
        let Shot { end, .. } = follow(transport, &scene.geometry, &ray, |_, _, _, _| {});
        let Outcome::Landed(landing) = end else { return None };
        let surface = scene.geometry.surface_point(landing.primitive, landing.position);
        let incidence = incidence(&surface, landing.direction, media);
        way.add(surface.surface.entity);
        if !scene.materials[surface.surface.material as usize].is_specular() {
            return Some(Photon {
                position: landing.position,
                normal: incidence.facing().0,
                direction: -landing.direction,
                way: (hop > 0).then_some(way.0),
            });
        }
        let bounce = shade::scatter(&scene.materials, &incidence, numbers(2 + hop).map(|u| u as f32))?;
        way.add(u32::from(bounce.direction.dot(incidence.facing().0) > 0.0));
        media = bounce.media;
        ray = Ray { position: landing.position, direction: bounce.direction, leaves: landing.primitive };
    }
    None
}

/// Which way a photon came, as one number: FNV-1a over what it met.
struct Way(u64);

impl Default for Way {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Way {
    fn add(&mut self, event: u32) {
        for byte in event.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
