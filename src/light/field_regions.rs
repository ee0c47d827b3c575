//! Light sampling in fields of refraction: true connections to lights that are points, regions of directions around those
//! to the middles of lights that are surfaces.
//!
//! A region is the ellipse that the derivatives of a connection make of a light's extent. Regions are a function of the
//! receiver and the light alone, so that a ray found by BSDF sampling has the density with which it could have been drawn;
//! what they miss is left to BSDF sampling, as is the sky. Of lights that are points, rays to which no guess leads are found
//! by chance.

use glam::DVec3;

use super::aim::Link;
use super::aim::field::{FieldAim, FieldWay, LEAST_AROUND};
use super::emitter::{Emitter, Extent};
use super::lights::{ChosenLight, Lights, OtherLight};
use super::receiver::Receiver;
use super::regions::shape::Region;
use super::sample::{EmitterHit, LightRayEnd, LightSample, Target};
use super::sampler::{
    LightSampler, distant_sample, point_sample, reaches_emitter, region_density, region_sample,
};
use crate::geodesic::{FieldControl, FieldTarget, JoinLimits};
use crate::math::rescale::rescale;
use crate::spacetime::{AtInfinity, IndexField};

/// Light sampling in a field.
pub struct FieldRegions<F> {
    aim: FieldAim<F>,
    /// Control of rays to lights that are points.
    fine: FieldControl,
    /// Control of rays from which regions follow.
    rough: FieldControl,
}

/// View of a light from a receiver.
struct FieldView<'a, F> {
    regions: &'a FieldRegions<F>,
    x: DVec3,
    extent: Extent,
    /// Length of the longest half-axis of the light.
    size: f64,
    near: Option<Region>,
    /// Rays that go around a hole.
    around: Vec<Around>,
}

/// Rays that go around a hole.
struct Around {
    /// Its index.
    hole: usize,
    /// Unit direction to it.
    towards: DVec3,
    /// Cosine of the largest angle to that in which they leave.
    cos: f64,
    /// Probability of such a ray.
    share: f64,
}

/// Errors of directions of both controls, radians.
const TOLERANCES: [f64; 2] = [1e-6, 1e-3];
/// Distance, relative to the target's, by which a ray to a point may miss.
const ENOUGH: f64 = 1e-6;
/// Part of a light's size by which a ray to its middle may miss, correction of its direction that need not be checked,
/// radians, and corrections at most: what a region then misses is little.
const PART: f64 = 0.2;
const LINEAR: f64 = 0.03;
const CORRECTIONS: u32 = 4;
/// Margin of a region, radians.
const MARGIN: f64 = 0.002;
/// Smallest distance of a receiver from the middle of a light, relative to the light's size.
const NEAREST: f64 = 1.5;
/// Impact parameter of rays that go around, in radii of the photon sphere, at most, if the light is near.
const AROUND: f64 = 8.0;
/// Weight of a region that the receiver's surface looks away from.
const TURNED_AWAY: f64 = 0.02;

impl<F: IndexField> FieldRegions<F> {
    /// Light sampling in `field` among things up to `farthest` from its middle, with winding numbers up to `max_winding`
    /// about each hole; regions go around once at most.
    pub fn new(field: F, farthest: f64, max_winding: u32) -> Self {
        let control = |tolerance| FieldControl::new(&field, farthest, tolerance, f64::INFINITY);
        let [fine, rough] = TOLERANCES.map(control);
        Self { aim: FieldAim::new(field, max_winding), fine, rough }
    }

    /// A ray to a light that is a point, from a number in [0, 1), and the probability with which it is found.
    fn link(&self, x: DVec3, target: FieldTarget, u: f64) -> Option<(Link, f64)> {
        let enough = match target {
            FieldTarget::Place(y) => ENOUGH * x.distance(y),
            FieldTarget::Infinity(_) => ENOUGH,
        };
        let (aim, ends) = (&self.aim, (x, target));
        let by_chance = aim.chance(x, target);
        let sum = by_chance + aim.ways(x, target).map(|(_, weight)| weight).sum::<f64>();
        let mut left = u * sum - by_chance;
        let (ray, pmf) = if left < 0.0 {
            let (ray, draws) = aim.image_by_chance(&self.fine, ends, seed(x, u), enough)?;
            (ray, by_chance / (sum * draws))
        } else {
            let (way, weight) = aim.ways(x, target).find(|(_, weight)| {
                left -= weight;
                left < 0.0
            })?;
            (aim.image(&self.fine, ends, way, enough)?, weight / sum)
        };
        let link =
            Link { direction: ray.direction, arrival: ray.arrival, geometry_factor: ray.geometry_factor() };
        Some((link, pmf))
    }

    /// The view that a receiver has of an emitter; `None` if that is too close, or not found.
    fn view(&self, receiver: &Receiver, emitter: &Emitter) -> Option<FieldView<'_, F>> {
        let (x, extent) = (receiver.position, emitter.extent());
        let size = extent.half_axes.map(DVec3::length).into_iter().fold(0.0, f64::max);
        let distance = x.distance(extent.middle);
        if receiver.on == emitter.primitive || distance < NEAREST * size {
            return None;
        }
        let target = FieldTarget::Place(extent.middle);
        let mut view = FieldView { regions: self, x, extent, size, near: None, around: Vec::new() };
        view.near = view.region(FieldWay::Near);
        let facing = |middle: DVec3, spread: f64| {
            (middle.dot(receiver.normal) + spread).max(TURNED_AWAY + 0.1 * spread)
        };
        let spread = |region: &Region| (region.area() / std::f64::consts::PI).sqrt().min(1.0);
        let mut sum = view.near.as_ref().map_or(0.0, |near| facing(near.middle(), spread(near)));
        for (way, weight) in self.aim.ways(x, target) {
            // Where little light comes around, looking for it costs more than it helps.
            let FieldWay::Around(hole, 1) = way else { continue };
            if weight <= LEAST_AROUND {
                continue;
            }
            let (center, photon_sphere) = self.aim.hole(hole);
            let (to_hole, beyond) = (x.distance(center), extent.middle.distance(center));
            // Those that are bent least are as far out as Einstein's ring.
            let ring = 2.0 * (photon_sphere * to_hole * beyond / (to_hole + beyond)).sqrt();
            let reach = (1.3 * ring + 2.0 * photon_sphere + view.size).max(AROUND * photon_sphere);
            let sin = reach / to_hole;
            let cos = if sin < 1.0 { (1.0 - sin * sin).sqrt() } else { -1.0 };
            let towards = (center - x).normalize_or(DVec3::Z);
            let share = weight * facing(towards, sin.min(1.0));
            sum += share;
            view.around.push(Around { hole, towards, cos, share });
        }
        for around in &mut view.around {
            around.share /= sum;
        }
        Some(view)
    }
}

/// Seed of the random numbers of a receiver, from a number that differs between samples.
fn seed(x: DVec3, u: f64) -> u64 {
    let mix = |hash: u64, number: f64| {
        (hash.rotate_left(23) ^ number.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    };
    [x.x, x.y, x.z].into_iter().fold(u.to_bits(), mix)
}

impl<F: IndexField> FieldView<'_, F> {
    /// The region of a way.
    fn region(&self, way: FieldWay) -> Option<Region> {
        let FieldRegions { aim, rough, .. } = self.regions;
        let Extent { middle, half_axes, is_round } = self.extent;
        let ends = (self.x, FieldTarget::Place(middle));
        let limits = JoinLimits { enough: PART * self.size, linear: LINEAR, corrections: CORRECTIONS };
        let link = aim.connect(rough, ends, way, limits)?;
        // Of a sphere, the disk across the ray is seen.
        let [a, b] = link.across;
        let half_axes = if is_round { [self.size * a, self.size * b, DVec3::ZERO] } else { half_axes };
        let shifts = half_axes.map(|axis| link.turned(axis));
        let beside =
            shifts.map(|shift| [(link.direction + shift).normalize(), (link.direction - shift).normalize()]);
        Region::about(link.direction, beside.as_flattened(), Some(self.pole(way)), MARGIN)
    }

    /// Pole of sectors: the hole that rays go around, or the one that bends the near one most.
    fn pole(&self, way: FieldWay) -> DVec3 {
        let aim = &self.regions.aim;
        let hole = match way {
            FieldWay::Around(hole, _) | FieldWay::Beside(hole) => Some(aim.hole(hole)),
            FieldWay::Near => {
                let bends = |(center, photon_sphere): &(DVec3, f64)| photon_sphere / self.x.distance(*center);
                let holes = (0..aim.holes()).map(|hole| aim.hole(hole));
                holes.max_by(|a, b| bends(a).total_cmp(&bends(b)))
            }
        };
        hole.map_or(DVec3::Z, |(center, _)| (center - self.x).normalize_or(DVec3::Z))
    }

    /// Probability of the near region.
    fn near_share(&self) -> f64 {
        1.0 - self.around.iter().map(|around| around.share).sum::<f64>()
    }

    /// Density of a direction; of the hole with the index `known`, if any, the region is known.
    fn density(&self, direction: DVec3, known: Option<(usize, &Region)>) -> f64 {
        let near = self.near.as_ref().map_or(0.0, |near| self.near_share() * near.density(direction));
        let around = |around: &Around| {
            if !around.holds(direction) {
                return 0.0;
            }
            let density = match known {
                Some((hole, region)) if hole == around.hole => region.density(direction),
                Some(_) | None => self.region(around.way()).map_or(0.0, |region| region.density(direction)),
            };
            around.share * density
        };
        near + self.around.iter().map(around).sum::<f64>()
    }

    /// A direction, from two numbers in [0, 1), and its density.
    fn sample(&self, [u, mut v]: [f64; 2]) -> Option<(DVec3, f64)> {
        for around in &self.around {
            if v < around.share {
                let region = self.region(around.way())?;
                let direction = region.sample(u, rescale(v, 0.0, around.share));
                let density = self.density(direction, Some((around.hole, &region)));
                return around.holds(direction).then_some((direction, density));
            }
            v -= around.share;
        }
        let direction = self.near.as_ref()?.sample(u, rescale(v, 0.0, self.near_share()));
        Some((direction, self.density(direction, None)))
    }
}

impl Around {
    fn way(&self) -> FieldWay {
        FieldWay::Around(self.hole, 1)
    }

    /// True if rays in this direction may go around: only for them need the region be known.
    fn holds(&self, direction: DVec3) -> bool {
        self.towards.dot(direction) >= self.cos
    }
}

impl<F: IndexField> LightSampler for FieldRegions<F> {
    fn sample(&self, lights: &Lights, receiver: &Receiver, [u, v]: [f64; 2]) -> Option<LightSample> {
        let x = receiver.position;
        let (choice, u) = lights.choose(receiver, u)?;
        match choice {
            ChosenLight::Surface(emitter, pmf) => {
                let (direction, density) = self.view(receiver, emitter)?.sample([u, v])?;
                Some(region_sample(emitter, direction, pmf * density))
            }
            ChosenLight::Other(OtherLight::Point(_, light, index, pmf)) => {
                let y = light.position()?;
                let (link, way_pmf) = self.link(x, FieldTarget::Place(y), v)?;
                // Intensities are those of the light's own frame.
                let geometry_factor = link.geometry_factor / self.aim.field().area_scale(y);
                Some(point_sample((light, index), &Link { geometry_factor, ..link }, pmf * way_pmf))
            }
            ChosenLight::Other(OtherLight::Distant(side, light, inverse_pmf)) => {
                let (link, way_pmf) = self.link(x, FieldTarget::Infinity(-light.direction()?), v)?;
                Some(distant_sample((side, light, inverse_pmf), &link, way_pmf))
            }
            ChosenLight::Other(OtherLight::Sky(..)) => None,
        }
    }

    fn surface_density(
        &self,
        lights: &Lights,
        receiver: &Receiver,
        direction: DVec3,
        hit: &EmitterHit,
    ) -> f64 {
        region_density(lights, receiver, hit, |emitter| {
            self.view(receiver, emitter).map_or(0.0, |view| view.density(direction, None))
        })
    }

    /// The sky is left to BSDF sampling.
    fn sky_density(&self, _: &Lights, _: &Receiver, _: DVec3, _: AtInfinity) -> f64 {
        0.0
    }

    fn reaches(&self, lights: &Lights, target: Target, end: &LightRayEnd) -> bool {
        reaches_emitter(lights, target, end, |normal| normal)
    }

    fn samples_sky(&self) -> bool {
        false
    }
}
