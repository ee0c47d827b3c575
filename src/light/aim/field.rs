//! Aim in fields of refraction: true connections, by shooting.
//!
//! How many rays join two places is not known beforehand. Newton's method is started from the exact aim of each hole taken
//! alone (the others as a constant potential), for each winding number, and from the sum of what all holes do to the
//! straight direction, of which one or none is gone around. What no start leads to is missed: among two to four holes within
//! some dozen of their radii, 1 % of the light.

use std::iter;

use glam::DVec3;

use crate::geodesic::{FieldConnection, FieldControl, FieldTarget, JoinLimits, Lens, Site, join_in_field};
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

    /// All rays within `limits`, as far as they are found: along the ways, and from as many directions as `others` gives.
    pub fn images(
        &self,
        control: &FieldControl,
        (x, target): (DVec3, FieldTarget),
        others: impl Iterator<Item = DVec3>,
        limits: JoinLimits,
    ) -> Vec<FieldConnection> {
        let guesses = self.ways(x, target).filter_map(|(way, _)| self.guess(x, target, way));
        let mut images: Vec<FieldConnection> = Vec::new();
        for guess in guesses.chain(others) {
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
