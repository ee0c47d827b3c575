//! Photons: from the lamps through mirrors and glass to where they can be seen, for [`Guide`].

use std::ops::Range;

use rayon::prelude::*;

use super::super::halt::Halt;
use super::super::illumination::{Illumination, has_specular};
use super::super::job::Job;
use super::super::ray_batch::RayBatch;
use super::super::stages::look_up::look_up;
use super::super::stages::meet::meet;
use super::super::stages::pass::{behind, opacity};
use super::super::transport::{Landing, Outcome, Start, Transport};
use crate::light::{Guide, Lights, Photon, View};
use crate::scene::Baked;
use crate::shade::{self, Footprint, Key, Media, Sampler};
use crate::spacetime::Side;

/// Most mirrors and glass surfaces on the way of a photon.
const MOST_HOPS: u32 = 8;
/// Set of the random numbers for the first surface that a photon may pass through: those before are for hops.
const FIRST_LOOK: u32 = 2 + MOST_HOPS;
/// Most surfaces that a photon looks at so.
const MOST_LOOKS: u32 = 64;
/// Photons that are followed together.
const TOGETHER: u32 = 1024;

/// Learns from `count` photons where light comes from through mirrors and glass; not worth anything once the job's halt
/// is due.
pub fn learn<T: Transport>(job: &Job, transport: &T, illumination: &mut Illumination, count: u32) {
    if illumination.heuristic.is_some() {
        illumination.guides = guides(job, transport, &illumination.lights, count).unwrap_or_default();
    }
}

/// Sends photons through the scene and learns from where they land, by side; `None` if there is nothing to learn: no
/// mirrors, no glass, no surfaces that emit.
fn guides<T: Transport>(job: &Job, transport: &T, lights: &Lights, count: u32) -> Option<[Option<Guide>; 2]> {
    let scene = job.scene;
    if !has_specular(scene) {
        return None;
    }
    let powers: Vec<f64> = lights
        .emitters()
        .iter()
        .scan(0.0, |sum, emitter| {
            *sum += emitter.emission().power;
            Some(*sum)
        })
        .collect();
    let total = *powers.last()?;
    if !total.is_finite() || total <= 0.0 {
        return None;
    }
    let sampler = Sampler::independent(scene.settings.seed);
    let shower =
        Shower { scene, lights, powers: &powers, sampler, has_passages: job.has_passages, halt: &job.halt };
    let photons: Vec<Photon> = (0..count.div_ceil(TOGETHER))
        .into_par_iter()
        .map_init(RayBatch::default, |batch, part| {
            let first = part * TOGETHER;
            shower.fall(transport, batch, first..count.min(first + TOGETHER))
        })
        .flatten_iter()
        .collect();
    let (near, far): (Vec<_>, Vec<_>) = photons.into_iter().partition(|photon| photon.side == Side::Near);
    Some([near, far].map(|photons| Guide::new(&photons)))
}

/// Photons of all lamps.
struct Shower<'a> {
    scene: &'a Baked,
    lights: &'a Lights,
    /// Sums of the powers of the lamps up to each.
    powers: &'a [f64],
    sampler: Sampler,
    has_passages: bool,
    halt: &'a Halt<'a>,
}

/// A photon under way.
struct Flying {
    index: u32,
    hops: u32,
    /// Surfaces so far that it might have passed through.
    looks: u32,
    media: Media,
    path: PathHash,
}

/// Fate of a photon where it lands.
enum Event<C> {
    Stays(Photon),
    Goes(Flying, Start<C>),
    IsLost,
}

impl Shower<'_> {
    /// The photons of `range` that land, in their order.
    fn fall<T: Transport>(&self, transport: &T, batch: &mut RayBatch<T>, range: Range<u32>) -> Vec<Photon> {
        let mut landed: Vec<Option<Photon>> = range.clone().map(|_| None).collect();
        let first = range.start;
        let (mut flying, mut starts): (Vec<Flying>, Vec<Start<T::Carried>>) =
            range.filter_map(|index| self.start(index)).unzip();
        let mut ends = Vec::new();
        while !starts.is_empty() {
            batch.follow(transport, &self.scene.geometry, &starts, self.halt, &mut ends);
            starts.clear();
            for (photon, end) in std::mem::take(&mut flying).into_iter().zip(&ends) {
                let (place, &(Outcome::Landed(landing), carried)) = (photon.index - first, end) else {
                    continue;
                };
                match self.land(photon, &landing, carried) {
                    Event::Stays(photon) => landed[place as usize] = Some(photon),
                    Event::Goes(photon, start) => {
                        flying.push(photon);
                        starts.push(start);
                    }
                    Event::IsLost => {}
                }
            }
        }
        landed.into_iter().flatten().collect()
    }

    /// Four numbers in [0, 1) for an event of a photon.
    fn numbers(&self, index: u32, set: u32) -> [f32; 4] {
        self.sampler.point(Key { pixel: u32::MAX, sample: index, set })
    }

    fn start<C: Default>(&self, index: u32) -> Option<(Flying, Start<C>)> {
        let [choice, back, u, v] = self.numbers(index, 0).map(f64::from);
        let total = *self.powers.last()?;
        let emitter = self.powers.partition_point(|&below| below <= choice * total);
        let emitter = self.lights.emitters().get(emitter)?;
        let spot = emitter.sample(&View::Everywhere, u, v)?;
        let flips = emitter.both_sides && emitter.sphere().is_none() && back < 0.5;
        let outwards = if flips { -spot.normal } else { spot.normal };
        let [u, v, ..] = self.numbers(index, 1).map(f64::from);
        let direction = shade::sample_cosine(outwards, u, v);
        let mut path = PathHash::default();
        path.add(self.scene.geometry.surface(emitter.primitive).entity);
        let photon = Flying { index, hops: 0, looks: 0, media: Media::VACUUM, path };
        let (position, origin_prim) = (spot.position, emitter.primitive);
        Some((photon, Start { position, direction, origin_prim, carried: C::default() }))
    }

    fn land<C>(&self, photon: Flying, landing: &Landing, carried: C) -> Event<C> {
        let Flying { index, hops, looks, media, mut path } = photon;
        let opacity = if self.has_passages { opacity(self.scene, landing) } else { 1.0 };
        if opacity < 1.0 && looks < MOST_LOOKS {
            let [number, ..] = self.numbers(index, FIRST_LOOK + looks);
            if number >= opacity {
                return Event::Goes(
                    Flying { index, hops, looks: looks + 1, media, path },
                    behind(landing, carried),
                );
            }
        }
        let mut meeting = meet(self.scene, landing, media);
        let mut varied = None;
        look_up(self.scene, landing, Footprint::default(), &mut meeting, &mut varied);
        let material = varied.as_ref().unwrap_or(meeting.material(self.scene));
        let incidence = meeting.incidence(landing.direction);
        path.add(meeting.surface.surface.entity);
        if !material.is_specular() {
            return Event::Stays(Photon {
                side: landing.primitive.side(),
                position: landing.position,
                normal: incidence.normal,
                direction: -landing.direction,
                way: (hops > 0).then_some(path.0),
            });
        }
        if hops >= MOST_HOPS {
            return Event::IsLost;
        }
        let bounce = material.lobe.sample(&incidence, self.numbers(index, 2 + hops));
        path.add(u32::from(bounce.direction.dot(incidence.normal) > 0.0));
        let &Landing { position, primitive: origin_prim, .. } = landing;
        Event::Goes(
            Flying {
                index,
                hops: hops + 1,
                looks: looks + 1,
                media: meeting.media_after(&bounce, media),
                path,
            },
            Start { position, direction: bounce.direction, origin_prim, carried },
        )
    }
}

/// Hash of the path that a photon took: FNV-1a over what it met.
struct PathHash(u64);

impl Default for PathHash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl PathHash {
    fn add(&mut self, event: u32) {
        for byte in event.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
