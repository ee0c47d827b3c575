//! View of a light from a receiver around a spinning hole: a region of directions for each winding number.

use std::f64::consts::{PI, SQRT_2};

use glam::DVec3;

use super::shape::Region;
use super::sight::Sight;
use crate::geodesic::kerr::{KerrPlace, OrbitTable, PlacedHole, TablePlace};
use crate::light::emitter::{Emitter, Extent};
use crate::light::receiver::Receiver;
use crate::light::sky_tiles::SkyTile;
use crate::math::rescale::rescale;

/// View of a light: its near region, and what the region of rays that go around the hole follows from.
pub struct RegionView<'a> {
    table: &'a OrbitTable,
    from: TablePlace,
    light: Light,
    /// Pole of sectors.
    pole: DVec3,
    near: Region,
    /// Probability of a direction of rays that go around.
    around: f64,
    /// Cosine of the largest angle to the direction of the hole in which rays that go around leave.
    cos_around: f64,
}

/// A light, in units of the hole; at infinity, lengths are those on the unit sphere of directions.
struct Light {
    /// Position of its middle, or direction to it.
    position: DVec3,
    is_infinite: bool,
    middle: TablePlace,
    half_axes: [DVec3; 3],
    is_round: bool,
    /// Length of the longest half-axis.
    size: f64,
    /// Distance of the middle from the receiver; 1 at infinity.
    distance: f64,
}

/// Margin of a region for the error of the aim, radians: of any, what the square of the spin adds behind the hole, and
/// what it adds for rays that go around.
const MARGIN: f64 = 0.002;
const SPIN_MARGIN: f64 = 0.004;
const AROUND_MARGIN: f64 = 0.012;
/// Smallest distance of a receiver from the middle of a light, relative to the light's size.
const NEAREST: f64 = 1.5;
/// Largest error of the winding about the axis: radians, or relative to the size of the light as the centre sees it.
const TURN_TOLERANCE: f64 = 0.003;
const TURN_SHARE: f64 = 0.1;
/// How much of the spin the pole of sectors is off the principal null direction.
const SWING: f64 = 2.7;
/// Impact parameter of rays that go around, of any spin, at most, if the light is near.
const AROUND: f64 = 8.0;
/// Least weight of rays that go around, relative to the near ones.
const LEAST_AROUND: f64 = 0.02;
/// Size of a light up to which what is seen of it is linear: relative to its distance, and behind the hole to that from
/// the axis through the hole.
const LINEAR: f64 = 0.2;
/// Half-axes that are shorter than this, relative to the longest, do not matter.
const THIN: f64 = 0.1;
/// Light that comes around is left to chance where it is less, relative to that of the near way, than this times the solid
/// angle of the latter over π: what is found easily has little noise.
const WORTHWHILE: f64 = 1.0;

impl<'a> RegionView<'a> {
    /// The view that a receiver has of an emitter; `None` if that is too close or too large. Directions are along the
    /// hole's axes.
    pub fn new(
        place: &PlacedHole,
        table: &'a OrbitTable,
        receiver: &Receiver,
        emitter: &Emitter,
        goes_around: bool,
    ) -> Option<Self> {
        let Extent { middle, half_axes, is_round } = emitter.extent();
        let size = half_axes.map(|axis| axis.length()).into_iter().fold(0.0, f64::max);
        let distance = receiver.position.distance(middle);
        if receiver.on == emitter.primitive || distance < NEAREST * size {
            return None;
        }
        let hole = place.hole;
        let inwards = |position: DVec3| place.inwards((position - place.center) / place.mass);
        let position = inwards(middle);
        let light = Light {
            position,
            is_infinite: false,
            middle: table.place(KerrPlace::new(&hole, position))?,
            half_axes: half_axes.map(|axis| place.inwards(axis) / place.mass),
            is_round,
            size: size / place.mass,
            distance: distance / place.mass,
        };
        // A lamp that the hole touches may be seen anywhere.
        if light.middle.place.r - light.size <= 1.0 / hole.horizon {
            return None;
        }
        Self::of(place, table, receiver, light, goes_around)
    }

    /// The view that a receiver has of a tile of the sky.
    pub fn of_sky(
        place: &PlacedHole,
        table: &'a OrbitTable,
        receiver: &Receiver,
        tile: &SkyTile,
        goes_around: bool,
    ) -> Option<Self> {
        let position = place.inwards(tile.middle);
        // The ellipse through a rectangle's corners.
        let [x, y] = tile.half_axes.map(|axis| SQRT_2 * place.inwards(axis));
        let light = Light {
            position,
            is_infinite: true,
            middle: table.place(KerrPlace { r: f64::INFINITY, n: position })?,
            half_axes: [x, y, DVec3::ZERO],
            is_round: false,
            size: x.length().max(y.length()),
            distance: 1.0,
        };
        Self::of(place, table, receiver, light, goes_around)
    }

    /// The view of a light.
    fn of(
        place: &PlacedHole,
        table: &'a OrbitTable,
        receiver: &Receiver,
        light: Light,
        goes_around: bool,
    ) -> Option<Self> {
        let hole = place.hole;
        let inwards = |position: DVec3| place.inwards((position - place.center) / place.mass);
        let from = table.place(KerrPlace::new(&hole, inwards(receiver.position)))?;
        let about_axis = DVec3::new(-from.place.n.y, from.place.n.x, 0.0);
        let pole = (-from.place.n - SWING * hole.a / from.place.r * about_axis).normalize();
        let near = light.region(table, &from, pole, 0)?;
        let normal = place.inwards(receiver.normal);
        // Those that are bent least are as far out as Einstein's ring.
        let [x, y] = [from.place.r, light.middle.place.r];
        let (ring, wide) = if light.is_infinite {
            (2.0 * x.sqrt(), light.size * x)
        } else {
            (2.0 * (x * y / (x + y)).sqrt(), light.size)
        };
        let sin_around = (1.3 * ring + 2.0 + wide).max(AROUND) / x;
        let cos_around =
            if sin_around < 1.0 { (1.0 - sin_around * sin_around).max(0.0).sqrt() } else { -1.0 };
        // Large regions may be seen although their middles are not.
        let weight = |middle: DVec3, spread: f64| (middle.dot(normal) + spread).max(0.02 + 0.1 * spread);
        let ratio = from.place.ratio_around(&light.middle.place);
        let around = if goes_around && ratio > WORTHWHILE * near.area() / PI {
            let spread = (near.area() / PI).sqrt().min(1.0);
            let near = weight(near.middle(), spread);
            let around = ratio.clamp(LEAST_AROUND, 1.0) * weight(-from.place.n, sin_around.min(1.0));
            around / (near + around)
        } else {
            0.0
        };
        Some(Self { table, from, light, pole, near, around, cos_around })
    }

    /// A direction, from two numbers in [0, 1), and its density.
    pub fn sample(&self, [u, v]: [f64; 2]) -> Option<(DVec3, f64)> {
        if v < self.around {
            let around = self.region_around()?;
            let direction = around.sample(u, rescale(v, 0.0, self.around));
            let density = self.around / around.area() + (1.0 - self.around) * self.near.density(direction);
            return self.is_around(direction).then_some((direction, density));
        }
        let direction = self.near.sample(u, rescale(v, self.around, 1.0 - self.around));
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
        -self.from.place.n.dot(direction) >= self.cos_around
    }

    fn region_around(&self) -> Option<Region> {
        self.light.region(self.table, &self.from, self.pole, 1)
    }
}

impl Light {
    /// The region of rays with a winding number.
    fn region(&self, table: &OrbitTable, from: &TablePlace, pole: DVec3, winding: u32) -> Option<Region> {
        let Self { position, middle, size, distance, .. } = self;
        let radius = if self.is_infinite { 1.0 } else { middle.place.r };
        let tolerance = TURN_TOLERANCE.max(TURN_SHARE * size / radius);
        let sight = Sight::of(table, [from, middle], winding, tolerance)?;
        let direction = sight.direction;
        let a = table.hole().a;
        let see = |position: DVec3| {
            let place = if self.is_infinite {
                KerrPlace { r: f64::INFINITY, n: position.normalize() }
            } else {
                KerrPlace::new(table.hole(), position)
            };
            let place = table.place(place)?;
            sight.beside(table, [from, middle, &place])
        };
        let (sin, cos) = libm::sincos(sight.angle);
        let spin_margin = if winding == 0 { 0.5 * (1.0 - cos) * SPIN_MARGIN } else { AROUND_MARGIN };
        let margin = MARGIN + spin_margin * a * a;
        let is_arc = cos < 0.0 && *size > LINEAR * radius * sin.abs();
        let is_linear = !is_arc && *size < LINEAR * distance;
        let mut points = [direction; 6];
        for (pair, axis) in points.chunks_exact_mut(2).zip(self.half_axes(&sight)) {
            if axis.length() < THIN * size {
                continue;
            }
            pair[0] = see(*position + axis)?;
            pair[1] =
                if is_linear { (2.0 * direction - pair[0]).normalize() } else { see(*position - axis)? };
        }
        Region::about(direction, &points, is_arc.then_some(pole), margin)
    }

    /// Half-axes; of a sphere along the radius, and along and across the plane of the orbit, where its extremes are seen.
    fn half_axes(&self, sight: &Sight) -> [DVec3; 3] {
        if !self.is_round {
            return self.half_axes;
        }
        let radial = self.position.normalize_or(DVec3::Z);
        let across = sight.across - sight.across.dot(radial) * radial;
        let across = across.try_normalize().unwrap_or_else(|| radial.any_orthonormal_vector());
        [radial, across, radial.cross(across)].map(|axis| self.size * axis)
    }
}
