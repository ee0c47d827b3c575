//! Primitives as shapes in the world, for those who want points on them.

use glam::DVec3;

use super::scene::{Item, Placed, SharedMesh};
use super::{Disk, Geometry, PrimitiveId, Sphere, Surface};
use crate::spacetime::Side;

/// The shape of a primitive, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// An annulus.
    Disk(Disk),
    /// A triangle by its corners, counter-clockwise seen from the front.
    Triangle([DVec3; 3]),
}

impl Shape {
    /// Area, scene units².
    pub fn area(&self) -> f64 {
        match self {
            Shape::Sphere(sphere) => 4.0 * std::f64::consts::PI * sphere.radius * sphere.radius,
            Shape::Disk(disk) => std::f64::consts::PI * (disk.outer * disk.outer - disk.inner * disk.inner),
            Shape::Triangle([a, b, c]) => 0.5 * (b - a).cross(c - a).length(),
        }
    }

    /// Least and greatest corner of a box around it.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        match self {
            Shape::Sphere(sphere) => (sphere.center - sphere.radius, sphere.center + sphere.radius),
            Shape::Disk(disk) => {
                let half =
                    disk.outer * (DVec3::ONE - disk.normal * disk.normal).max(DVec3::ZERO).map(f64::sqrt);
                (disk.center - half, disk.center + half)
            }
            Shape::Triangle([a, b, c]) => (a.min(*b).min(*c), a.max(*b).max(*c)),
        }
    }
}

impl Geometry {
    /// The primitives of both sides whose surface is `wanted`, with their shapes; each triangle of each instance counts.
    pub fn shapes(&self, wanted: impl Fn(&Surface) -> bool) -> Vec<(PrimitiveId, Shape, Surface)> {
        let mut shapes = self.own_shapes(&wanted);
        let far = self.far.iter().flat_map(|far| far.own_shapes(&wanted));
        shapes.extend(far.map(|(primitive, shape, surface)| (primitive.on(Side::Far), shape, surface)));
        shapes
    }

    fn own_shapes(&self, wanted: impl Fn(&Surface) -> bool) -> Vec<(PrimitiveId, Shape, Surface)> {
        let mut shapes = Vec::new();
        for (slot, item) in self.members() {
            let id = |triangle: u32| PrimitiveId { item: slot, triangle };
            let surface = self.surface(id(0));
            if !wanted(&surface) {
                continue;
            }
            match item {
                Item::Sphere(i) => {
                    let (sphere, _) = self.spheres[i as usize];
                    let sphere = Sphere { center: sphere.center + self.origin, ..sphere };
                    shapes.push((id(0), Shape::Sphere(sphere), surface));
                }
                Item::Disk(i) => {
                    let (disk, _) = self.disks[i as usize];
                    let disk = Disk { center: disk.center + self.origin, ..disk };
                    shapes.push((id(0), Shape::Disk(disk), surface));
                }
                Item::Triangle(_) => {
                    let corners = self.triangle(slot).corners().map(|corner| corner + self.origin);
                    shapes.push((id(0), Shape::Triangle(corners), surface));
                }
                Item::Instance(i) => {
                    let placed = self.placed_shapes(&self.placed[i as usize]);
                    shapes.extend(placed.map(|(k, corners)| (id(k), Shape::Triangle(corners), surface)));
                }
            }
        }
        shapes
    }

    /// Slots and corners of the triangles of a placed mesh, world.
    fn placed_shapes(&self, placed: &Placed) -> impl Iterator<Item = (u32, [DVec3; 3])> {
        let to_world = placed.to_object.inverse();
        let mirrored = to_world.matrix3.determinant() < 0.0;
        let triangles = self.shared[placed.mesh as usize].iter().flat_map(SharedMesh::triangles);
        triangles.map(move |(slot, triangle)| {
            let [a, b, c] = triangle.corners();
            let corners = if mirrored { [a, c, b] } else { [a, b, c] };
            (slot, corners.map(|corner| to_world.transform_point3(corner) + self.origin))
        })
    }
}
