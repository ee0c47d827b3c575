//! Regions: light sampling around a spinning hole, where no formula joins two places.
//!
//! For each winding number, an aim that is exact to first order in the spin tells about where a light is seen: a region
//! of directions around that, from which one is drawn evenly. The regions are a function of the receiver and the light
//! alone, so that a ray found by BSDF sampling has the density with which it could have been drawn; what they miss, and
//! lamps that fill the view, is left to BSDF sampling. Whatever ray ends on the light counts, from wherever it comes.
//!
//! Only surfaces are sampled.

mod aim;
mod shape;

use glam::DVec3;

use super::emitter::{Emitter, Extent};
use super::lights::{ChosenLight, Lights};
use super::receiver::Receiver;
use super::sample::{EmitterHit, Incoming, LightRayEnd, LightSample, Target};
use super::sampler::LightSampler;
use crate::geodesic::kerr::PlacedHole;
use crate::spacetime::RestFrame;
use aim::{KerrPlace, TurnedBack};
use shape::Region;

/// Light sampling by regions of directions.
pub struct Regions {
    place: PlacedHole,
    frame: RestFrame,
    windings: u32,
}

/// Winding numbers beyond this one dilute the samples more than they help.
const MAX_WINDING: u32 = 1;
/// Margin of a region for the error of the aim, radians.
const MARGIN: f64 = 0.01;
/// Smallest distance of a receiver from the middle of a light, relative to the light's size.
const NEAREST: f64 = 1.5;
/// How much of the spin the pole of sectors is off the principal null direction.
const SWING: f64 = 2.7;

/// Regions of one light with the probabilities of their choice.
struct Choice {
    regions: [Option<(Region, f64)>; MAX_WINDING as usize + 1],
}

impl Choice {
    /// Chooses a direction from three numbers in [0, 1).
    fn sample(&self, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        let mut below = 0.0;
        let mut chosen = None;
        for (region, pmf) in self.regions.iter().flatten() {
            chosen = Some(region);
            below += pmf;
            if choice < below {
                break;
            }
        }
        Some(chosen?.sample(u, v))
    }

    /// Density of a direction.
    fn density(&self, direction: DVec3) -> f64 {
        let held = self.regions.iter().flatten().filter(|(region, _)| region.holds(direction));
        held.map(|(region, pmf)| pmf / region.area()).sum()
    }
}

impl Regions {
    /// Regions around the hole in its `place`, whose frame at rest is `frame`, for winding numbers up to `max_winding`.
    pub fn new(place: PlacedHole, frame: RestFrame, max_winding: u32) -> Self {
        Self { place, frame, windings: max_winding.min(MAX_WINDING) + 1 }
    }

    /// A world position in units of the hole.
    fn inwards(&self, position: DVec3) -> DVec3 {
        self.place.inwards((position - self.place.center) / self.place.mass)
    }

    /// The regions in which a receiver sees an emitter; none if it is too close or too large.
    fn choice(&self, receiver: &Receiver, emitter: &Emitter) -> Choice {
        let mut choice = Choice { regions: [None; MAX_WINDING as usize + 1] };
        let Extent { middle, half_axes, is_round } = emitter.extent();
        let size = half_axes.map(|axis| axis.length()).into_iter().fold(0.0, f64::max);
        if receiver.on == emitter.primitive || receiver.position.distance(middle) < NEAREST * size {
            return choice;
        }
        let hole = &self.place.hole;
        let y = self.inwards(middle);
        let half_axes = half_axes.map(|axis| self.place.inwards(axis) / self.place.mass);
        let (x, target) = (KerrPlace::new(hole, self.inwards(receiver.position)), KerrPlace::new(hole, y));
        // A lamp that the hole touches may be seen anywhere.
        if target.r - size / self.place.mass <= 1.0 / hole.horizon {
            return choice;
        }
        let across = DVec3::new(-x.n.y, x.n.x, 0.0);
        let pole = (-x.n - SWING * hole.a / x.r * across).normalize();
        let normal = self.place.inwards(receiver.normal);
        let mut total = 0.0;
        for winding in 0..self.windings {
            let region = x.aim(hole, &target, winding).and_then(|aim| {
                let half_axes =
                    if is_round { aligned(y, &x, &aim, half_axes[0].length()) } else { half_axes };
                self.region(&x, &aim, winding, (y, half_axes), pole)
            });
            choice.regions[winding as usize] = region.map(|region| {
                let area = region.area();
                // Large regions may be seen although their middle is not.
                let spread = (area / std::f64::consts::PI).sqrt().min(1.0);
                let cos = region.middle().dot(normal);
                let weight = area * (cos + spread).max(0.02 + 0.1 * spread);
                total += weight;
                (region, weight)
            });
        }
        for (_, weight) in choice.regions.iter_mut().flatten() {
            *weight /= total;
        }
        choice
    }

    /// The region of one winding number.
    fn region(
        &self,
        x: &KerrPlace,
        aim: &TurnedBack,
        winding: u32,
        (y, half_axes): (DVec3, [DVec3; 3]),
        pole: DVec3,
    ) -> Option<Region> {
        let mut points = [aim.shot.direction; 6];
        for (pair, axis) in points.chunks_exact_mut(2).zip(half_axes) {
            if axis == DVec3::ZERO {
                continue;
            }
            for (point, y) in pair.iter_mut().zip([y + axis, y - axis]) {
                *point = aim.beside(x, &self.place.hole, y, winding)?;
            }
        }
        Region::about(aim.shot.direction, &points, pole, MARGIN)
    }
}

/// Half-axes of a sphere about `y`: along the radius, and along and across the plane of the orbit, where its extremes
/// are seen.
fn aligned(y: DVec3, x: &KerrPlace, aim: &TurnedBack, radius: f64) -> [DVec3; 3] {
    let radial = y.normalize_or(DVec3::Z);
    let across = aim.turned(x.n.cross(aim.place.n));
    let across = (across - across.dot(radial) * radial).try_normalize();
    let across = across.unwrap_or_else(|| radial.any_orthonormal_vector());
    [radial, across, radial.cross(across)].map(|axis| radius * axis)
}

impl LightSampler for Regions {
    fn sample(&self, lights: &Lights, receiver: &Receiver, [u0, u @ ..]: [f64; 4]) -> Option<LightSample> {
        let ChosenLight::Surface(emitter, pmf) = lights.choose(receiver, u0)? else { return None };
        let choice = self.choice(receiver, emitter);
        let direction = choice.sample(u)?;
        let density = pmf * choice.density(direction);
        (density > 0.0).then(|| LightSample {
            direction: self.place.outwards(direction),
            target: Target::Surface(emitter.primitive, emitter.middle()),
            light: Incoming::Radiance(emitter.radiance, density),
        })
    }

    fn surface_density(
        &self,
        lights: &Lights,
        receiver: &Receiver,
        direction: DVec3,
        hit: &EmitterHit,
    ) -> f64 {
        let Some((emitter, index)) = lights.emitter(hit.primitive) else { return 0.0 };
        let pmf = lights.emitter_pmf(index, receiver);
        if pmf == 0.0 {
            return 0.0;
        }
        pmf * self.choice(receiver, emitter).density(self.place.inwards(direction))
    }

    /// The sky is left to BSDF sampling.
    fn sky_density(&self, _: &Lights, _: &Receiver, _: DVec3, _: DVec3) -> f64 {
        0.0
    }

    fn reaches(&self, lights: &Lights, target: Target, end: &LightRayEnd) -> bool {
        let Target::Surface(wanted, _) = target else { return false };
        let Some((emitter, _)) = lights.emitter(end.primitive).filter(|_| end.primitive == wanted) else {
            return false;
        };
        let normal = self.frame.normal(end.position, emitter.normal_at(end.position));
        emitter.both_sides || end.direction.dot(normal) < 0.0
    }
}
