//! View of a light from a receiver around a spinning hole: a region of directions for each winding number.

use std::f64::consts::PI;

use glam::DVec3;

use super::shape::Region;
use crate::geodesic::kerr::{Aimed, KerrPlace, PlacedHole, UnitHole};
use crate::light::emitter::{Emitter, Extent};
use crate::light::receiver::Receiver;

/// View of a light: its near region, and what the region of rays that go around the hole follows from.
pub struct RegionView {
    hole: UnitHole,
    from: KerrPlace,
    light: Light,
    /// Pole of sectors.
    pole: DVec3,
    near: Region,
    /// Probability of a direction of rays that go around.
    around: f64,
    /// Cosine of the largest angle to the direction of the hole in which rays that go around leave.
    cos_around: f64,
}

/// A light, in units of the hole.
struct Light {
    /// Position of its middle.
    position: DVec3,
    middle: KerrPlace,
    half_axes: [DVec3; 3],
    is_round: bool,
    /// Length of the longest half-axis.
    size: f64,
}

/// Margin of a region for the error of the aim: radians, and what the square of the spin adds, near the hole and by
/// winding number.
const MARGIN: f64 = 0.002;
const SPIN_MARGIN: [f64; 2] = [0.004, 0.012];
/// Smallest distance of a receiver from the middle of a light, relative to the light's size.
const NEAREST: f64 = 1.5;
/// How much of the spin the pole of sectors is off the principal null direction.
const SWING: f64 = 2.7;
/// Impact parameter of rays that go around, of any spin, at most, if the light is near.
const AROUND: f64 = 8.0;
/// Least weight of rays that go around, relative to the near ones.
const LEAST_AROUND: f64 = 0.02;
/// Size of a light relative to the sine of the angle between both up to which what is seen of it is linear.
const LINEAR: f64 = 0.2;

impl RegionView {
    /// The view that a receiver has of an emitter; `None` if that is too close or too large. Directions are along the
    /// hole's axes.
    pub fn new(
        place: &PlacedHole,
        receiver: &Receiver,
        emitter: &Emitter,
        goes_around: bool,
    ) -> Option<Self> {
        let Extent { middle, half_axes, is_round } = emitter.extent();
        let size = half_axes.map(|axis| axis.length()).into_iter().fold(0.0, f64::max);
        if receiver.on == emitter.primitive || receiver.position.distance(middle) < NEAREST * size {
            return None;
        }
        let hole = place.hole;
        let inwards = |position: DVec3| place.inwards((position - place.center) / place.mass);
        let from = KerrPlace::new(&hole, inwards(receiver.position));
        let position = inwards(middle);
        let light = Light {
            position,
            middle: KerrPlace::new(&hole, position),
            half_axes: half_axes.map(|axis| place.inwards(axis) / place.mass),
            is_round,
            size: size / place.mass,
        };
        // A lamp that the hole touches may be seen anywhere.
        if light.middle.r - light.size <= 1.0 / hole.horizon {
            return None;
        }
        let about_axis = DVec3::new(-from.n.y, from.n.x, 0.0);
        let pole = (-from.n - SWING * hole.a / from.r * about_axis).normalize();
        let near = light.region(&hole, &from, pole, 0)?;
        let normal = place.inwards(receiver.normal);
        // Those that are bent least are as far out as Einstein's ring.
        let ring = 2.0 * (from.r * light.middle.r / (from.r + light.middle.r)).sqrt();
        let sin_around = (1.3 * ring + 2.0 + light.size).max(AROUND) / from.r;
        let cos_around =
            if sin_around < 1.0 { (1.0 - sin_around * sin_around).max(0.0).sqrt() } else { -1.0 };
        // Large regions may be seen although their middles are not.
        let weight = |middle: DVec3, spread: f64| (middle.dot(normal) + spread).max(0.02 + 0.1 * spread);
        let around = if goes_around {
            let spread = (near.area() / PI).sqrt().min(1.0);
            let near = weight(near.middle(), spread);
            let around =
                from.ratio_around(&light.middle).max(LEAST_AROUND) * weight(-from.n, sin_around.min(1.0));
            around / (near + around)
        } else {
            0.0
        };
        Some(Self { hole, from, light, pole, near, around, cos_around })
    }

    /// A direction, from three numbers in [0, 1), and its density.
    pub fn sample(&self, [choice, u, v]: [f64; 3]) -> Option<(DVec3, f64)> {
        if choice < self.around {
            let around = self.region_around()?;
            let direction = around.sample(u, v);
            let density = self.around / around.area() + (1.0 - self.around) * self.near.density(direction);
            return self.is_around(direction).then_some((direction, density));
        }
        let direction = self.near.sample(u, v);
        Some((direction, (1.0 - self.around) / self.near.area() + self.density_around(direction)))
    }

    /// Density of a direction.
    pub fn density(&self, direction: DVec3) -> f64 {
        (1.0 - self.around) * self.near.density(direction) + self.density_around(direction)
    }

    fn density_around(&self, direction: DVec3) -> f64 {
        if self.around == 0.0 || !self.is_around(direction) {
            return 0.0;
        }
        self.around * self.region_around().map_or(0.0, |region| region.density(direction))
    }

    /// True if rays in this direction may go around: only for them need the region be known.
    fn is_around(&self, direction: DVec3) -> bool {
        -self.from.n.dot(direction) >= self.cos_around
    }

    fn region_around(&self) -> Option<Region> {
        self.light.region(&self.hole, &self.from, self.pole, 1)
    }
}

impl Light {
    /// The region of rays with a winding number.
    fn region(&self, hole: &UnitHole, from: &KerrPlace, pole: DVec3, winding: u32) -> Option<Region> {
        let aim = from.aim(hole, &self.middle, winding)?;
        let direction = aim.shot.direction;
        let margin = MARGIN + SPIN_MARGIN[winding as usize] * hole.a * hole.a;
        let half_axes = self.half_axes(from, &aim);
        let radius = self.middle.r;
        if self.size < LINEAR * radius * aim.steadiness()
            && let Some(shifts) = aim.shifts(from, hole, radius, half_axes.map(|axis| axis / radius))
            && let Some(region) = Region::small(direction, &shifts, margin)
        {
            return Some(region);
        }
        let mut points = [direction; 6];
        for (pair, axis) in points.chunks_exact_mut(2).zip(half_axes) {
            if axis != DVec3::ZERO {
                for (point, beside) in pair.iter_mut().zip([self.position + axis, self.position - axis]) {
                    *point = aim.beside(from, hole, beside)?;
                }
            }
        }
        Region::about(direction, &points, pole, margin)
    }

    /// Half-axes; of a sphere along the radius, and along and across the plane of the orbit, where its extremes are seen.
    fn half_axes(&self, from: &KerrPlace, aim: &Aimed) -> [DVec3; 3] {
        if !self.is_round {
            return self.half_axes;
        }
        let radial = self.position.normalize_or(DVec3::Z);
        let across = aim.across(from);
        let across = (across - across.dot(radial) * radial).try_normalize();
        let across = across.unwrap_or_else(|| radial.any_orthonormal_vector());
        [radial, across, radial.cross(across)].map(|axis| self.size * axis)
    }
}
