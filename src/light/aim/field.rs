//! Aim in fields of refraction: true connections, by shooting.
//!
//! How many rays join two places is not known beforehand. Newton's method is started from the exact aim of each hole taken
//! alone (the others as a constant potential), for each winding number, and from the sum of what all holes do to the
//! straight direction, of which one or none is gone around. Other rays, by which a tenth of the light comes where several
//! holes share in bending it, are found by chance: Newton's method is started from a direction drawn at random. How likely it
//! leads to a ray is not known, but how often one draws until it leads to the same ray again is the inverse of that on
//! average, so that nothing is missed but what no direction leads to.
//!
//! Reference: Zeltner, Georgiev, Jakob 2020, "Specular Manifold Sampling", ACM TOG 39(4).

use std::f64::consts::TAU;
use std::iter;

use glam::DVec3;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

use crate::geodesic::{FieldConnection, FieldControl, FieldTarget, JoinLimits, Lens, Site, join_in_field};
use crate::math::frame::tangents;
use crate::spacetime::{ConformallyFlat, IndexField, ReissnerNordstrom, Sink};

/// Rays of a field between a place and a target.
pub struct FieldAim<F> {
    field: F,
    holes: Vec<LoneHole>,
    /// Largest winding number.
    windings: u32,
}

/// A hole, as if it were alone.
struct LoneHole {
    center: DVec3,
    metric: ReissnerNordstrom,
    lens: Lens,
}

/// Way to a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldWay {
    /// The straight one, bent by all holes.
    Near,
    /// Around the hole with this index as if it were alone, with this winding number about it, 1 at least.
    Around(usize, u32),
    /// Around the hole with this index once, bent by the others.
    Beside(usize),
}

/// Relative error of the aim of a hole taken alone.
const TOLERANCE: f64 = 1e-6;
/// Least weight, beside that of the near way, of a ray that goes around.
pub const LEAST_AROUND: f64 = 0.02;
/// Weight of rays that go around more than once.
const REMOTE: f64 = 0.01;
/// Corrections of a true connection at most.
const CORRECTIONS: u32 = 10;
/// Weight of rays found by chance, beside those that go around a hole once, and at most.
const BY_CHANCE: f64 = 2.0;
const MOST_BY_CHANCE: f64 = 0.5;
/// Impact parameters from which rays are looked for by chance, in radii of a hole's shadow.
const BESIDE: [f64; 2] = [0.75, 6.0];
/// Solid angle over the area that it would have in flat space below which a ray found by chance is the less likely to be
/// looked into.
const WEAK: f64 = 0.02;
/// Draws at most: rays less likely than the inverse count for less.
const MOST_DRAWS: u32 = 200;
/// Angle between rays that count as one, radians, and relative to that between rays that just pass for connections.
const SAME: [f64; 2] = [1e-7, 10.0];

impl<F: IndexField> FieldAim<F> {
    /// Rays of `field` with winding numbers up to `max_winding` about each hole.
    pub fn new(field: F, max_winding: u32) -> Self {
        let lone = |sink: &Sink| {
            let metric = ReissnerNordstrom::new(2.0 * sink.photon_sphere, 1.0);
            Some(LoneHole { center: sink.center, metric, lens: Lens::new(&metric, TOLERANCE)? })
        };
        let holes = field.sinks().iter().filter_map(lone).collect();
        Self { field, holes, windings: max_winding }
    }

    /// The field.
    pub fn field(&self) -> &F {
        &self.field
    }

    /// All ways, with their weights: about how much light comes along each.
    pub fn ways(&self, x: DVec3, target: FieldTarget) -> impl Iterator<Item = (FieldWay, f64)> {
        let around = self.holes.iter().enumerate().flat_map(move |(i, hole)| {
            let once = hole.sites(x, target).map_or(0.0, |(x, y)| hole.lens.magnification_ratio(&x, &y));
            let weight = move |winding: u32| if winding == 1 { once.max(LEAST_AROUND) } else { REMOTE };
            (1..=self.windings).map(move |winding| (FieldWay::Around(i, winding), weight(winding)))
        });
        let is_around = self.windings > 0 && self.holes.len() > 1;
        let holes = 0..if is_around { self.holes.len() } else { 0 };
        let beside = holes.map(|i| (FieldWay::Beside(i), LEAST_AROUND));
        iter::once((FieldWay::Near, 1.0)).chain(around).chain(beside)
    }

    /// Weight of rays found by chance, beside the [`ways`](Self::ways); 0 where these are all.
    pub fn chance(&self, x: DVec3, target: FieldTarget) -> f64 {
        if self.windings == 0 || self.holes.len() == 1 {
            return 0.0;
        }
        let once = |(way, weight)| if matches!(way, FieldWay::Around(_, 1)) { weight } else { 0.0 };
        let around: f64 = self.ways(x, target).map(once).sum();
        if self.holes.is_empty() { MOST_BY_CHANCE } else { (BY_CHANCE * around).min(MOST_BY_CHANCE) }
    }

    /// Number of holes.
    pub fn holes(&self) -> usize {
        self.holes.len()
    }

    /// Centre and radius of the photon sphere of the hole with this index.
    pub fn hole(&self, index: usize) -> (DVec3, f64) {
        let hole = &self.holes[index];
        (hole.center, hole.metric.photon_sphere())
    }

    /// Unit direction in which a way sets out, about; `None` if the places are the same.
    fn guess(&self, x: DVec3, target: FieldTarget, way: FieldWay) -> Option<DVec3> {
        let straight = match target {
            FieldTarget::Place(y) => (y - x).try_normalize()?,
            FieldTarget::Infinity(to) => to,
        };
        let alone = |hole: &LoneHole, winding: u32| {
            let (x, y) = hole.sites(x, target)?;
            Some(hole.lens.connect(&x, &y, winding)?.direction)
        };
        let bent = |around: Option<usize>| {
            let bend = |(i, hole): (usize, &LoneHole)| {
                let direction = alone(hole, u32::from(around == Some(i)));
                direction.map_or(DVec3::ZERO, |direction| direction - straight)
            };
            (straight + self.holes.iter().enumerate().map(bend).sum::<DVec3>()).try_normalize()
        };
        match way {
            FieldWay::Near => bent(None),
            FieldWay::Around(hole, winding) => alone(&self.holes[hole], winding),
            FieldWay::Beside(hole) => bent(Some(hole)),
        }
    }

    /// The ray along a way, if one is found within `limits`.
    pub fn connect(
        &self,
        control: &FieldControl,
        (x, target): (DVec3, FieldTarget),
        way: FieldWay,
        limits: JoinLimits,
    ) -> Option<FieldConnection> {
        let guess = self.guess(x, target, way)?;
        join_in_field(&self.field, control, (x, guess), target, limits)
    }

    /// The ray along a way that misses its target by no more than `enough`, unless a way before leads to the same.
    pub fn image(
        &self,
        control: &FieldControl,
        ends: (DVec3, FieldTarget),
        way: FieldWay,
        enough: f64,
    ) -> Option<FieldConnection> {
        let limits = JoinLimits { enough, linear: 0.0, corrections: CORRECTIONS };
        let found = self.connect(control, ends, way, limits)?;
        let mut before = self.ways(ends.0, ends.1).map(|(way, _)| way).take_while(|before| *before != way);
        let is_known = before.any(|before| {
            let other = self.connect(control, ends, before, limits);
            other.is_some_and(|other| is_same(&other, &found, enough))
        });
        (!is_known).then_some(found)
    }

    /// A ray that misses its target by no more than `enough` and that no way leads to, from a direction drawn at random, and
    /// a number that on average is the inverse of the probability of finding it.
    pub fn image_by_chance(
        &self,
        control: &FieldControl,
        ends: (DVec3, FieldTarget),
        seed: u64,
        enough: f64,
    ) -> Option<(FieldConnection, f64)> {
        let limits = JoinLimits { enough, linear: 0.0, corrections: CORRECTIONS };
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut draw = || {
            let guess = self.any_direction(ends.0, &mut random);
            join_in_field(&self.field, control, (ends.0, guess), ends.1, limits)
        };
        let found = draw()?;
        let straight = match ends.1 {
            FieldTarget::Place(y) => ends.0.distance_squared(y),
            FieldTarget::Infinity(_) => 1.0,
        };
        let share = (found.geometry_factor() * straight / WEAK).min(1.0);
        if Xoshiro256PlusPlus::seed_from_u64(!seed).random::<f64>() >= share {
            return None;
        }
        let is_found =
            |other: Option<FieldConnection>| other.is_some_and(|other| is_same(&other, &found, enough));
        if self.ways(ends.0, ends.1).any(|(way, _)| is_found(self.connect(control, ends, way, limits))) {
            return None;
        }
        let again = (1..MOST_DRAWS).find(|_| is_found(draw()));
        Some((found, f64::from(again.unwrap_or(MOST_DRAWS)) / share))
    }

    /// A direction drawn at random: past one of the holes, or any if there is none.
    fn any_direction(&self, x: DVec3, random: &mut Xoshiro256PlusPlus) -> DVec3 {
        let [choice, u, turns] = [(); 3].map(|()| random.random::<f64>());
        let (sin, cos) = libm::sincos(TAU * turns);
        let sinks = self.field.sinks();
        let chosen = sinks.get((choice * sinks.len() as f64) as usize);
        if let Some((towards, sink)) = chosen.map(|sink| (sink.center - x, sink)) {
            let (a, b) = tangents(towards.normalize_or(DVec3::Z));
            let impact = sink.shadow * BESIDE[0] * libm::pow(BESIDE[1] / BESIDE[0], u);
            (towards + impact * (cos * a + sin * b)).normalize()
        } else {
            let z = 2.0 * u - 1.0;
            let rho = (1.0 - z * z).sqrt();
            DVec3::new(rho * cos, rho * sin, z)
        }
    }

    /// Directions of all ways, from which to look for rays.
    pub fn guesses(&self, x: DVec3, target: FieldTarget) -> impl Iterator<Item = DVec3> {
        self.ways(x, target).filter_map(move |(way, _)| self.guess(x, target, way))
    }

    /// All rays within `limits` to which any of these directions lead.
    pub fn images(
        &self,
        control: &FieldControl,
        (x, target): (DVec3, FieldTarget),
        guesses: impl Iterator<Item = DVec3>,
        limits: JoinLimits,
    ) -> Vec<FieldConnection> {
        let mut images: Vec<FieldConnection> = Vec::new();
        for guess in guesses {
            if let Some(found) = join_in_field(&self.field, control, (x, guess), target, limits)
                && images.iter().all(|known| !is_same(known, &found, limits.enough))
            {
                images.push(found);
            }
        }
        images
    }
}

/// True of connections that miss by no more than `enough` and are one.
fn is_same(one: &FieldConnection, other: &FieldConnection, enough: f64) -> bool {
    let spread = enough * (other.turns[0].length() + other.turns[1].length());
    one.direction.distance(other.direction) <= SAME[0] + SAME[1] * spread
}

impl LoneHole {
    /// Both ends of a ray, as the hole alone sees them; `None` of one in its middle.
    fn sites(&self, x: DVec3, target: FieldTarget) -> Option<(Site, Site)> {
        let site = |x: DVec3| {
            let away = x - self.center;
            (away != DVec3::ZERO).then(|| self.lens.site(&self.metric, away))
        };
        let there = match target {
            FieldTarget::Place(y) => site(y)?,
            FieldTarget::Infinity(to) => self.lens.infinity(to),
        };
        Some((site(x)?, there))
    }
}
