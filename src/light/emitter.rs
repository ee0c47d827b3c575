//! Surfaces that emit, and points on them.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::aim::Approach;
use super::receiver::Receiver;
use super::sample::Incoming;
use super::spherical_triangle::SphericalTriangle;
use super::spots::{SphereParts, SpherePoints, Spot, TrianglePoints, UnitSquare, ViewedTriangle, even_point};
use super::tree::Emission;
use crate::geometry::{PrimitiveId, Shape, Sphere};
use crate::math::concentric::concentric;
use crate::math::frame::tangents;
use crate::math::kernel::Kernel;
use crate::math::sin_cos_turns;

/// An emitting primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Its name in the geometry.
    pub primitive: PrimitiveId,
    /// The part of it on which points are chosen.
    pub form: Form,
    /// Emitted radiance; the mean if it varies.
    pub radiance: Vec3,
    /// True if a texture varies it.
    pub varies: bool,
    /// True if its back emits, too.
    pub both_sides: bool,
}

/// Part of an emitter on which points are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Everywhere.
    Whole(Shape),
    /// On the part of a sphere that can be seen.
    Cap(Sphere, Cap),
}

/// A cap of a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Unit vector from the sphere's centre to the middle of the cap.
    pub axis: DVec3,
    /// 1 − cos of its half-angle, seen from the centre: the height over the radius.
    height: f64,
}

impl Cap {
    /// All of a sphere.
    const WHOLE: Cap = Cap { axis: DVec3::Z, height: 2.0 };

    /// A cap of half-angle `angle`, radians, around the unit vector `axis`.
    pub fn new(axis: DVec3, angle: f64) -> Self {
        Self { axis, height: 2.0 * libm::sin(0.5 * angle).powi(2) }
    }

    /// True if a point with this unit normal lies on it.
    pub fn holds(&self, normal: DVec3) -> bool {
        0.5 * normal.distance_squared(self.axis) <= self.height
    }

    /// A box around it, on `sphere`.
    fn bounds(&self, sphere: &Sphere) -> (DVec3, DVec3) {
        let tip = sphere.center + sphere.radius * self.axis;
        let reach = sphere.radius * (2.0 * self.height).sqrt();
        (tip - reach, tip + reach)
    }

    fn area(&self, radius: f64) -> f64 {
        TAU * radius * radius * self.height
    }
}

/// An ellipsoid around an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Its middle.
    pub middle: DVec3,
    /// Three conjugate half-diameters, of which some may be 0.
    pub half_axes: [DVec3; 3],
    /// True of a sphere, whose axes may be turned.
    pub is_round: bool,
}

/// View of an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// From where any of its points may be seen: from inside a sphere, or from itself.
    Everywhere,
    /// From outside, along a ray that ends in the middle.
    Outside(Approach),
    /// From a position, along straight lines.
    Straight(DVec3),
}

/// Side of an emitter on which a place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standpoint {
    /// Inside the sphere that the emitter is, or on its inner side.
    Inside,
    /// On its outer side.
    Upon,
    /// Apart from it, or on the other side of a wormhole; anywhere, if the emitter is no sphere.
    Apart,
}

/// Largest distance of a place that lies on a sphere, relative to the radius: what coincides with the sphere does so
/// but for rounding.
const ON: f64 = 1e-9;
/// Share of points chosen evenly over a sphere if the view is an estimate.
const EVEN: f64 = 0.1;

impl Emitter {
    /// The point of which [`View`] tells the direction.
    pub fn middle(&self) -> DVec3 {
        match self.form {
            Form::Whole(Shape::Sphere(sphere)) | Form::Cap(sphere, _) => sphere.center,
            Form::Whole(Shape::Disk(disk)) => disk.center,
            Form::Whole(Shape::Triangle([a, b, c])) => (a + b + c) / 3.0,
        }
    }

    /// An ellipsoid around it.
    pub fn extent(&self) -> Extent {
        let flat = |normal: DVec3, radius: f64| {
            let (x, y) = tangents(normal);
            [radius * x, radius * y]
        };
        match self.form {
            Form::Cap(Sphere { center, radius }, Cap { axis, height }) if height < 1.0 => {
                let [x, y] = flat(axis, radius * (height * (2.0 - height)).sqrt());
                let middle = center + radius * (1.0 - height) * axis;
                Extent { middle, half_axes: [x, y, radius * height * axis], is_round: false }
            }
            Form::Whole(Shape::Sphere(Sphere { center, radius }))
            | Form::Cap(Sphere { center, radius }, _) => {
                let half_axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| radius * axis);
                Extent { middle: center, half_axes, is_round: true }
            }
            Form::Whole(Shape::Disk(disk)) => {
                let [x, y] = flat(disk.normal, disk.outer);
                Extent { middle: disk.center, half_axes: [x, y, DVec3::ZERO], is_round: false }
            }
            Form::Whole(Shape::Triangle([a, b, c])) => {
                // Steiner's ellipse through the corners, by two conjugate half-diameters.
                let middle = (a + b + c) / 3.0;
                let half_axes = [c - middle, (b - a) / 3f64.sqrt(), DVec3::ZERO];
                Extent { middle, half_axes, is_round: false }
            }
        }
    }

    /// Unit normal at a place on it, towards the front.
    pub fn normal_at(&self, position: DVec3) -> DVec3 {
        match self.form {
            Form::Whole(Shape::Sphere(sphere)) | Form::Cap(sphere, _) => {
                (position - sphere.center).normalize_or_zero()
            }
            Form::Whole(Shape::Disk(disk)) => disk.normal,
            Form::Whole(Shape::Triangle([a, b, c])) => (b - a).cross(c - a).normalize_or_zero(),
        }
    }

    /// The sphere that it is, or is a part of: its back cannot be seen from its front.
    pub fn sphere(&self) -> Option<Sphere> {
        match self.form {
            Form::Whole(Shape::Sphere(sphere)) | Form::Cap(sphere, _) => Some(sphere),
            Form::Whole(_) => None,
        }
    }

    /// Side on which a receiver is. For a sphere it is decided here alone, and for what lies on the sphere by the
    /// side that it looks to: its distance from the centre is the radius but for rounding.
    pub fn standpoint(&self, receiver: &Receiver) -> Standpoint {
        let Some(sphere) = self.sphere() else { return Standpoint::Apart };
        if receiver.on.side() != self.primitive.side() {
            return Standpoint::Apart;
        }
        let from = receiver.position - sphere.center;
        let excess = from.length_squared() / (sphere.radius * sphere.radius) - 1.0;
        if receiver.on != self.primitive && excess.abs() > ON {
            return if excess > 0.0 { Standpoint::Apart } else { Standpoint::Inside };
        }
        if receiver.normal.dot(from) > 0.0 { Standpoint::Upon } else { Standpoint::Inside }
    }

    /// True if light that arrives at the cosine `cos` to the normal is emitted towards a place: from the sides that
    /// emit, and of a sphere from the side on which the place is.
    pub fn is_lit_by(&self, cos: f64, standpoint: Standpoint) -> bool {
        let is_front = match self.sphere() {
            Some(_) => standpoint != Standpoint::Inside,
            None => cos > 0.0,
        };
        (cos > 0.0) == is_front && cos != 0.0 && (is_front || self.both_sides)
    }

    /// Light from it in a direction of a density.
    pub fn incoming(&self, density: f64) -> Incoming {
        if self.varies { Incoming::Seen(density) } else { Incoming::Radiance(self.radiance, density) }
    }

    /// A point, from two numbers in [0, 1).
    pub fn sample(&self, view: &View, u: f64, v: f64) -> Option<Spot> {
        let square = UnitSquare { u, v };
        let (position, normal) = match self.form {
            Form::Cap(..) | Form::Whole(Shape::Sphere(_)) => {
                let spot = SpherePoints.run(&self.sphere_parts(view)?, &square);
                return (spot.density > 0.0).then_some(spot);
            }
            Form::Whole(Shape::Disk(disk)) => {
                let (tangent, bitangent) = tangents(disk.normal);
                let (inner2, outer2) = (disk.inner * disk.inner, disk.outer * disk.outer);
                let [square, turns] = concentric(u, v);
                let radius = (inner2 + square * (outer2 - inner2)).sqrt();
                let (sin, cos) = sin_cos_turns::sin_cos(turns);
                (disk.center + radius * (cos * tangent + sin * bitangent), disk.normal)
            }
            Form::Whole(Shape::Triangle(corners @ [a, b, c])) => {
                if let View::Straight(x) = *view {
                    let spot = TrianglePoints.run(&ViewedTriangle { a, b, c, x }, &square);
                    return (spot.density > 0.0).then_some(spot);
                }
                (even_point(corners, u, v), (b - a).cross(c - a).try_normalize()?)
            }
        };
        let density = self.density(view, position, normal);
        (density > 0.0).then_some(Spot { position, normal, density })
    }

    /// The parts of a sphere on which its points are chosen; `None` if it is no sphere.
    pub fn sphere_parts(&self, view: &View) -> Option<SphereParts> {
        let Sphere { center, radius } = self.sphere()?;
        let cap = match self.form {
            Form::Cap(_, cap) => cap,
            Form::Whole(_) => Cap::WHOLE,
        };
        let parts = SphereParts {
            center,
            radius,
            on_cap: 1.0,
            axis: cap.axis,
            height: cap.height,
            ..SphereParts::UNSEEN
        };
        match (self.form, *view) {
            (Form::Whole(_), View::Outside(Approach { distance, direction, is_exact })) => {
                Some(parts.seen_from(distance, direction, if is_exact { 0.0 } else { EVEN }))
            }
            _ => Some(parts),
        }
    }

    /// Density over the area of a point on it with this normal.
    pub fn density(&self, view: &View, position: DVec3, normal: DVec3) -> f64 {
        match self.form {
            Form::Cap(sphere, cap) if cap.holds(normal) => 1.0 / cap.area(sphere.radius),
            Form::Cap(..) => 0.0,
            Form::Whole(Shape::Sphere(_)) => {
                self.sphere_parts(view).map_or(0.0, |parts| parts.density(normal))
            }
            Form::Whole(Shape::Triangle(corners)) => match seen_triangle(corners, view) {
                Some((triangle, x)) => triangle.density(position - x, normal),
                None => 1.0 / Shape::Triangle(corners).area(),
            },
            Form::Whole(Shape::Disk(disk)) => 1.0 / Shape::Disk(disk).area(),
        }
    }

    /// Bounds, power and orientation cone for the light tree.
    pub fn emission(&self) -> Emission {
        let (min, max, area) = match self.form {
            Form::Cap(sphere, cap) => {
                let (min, max) = cap.bounds(&sphere);
                (min, max, cap.area(sphere.radius))
            }
            Form::Whole(shape) => {
                let (min, max) = shape.bounds();
                (min, max, shape.area())
            }
        };
        let (axis, cos_normals) = match self.form {
            Form::Cap(_, cap) => (cap.axis, 1.0 - cap.height),
            Form::Whole(Shape::Sphere(_)) => (DVec3::Z, -1.0),
            Form::Whole(Shape::Disk(disk)) => (disk.normal, 1.0),
            Form::Whole(Shape::Triangle([a, b, c])) => ((b - a).cross(c - a).normalize_or(DVec3::Z), 1.0),
        };
        let sides = if self.both_sides && self.sphere().is_none() { 2.0 } else { 1.0 };
        let power = sides * PI * area * luminance(self.radiance);
        let both_sides = self.both_sides;
        Emission { min, max, power, axis, cos_normals, cos_emission: 0.0, both_sides }
    }
}

/// A triangle as an onlooker at a position sees it, if that is worth while.
fn seen_triangle(corners: [DVec3; 3], view: &View) -> Option<(SphericalTriangle, DVec3)> {
    match *view {
        View::Straight(x) => {
            Some((SphericalTriangle::seen(corners, x), x)).filter(|(triangle, _)| triangle.is_seen())
        }
        View::Everywhere | View::Outside(_) => None,
    }
}

/// Luminance of linear Rec. 709 colours.
pub fn luminance(colour: Vec3) -> f64 {
    colour.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722))
}
