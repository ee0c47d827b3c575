//! Points on emitters, chosen side by side.

use std::f64::consts::TAU;

use glam::DVec3;

use super::spherical_triangle::SphericalTriangle;
use crate::math::columns::{Columns, Row, columns};
use crate::math::concentric::concentric;
use crate::math::frame::tangents;
use crate::math::kernel::{Kernel, map};
use crate::math::rescale::rescale;
use crate::math::sin_cos_turns;

columns! {
    /// A point on an emitter.
    #[derive(PartialEq)]
    pub struct Spot => SpotBlock {
        /// World position.
        position: DVec3,
        /// Unit normal, towards the front.
        normal: DVec3,
        /// Density over the area, scene units⁻²; 0 if there is no such point.
        density: f64,
    }
}

columns! {
    /// Two numbers in [0, 1).
    pub struct UnitSquare => UnitSquareBlock {
        /// The first.
        u: f64,
        /// The second.
        v: f64,
    }
}

columns! {
    /// A triangle and where it is looked at from along straight lines.
    pub struct ViewedTriangle => ViewedTriangleBlock {
        /// Corner 0.
        a: DVec3,
        /// Corner 1.
        b: DVec3,
        /// Corner 2.
        c: DVec3,
        /// Position of the onlooker.
        x: DVec3,
    }
}

columns! {
    /// A sphere and the parts of it on which points are chosen: evenly on a cap, or evenly in solid angle where an onlooker
    /// outside sees it as if rays were straight near the sphere.
    pub struct SphereParts => SpherePartsBlock {
        /// Its centre.
        center: DVec3,
        /// Its radius.
        radius: f64,
        /// Share of points on the cap.
        on_cap: f64,
        /// Unit vector from the centre to the middle of the cap.
        axis: DVec3,
        /// 1 − cos of the half-angle of the cap, seen from the centre.
        height: f64,
        /// Unit direction in which the onlooker sees the middle.
        direction: DVec3,
        /// Distance of the onlooker from the middle over the radius.
        distance: f64,
        /// The square of that less 1.
        excess: f64,
        /// 1 − cos of the angle under which the sphere is seen.
        seen_height: f64,
    }
}

/// Kernel that chooses points on triangles.
pub struct TrianglePoints;

/// Kernel that chooses points on spheres.
pub struct SpherePoints;

/// Points to be chosen by a kernel.
pub struct SpotQueue<R: Row> {
    emitters: Columns<R>,
    numbers: Columns<UnitSquare>,
    spots: Columns<Spot>,
    len: usize,
}

impl<R: Row> Default for SpotQueue<R> {
    fn default() -> Self {
        let (emitters, numbers, spots) = (Columns::default(), Columns::default(), Columns::default());
        Self { emitters, numbers, spots, len: 0 }
    }
}

impl<R: Row> SpotQueue<R> {
    /// Makes room for so many points.
    pub fn reserve(&mut self, lanes: usize) {
        self.emitters.grow(lanes);
        self.numbers.grow(lanes);
        self.spots.grow(lanes);
    }

    /// Adds a point for which there is room, to be chosen from two numbers in [0, 1).
    #[inline(always)]
    pub fn push(&mut self, emitter: R, [u, v]: [f64; 2]) {
        self.emitters.set(self.len, emitter);
        self.numbers.set(self.len, UnitSquare { u, v });
        self.len += 1;
    }

    /// Chooses all, calls `each` with those that there are and their numbers, and forgets them.
    #[inline(always)]
    pub fn choose<K>(&mut self, kernel: &K, mut each: impl FnMut(usize, Spot))
    where
        K: Kernel<A = R, B = UnitSquare, Out = Spot>,
    {
        let lanes = std::mem::take(&mut self.len);
        map(kernel, self.emitters.blocks(lanes), self.numbers.blocks(lanes), self.spots.blocks_mut(lanes));
        for lane in 0..lanes {
            let spot = self.spots.get(lane);
            if spot.density > 0.0 {
                each(lane, spot);
            }
        }
    }
}

impl Kernel for TrianglePoints {
    type A = ViewedTriangle;
    type B = UnitSquare;
    type Out = Spot;

    #[inline(always)]
    fn run(
        &self,
        &ViewedTriangle { a, b, c, x }: &ViewedTriangle,
        &UnitSquare { u, v }: &UnitSquare,
    ) -> Spot {
        let across = (b - a).cross(c - a);
        let double_area = across.length();
        let normal = across / double_area;
        let triangle = SphericalTriangle::seen([a, b, c], x);
        let direction = triangle.sample(u, v);
        let offset = (a - x).dot(normal) / direction.dot(normal) * direction;
        let density = triangle.density(offset, normal);
        let is_seen = triangle.is_seen();
        let even = even_point([a, b, c], u, v);
        let pick = |seen: f64, even: f64| if is_seen { seen } else { even };
        let (seen, even_density) = (x + offset, 2.0 / double_area);
        let position = DVec3::new(pick(seen.x, even.x), pick(seen.y, even.y), pick(seen.z, even.z));
        let density = pick(density, even_density);
        let is_usable = (position.length_squared() < f64::INFINITY) & (density > 0.0) & (double_area > 0.0);
        Spot { position, normal, density: if is_usable { density } else { 0.0 } }
    }
}

/// A point evenly over a triangle, from two numbers in [0, 1): Heitz 2019, "A Low-Distortion Map Between Triangle and
/// Square".
#[inline(always)]
pub fn even_point([a, b, c]: [DVec3; 3], u: f64, v: f64) -> DVec3 {
    let is_above = v > u;
    let (s, t) = (if is_above { 0.5 * u } else { u - 0.5 * v }, if is_above { v - 0.5 * u } else { 0.5 * v });
    a + s * (b - a) + t * (c - a)
}

impl Kernel for SpherePoints {
    type A = SphereParts;
    type B = UnitSquare;
    type Out = Spot;

    #[inline(always)]
    fn run(&self, parts: &SphereParts, &UnitSquare { u, v }: &UnitSquare) -> Spot {
        let &SphereParts { center, radius, on_cap, axis, height, direction, distance, excess, seen_height } =
            parts;
        let is_on_cap = u < on_cap;
        let (below, share) = if is_on_cap { (0.0, on_cap) } else { (on_cap, 1.0 - on_cap) };
        let [square, turns] = concentric(rescale(u, below, share), v);
        // The ray at the angle θ to the middle meets the sphere after t radii, at the angle α seen from the centre.
        let less = square * seen_height;
        let (cos, sin2) = (1.0 - less, less * (2.0 - less));
        let root = (1.0 - distance * distance * sin2).max(0.0).sqrt();
        let t = excess / (distance * cos + root);
        let sin2_alpha = (t * t * sin2).min(1.0);
        let seen = sin2_alpha / (1.0 + (1.0 - sin2_alpha).sqrt());
        let pick = |cap: f64, seen: f64| if is_on_cap { cap } else { seen };
        let towards =
            DVec3::new(pick(axis.x, -direction.x), pick(axis.y, -direction.y), pick(axis.z, -direction.z));
        let normal = around(towards, pick(square * height, seen), turns);
        Spot { position: center + radius * normal, normal, density: parts.density(normal) }
    }
}

impl SphereParts {
    /// A sphere that nobody sees.
    pub const UNSEEN: SphereParts = SphereParts {
        center: DVec3::ZERO,
        radius: 1.0,
        on_cap: 1.0,
        axis: DVec3::Z,
        height: 2.0,
        direction: DVec3::Z,
        distance: 2.0,
        excess: 3.0,
        seen_height: 0.1,
    };

    /// The sphere as one sees it from outside, with this share of points on the cap; as it is if not from outside.
    #[inline(always)]
    pub fn seen_from(self, distance: f64, direction: DVec3, on_cap: f64) -> Self {
        let k = distance / self.radius;
        let excess = ((distance - self.radius) / self.radius) * (k + 1.0);
        let seen_height = 1.0 / (k * (k + excess.sqrt()));
        if excess > 0.0 { Self { on_cap, direction, distance: k, excess, seen_height, ..self } } else { self }
    }

    /// Density over the area with which points of this normal are chosen, where they are on the cap or seen.
    #[inline(always)]
    pub fn density(&self, normal: DVec3) -> f64 {
        let even = 1.0 / (TAU * self.radius * self.radius * self.height);
        let offset = self.radius * (self.distance * self.direction + normal);
        let distance2 = offset.length_squared();
        let cos = -offset.dot(normal) / distance2.sqrt();
        let seen = if cos > 0.0 { cos / (TAU * self.seen_height * distance2) } else { 0.0 };
        if self.on_cap < 1.0 { self.on_cap * even + (1.0 - self.on_cap) * seen } else { even }
    }
}

/// The unit vector at an angle to `axis`, given by 1 − its cosine, and the azimuth in turns.
#[inline(always)]
fn around(axis: DVec3, height: f64, turns: f64) -> DVec3 {
    let (tangent, bitangent) = tangents(axis);
    let sin = (height * (2.0 - height)).max(0.0).sqrt();
    let (s, c) = sin_cos_turns::sin_cos(turns);
    sin * (c * tangent + s * bitangent) + (1.0 - height) * axis
}
