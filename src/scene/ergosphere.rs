//! Things where nothing can be at rest: inside the ergosphere of a spinning hole.

use std::f64::consts::TAU;

use glam::DVec3;
use hecs::Entity;

use super::error::Fault;
use super::world::World;
use crate::geometry::{Disk, Primitives, Sphere};
use crate::math::frame;
use crate::spacetime::SpacetimeKind;

/// Points each way of a surface that are looked at.
const POINTS: u32 = 12;

/// Refuses surfaces that reach into the ergosphere, as far as points spread over them tell.
pub(super) fn check(world: &World, primitives: &Primitives, shaped: &[Entity]) -> Result<(), Fault> {
    let SpacetimeKind::Spinning { placement, hole } = &world.spacetime else { return Ok(()) };
    let (center, reach) = (placement.center, hole.equatorial_radius(hole.ergosphere()));
    let reaches = |low: DVec3, high: DVec3, mut points: Box<dyn Iterator<Item = DVec3>>| {
        center.clamp(low, high).distance_squared(center) <= reach * reach
            && points.any(|point| hole.drags(placement.local(point)))
    };
    let sphere = |sphere: &Sphere| {
        let (low, high) = (sphere.center - sphere.radius, sphere.center + sphere.radius);
        reaches(low, high, Box::new(on_sphere(*sphere, center)))
    };
    let disk = |disk: &Disk| {
        let (low, high) = (disk.center - disk.outer, disk.center + disk.outer);
        reaches(low, high, Box::new(on_disk(*disk)))
    };
    let triangle =
        |[a, b, c]: [DVec3; 3]| reaches(a.min(b).min(c), a.max(b).max(c), Box::new(on_triangle([a, b, c])));
    let spheres = primitives.spheres.iter().filter(|(shape, _)| sphere(shape)).map(|(_, surface)| surface);
    let disks = primitives.disks.iter().filter(|(shape, _)| disk(shape)).map(|(_, surface)| surface);
    let meshes = primitives.instances.iter().filter(|(instance, _)| {
        primitives.meshes.get(instance.mesh as usize).is_some_and(|mesh| {
            let corner = |index: u32| mesh.positions.get(index as usize).copied().unwrap_or_default();
            let placed =
                |index: u32| instance.to_world.transform_point3(DVec3::from(corner(index).map(f64::from)));
            mesh.triangles.iter().any(|corners| triangle(corners.map(placed)))
        })
    });
    let mut found = spheres.chain(disks).chain(meshes.map(|(_, surface)| surface));
    match found.next().and_then(|surface| shaped.get(surface.entity as usize)) {
        None => Ok(()),
        Some(entity) => Err(world.fault(
            *entity,
            "it reaches into the ergosphere of the hole, where nothing can be at rest",
            "move it away, or use a smaller schwarzschild_radius",
        )),
    }
}

/// Pairs of numbers below [`POINTS`].
fn pairs() -> impl Iterator<Item = (f64, f64)> {
    (0..POINTS * POINTS).map(|i| (f64::from(i % POINTS), f64::from(i / POINTS)))
}

/// The point nearest to `center`, and others.
fn on_sphere(sphere: Sphere, center: DVec3) -> impl Iterator<Item = DVec3> {
    let spread = |(i, j): (f64, f64)| {
        let y = 2.0 * (j + 0.5) / f64::from(POINTS) - 1.0;
        let (sin, cos) = libm::sincos(TAU * i / f64::from(POINTS));
        let across = (1.0 - y * y).sqrt();
        DVec3::new(across * cos, y, across * sin)
    };
    let nearest = (center - sphere.center).normalize_or(DVec3::Y);
    std::iter::once(nearest).chain(pairs().map(spread)).map(move |way| sphere.center + sphere.radius * way)
}

fn on_disk(disk: Disk) -> impl Iterator<Item = DVec3> {
    let (x, y) = frame::tangents(disk.normal);
    pairs().map(move |(i, j)| {
        let (sin, cos) = libm::sincos(TAU * i / f64::from(POINTS));
        let radius = disk.inner + (disk.outer - disk.inner) * j / f64::from(POINTS - 1);
        disk.center + radius * (cos * x + sin * y)
    })
}

fn on_triangle([a, b, c]: [DVec3; 3]) -> impl Iterator<Item = DVec3> {
    pairs().map(move |(i, j)| {
        let (u, v) = (i / f64::from(POINTS - 1), j / f64::from(POINTS - 1));
        a + u * (b - a) + (1.0 - u) * v * (c - a)
    })
}
