//! A scene with as many triangles as are asked for.

use glam::{DAffine3, DVec3, Vec3};

use crate::geometry::{Geometry, Instance, Mesh, Primitives, Sphere, Surface};
use crate::scene::{Baked, FarLights};
use crate::shade::{Environment, Material};

/// Radius of the room over the distance of the camera from its middle: bumps stay behind the camera.
const RADIUS: f64 = 1.5;
/// Height of the bumps relative to the radius.
const BUMPS: f64 = 0.05;
/// Distance of the lamp from the middle and its radius, relative to the room's.
const LAMP: (f64, f64) = (0.6, 0.05);
/// Radiance of the lamp.
const EMISSION: f32 = 40.0;
/// Triangles of an icosahedron.
const FACES: usize = 20;

/// The camera, spacetime and settings of `scene` in a closed room of its own, with grey bumpy walls of about
/// `triangles` triangles around the hole and a spherical lamp above it; and how many triangles these are.
///
/// A room, because every ray in it meets a triangle, wherever the camera looks and however the hole bends it.
pub fn room(scene: &Baked, triangles: usize) -> (Baked, usize) {
    let camera = scene.camera;
    let middle = || scene.geometry.bounds().map_or(camera.position, |(min, max)| 0.5 * (min + max));
    let center = scene.spacetime.center().unwrap_or_else(middle);
    let distance = camera.position.distance(center);
    let radius = if distance > 0.0 { RADIUS * distance } else { 1.0 };
    let walls = bumpy_sphere(triangles);
    let count = walls.triangles.len();
    let to_world =
        DAffine3::from_scale_rotation_translation(DVec3::splat(radius), Default::default(), center);
    let lamp = Sphere { center: center + LAMP.0 * radius * camera.up, radius: LAMP.1 * radius };
    let surface = |index| Surface { material: index, entity: index };
    let room = Baked {
        spacetime: scene.spacetime.clone(),
        camera,
        geometry: Geometry::build(Primitives {
            spheres: vec![(lamp, surface(1))],
            meshes: vec![walls],
            instances: vec![(Instance { mesh: 0, to_world }, surface(0))],
            ..Primitives::default()
        }),
        materials: vec![
            Material::default(),
            Material { emission: Vec3::splat(EMISSION), ..Material::default() },
        ],
        textures: Vec::new(),
        entities: vec!["walls".to_owned(), "lamp".to_owned()],
        punctual: Vec::new(),
        environment: Environment::Black,
        settings: scene.settings.clone(),
        far: FarLights::default(),
        warnings: Vec::new(),
        notes: Vec::new(),
    };
    (room, count)
}

/// A bumpy sphere of radius about 1: an icosahedron with every edge cut in as many pieces as give about `triangles`
/// triangles.
pub fn bumpy_sphere(triangles: usize) -> Mesh {
    let pieces = (triangles as f64 / FACES as f64).sqrt().round().max(1.0) as usize;
    let mut mesh = Mesh::default();
    for [a, b, c] in icosahedron() {
        let mut above = 0..0;
        for row in 0..=pieces {
            let start = mesh.positions.len() as u32;
            for column in 0..=row {
                let weights = [pieces - row, row - column, column].map(|w| w as f64 / pieces as f64);
                mesh.positions.push(bumpy(weights[0] * a + weights[1] * b + weights[2] * c));
            }
            for (top, below) in above.clone().zip(start..) {
                mesh.triangles.push([top, below, below + 1]);
                if top + 1 < above.end {
                    mesh.triangles.push([top, below + 1, top + 1]);
                }
            }
            above = start..mesh.positions.len() as u32;
        }
    }
    mesh
}

/// A point of the sphere, moved in or out.
fn bumpy(corner: DVec3) -> [f32; 3] {
    let unit = corner.normalize();
    let height = libm::sin(9.0 * unit.x) * libm::sin(11.0 * unit.y) * libm::cos(13.0 * unit.z);
    ((1.0 + BUMPS * height) * unit).as_vec3().to_array()
}

/// The faces of an icosahedron.
fn icosahedron() -> Vec<[DVec3; 3]> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let corners: Vec<DVec3> = [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)]
        .into_iter()
        .flat_map(|(a, b)| [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)])
        .collect();
    let are_neighbours = |a: usize, b: usize| (corners[a].distance(corners[b]) - 2.0).abs() < 1e-9;
    let mut faces = Vec::new();
    for i in 0..corners.len() {
        for j in (i + 1..corners.len()).filter(|&j| are_neighbours(i, j)) {
            for k in (j + 1..corners.len()).filter(|&k| are_neighbours(i, k) && are_neighbours(j, k)) {
                faces.push([corners[i], corners[j], corners[k]]);
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn a_bumpy_sphere_is_closed_and_has_about_as_many_triangles_as_asked_for() {
        for (asked, expected) in [(1, 20), (1000, 980), (20_000, 20_480)] {
            let mesh = bumpy_sphere(asked);
            assert_eq!(mesh.triangles.len(), expected);
            // Corners of neighbouring faces coincide; Euler: V − E + F = 2, with 3F = 2E.
            let bits = |corner: &[f32; 3]| corner.map(|c| (c + 0.0).to_bits());
            let corners: BTreeSet<[u32; 3]> = mesh.positions.iter().map(bits).collect();
            assert_eq!(corners.len(), expected / 2 + 2);
        }
    }
}
