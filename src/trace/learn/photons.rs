//! Photons: from the lamps through mirrors and glass to where they can be seen, for [`Guide`].

use std::f64::consts::PI;
use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::super::halt::Halt;
use super::super::illumination::{Illumination, has_specular};
use super::super::job::Job;
use super::super::ray_batch::RayBatch;
use super::super::stages::look_up::look_up;
use super::super::stages::meet::meet;
use super::super::stages::pass::{behind, opacity};
use super::super::transport::{Landing, Outcome, Start, Transport};
use crate::light::{Emitter, Guide, Lights, Photon, Spot, View};
use crate::math::concentric::concentric;
use crate::math::frame::tangents;
use crate::math::sin_cos_turns;
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
/// Photons for each that lamps send out evenly; the others are sent after those of these that meet mirrors or glass, as a
/// lamp in a room meets little of either.
const PER_EVEN: u32 = 4;
/// Part of all photons that meet mirrors or glass from which on others are sent after them: where fewer do, what is learned
/// is worth less than it costs. Measured.
const RARE: f64 = 1.0 / 64.0;
/// Smallest change of the place of a photon that is sent after another, in its numbers; the largest is anywhere.
const LEAST_MOVE: f64 = 1e-3;

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
    let (has_passages, even) = (job.has_passages, count.div_ceil(PER_EVEN));
    let shower = Shower { scene, lights, powers: &powers, sampler, even, has_passages, halt: &job.halt };
    let (photons, weight) = shower.photons(transport, count, RARE);
    let (near, far): (Vec<_>, Vec<_>) = photons.into_iter().partition(|photon| photon.side == Side::Near);
    Some([near, far].map(|photons| Guide::new(&photons, weight)))
}

/// Photons of all lamps.
struct Shower<'a> {
    scene: &'a Baked,
    lights: &'a Lights,
    /// Sums of the powers of the lamps up to each.
    powers: &'a [f64],
    sampler: Sampler,
    /// Photons that are sent out evenly.
    even: u32,
    has_passages: bool,
    halt: &'a Halt<'a>,
}

/// Start of a photon.
struct PhotonStart<'a> {
    emitter: &'a Emitter,
    /// Numbers in [0, 1) of its place on the emitter.
    place: [f64; 2],
    /// That place.
    spot: Spot,
    /// True if it leaves the side of the emitter that is opposite to the normal.
    flips: bool,
    /// Unit direction.
    direction: DVec3,
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
    /// The photons that land of `count`, and the weight of those that came through mirrors or glass, of which there are more
    /// than in proportion, unless they are less than the part `rare` of all.
    fn photons<T: Transport>(&self, transport: &T, count: u32, rare: f64) -> (Vec<Photon>, f64) {
        let mut photons = self.fall(transport, 0..self.even, &[]);
        let is_specular = |(_, photon): &(u32, Photon)| photon.way.is_some();
        let seeds: Vec<u32> =
            photons.iter().filter(|landed| is_specular(landed)).map(|(index, _)| *index).collect();
        if (seeds.len() as f64) < rare * photons.len() as f64 {
            photons.extend(self.fall(transport, self.even..count, &[]));
            return (photons.into_iter().map(|(_, photon)| photon).collect(), 1.0);
        }
        if !seeds.is_empty() {
            let followers = self.fall(transport, self.even..count, &seeds);
            photons.extend(followers.into_iter().filter(is_specular));
        }
        let specular = photons.iter().filter(|landed| is_specular(landed)).count();
        let weight = seeds.len() as f64 / specular.max(1) as f64;
        (photons.into_iter().map(|(_, photon)| photon).collect(), weight)
    }

    /// The photons of `range` that land, in their order: sent out evenly, or after `seeds`, which were.
    fn fall<T: Transport>(&self, transport: &T, range: Range<u32>, seeds: &[u32]) -> Vec<(u32, Photon)> {
        let Range { start, end } = range;
        (0..(end - start).div_ceil(TOGETHER))
            .into_par_iter()
            .map_init(RayBatch::default, |batch, part| {
                let first = start + part * TOGETHER;
                self.fall_together(transport, batch, first..end.min(first + TOGETHER), seeds)
            })
            .flatten_iter()
            .collect()
    }

    /// Those of as many as are followed together.
    fn fall_together<T: Transport>(
        &self,
        transport: &T,
        batch: &mut RayBatch<T>,
        range: Range<u32>,
        seeds: &[u32],
    ) -> Vec<(u32, Photon)> {
        let mut landed: Vec<Option<Photon>> = range.clone().map(|_| None).collect();
        let first = range.start;
        let departure =
            |index| if seeds.is_empty() { self.departure(index) } else { self.follower(index, seeds) };
        let (mut flying, mut starts): (Vec<Flying>, Vec<Start<T::Carried>>) =
            range.filter_map(|index| self.start(index, &departure(index)?)).unzip();
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
        (first..).zip(landed).filter_map(|(index, photon)| Some((index, photon?))).collect()
    }

    /// Four numbers in [0, 1) for an event of a photon.
    fn numbers(&self, index: u32, set: u32) -> [f32; 4] {
        self.sampler.point(Key { pixel: u32::MAX, sample: index, set })
    }

    /// Start of a photon that is sent out evenly.
    fn departure(&self, index: u32) -> Option<PhotonStart<'_>> {
        let [choice, back, place @ ..] = self.numbers(index, 0).map(f64::from);
        let total = *self.powers.last()?;
        let emitter = self.powers.partition_point(|&below| below <= choice * total);
        let emitter = self.lights.emitters().get(emitter)?;
        let spot = emitter.sample(&View::Everywhere, place[0], place[1])?;
        let flips = emitter.both_sides && emitter.sphere().is_none() && back < 0.5;
        let outwards = if flips { -spot.normal } else { spot.normal };
        let [u, v, ..] = self.numbers(index, 1).map(f64::from);
        Some(PhotonStart { emitter, place, spot, flips, direction: shade::sample_cosine(outwards, u, v) })
    }

    /// Start of a photon that is sent after one of `seeds`: by a change of any size, as mirrors and glass may be near or
    /// far, the lamp small or large.
    fn follower(&self, index: u32, seeds: &[u32]) -> Option<PhotonStart<'_>> {
        let [choice, spread, place @ ..] = self.numbers(index, 0).map(f64::from);
        let seed = *seeds.get((choice * seeds.len() as f64) as usize)?;
        let PhotonStart { emitter, place: seed_place, flips, direction, .. } = self.departure(seed)?;
        let moved = libm::pow(LEAST_MOVE, 1.0 - spread);
        let place =
            [0, 1].map(|i| (seed_place[i] + moved * (place[i] - 0.5)).rem_euclid(1.0).min(1f64.next_down()));
        let spot = emitter.sample(&View::Everywhere, place[0], place[1])?;
        let [u, v, spread, _] = self.numbers(index, 1).map(f64::from);
        // From the angle between photons sent out evenly up to its root.
        let turned = libm::pow(4.0 * PI / f64::from(self.even), 0.5 - 0.25 * spread);
        let ([square, turns], (e1, e2)) = (concentric(u, v), tangents(direction));
        let (sin, cos) = sin_cos_turns::sin_cos(turns);
        let direction = (direction + turned * square.sqrt() * (cos * e1 + sin * e2)).normalize();
        Some(PhotonStart { emitter, place, spot, flips, direction })
    }

    fn start<C: Default>(&self, index: u32, departure: &PhotonStart) -> Option<(Flying, Start<C>)> {
        let &PhotonStart { emitter, spot, flips, direction, .. } = departure;
        let outwards = if flips { -spot.normal } else { spot.normal };
        if direction.dot(outwards) <= 0.0 {
            return None;
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;
    use crate::trace::choice::with_render_transport;
    use crate::trace::transport::TransportVisitor;

    /// A lamp far above a mirror ball and a glass ball on a floor.
    const BALLS: &str = r#"
        [camera]
        position = [0, 1, 9]
        look_at = [0, 1, 0]
        vertical_fov = 40
        [[material]]
        name = "white"
        [[material]]
        name = "lamp"
        emission = 1
        [[material]]
        name = "mirror"
        kind = "mirror"
        [[material]]
        name = "glass"
        kind = "dielectric"
        [[entity]]
        disk = { center = [0, 0, 0], normal = [0, 1, 0], outer = 30 }
        material = "white"
        [[entity]]
        sphere = { center = [0, 12, 0], radius = 1 }
        material = "lamp"
        [[entity]]
        sphere = { center = [-3, 2, 1], radius = 1 }
        material = "mirror"
        [[entity]]
        sphere = { center = [3, 2, -1], radius = 1 }
        material = "glass"
    "#;

    /// Photons through mirrors and glass, of so many: with followers, and as many all of which are sent out evenly.
    struct BothShowers<'a>(&'a Baked, u32);

    impl TransportVisitor for BothShowers<'_> {
        type Output = [Vec<Photon>; 2];

        fn run<T: Transport + 'static>(self, transport: T) -> [Vec<Photon>; 2] {
            let Self(scene, count) = self;
            let job = Job::new(scene, &scene.settings, Halt::default());
            let illumination = Illumination::of(scene, &transport).unwrap();
            let powers = [1.0];
            [count / PER_EVEN, count].map(|even| {
                let shower = Shower {
                    scene,
                    lights: &illumination.lights,
                    powers: &powers,
                    sampler: Sampler::independent(1),
                    even,
                    has_passages: false,
                    halt: &job.halt,
                };
                let (photons, weight) = shower.photons(&transport, count, 0.0);
                let specular: Vec<Photon> =
                    photons.into_iter().filter(|photon| photon.way.is_some()).collect();
                assert!(weight <= 1.0 && weight > 0.0, "{weight}");
                specular
            })
        }
    }

    #[test]
    fn most_photons_go_through_mirrors_and_glass_and_land_about_as_those_that_are_sent_out_evenly() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("balls.toml");
        std::fs::write(&path, BALLS).unwrap();
        let scene = load(&path, &[]).unwrap();
        let [followed, even] = with_render_transport(&scene, BothShowers(&scene, 1 << 17));
        assert!(followed.len() > 20 * even.len(), "{} photons, {}", followed.len(), even.len());
        assert!(even.len() > 300, "{}", even.len());
        let share = |photons: &[Photon], is_there: fn(DVec3) -> bool| {
            photons.iter().filter(|photon| is_there(photon.position)).count() as f64 / photons.len() as f64
        };
        let places: [fn(DVec3) -> bool; 3] =
            [|x| x.x > 0.0, |x| x.distance(DVec3::new(3.5, 0.0, -1.0)) < 0.5, |x| x.x < -6.0];
        for (number, is_there) in places.into_iter().enumerate() {
            let (a, b) = (share(&followed, is_there), share(&even, is_there));
            // The seeds are a quarter of those that are sent out evenly, some eighty: to four deviations.
            assert!((a - b).abs() < 0.2, "place {number}: {a}, {b}");
        }
    }
}
