//! Mean radiance of a surface whose emission varies.

use glam::{DVec3, Vec3};

use crate::geometry::{Geometry, PrimitiveId, Shape};
use crate::shade::{Footprint, Material, Texture};

/// Parts of an edge of a triangle: their squares are the parts of the triangle.
const PARTS: usize = 8;

/// The mean over a primitive of what its material emits: of a triangle over the middles of equal parts, looked up twice
/// as wide as they are, so that no texel is missed. What is no triangle has no textures.
pub(super) fn mean_radiance(
    geometry: &Geometry,
    (material, textures): (&Material, &[Texture]),
    primitive: PrimitiveId,
    shape: &Shape,
) -> Vec3 {
    let Shape::Triangle([a, b, c]) = *shape else { return material.emission };
    let footprint = Footprint::of_width(2.0 * shape.area().sqrt() / PARTS as f64);
    let emitted = |at: DVec3| {
        let point = geometry.mesh_point(primitive, at);
        point.map_or(material.emission, |point| material.at(&point, footprint, textures).emission)
    };
    let thirds = |row: usize, column: usize, third: usize| {
        let place = |index: usize| (3 * index + third) as f64 / (3 * PARTS) as f64;
        emitted(a + place(row) * (b - a) + place(column) * (c - a))
    };
    let upright = |row| (0..PARTS - row).map(move |column| (row, column, 1));
    let inverted = |row| (0..PARTS - 1 - row).map(move |column| (row, column, 2));
    let parts = (0..PARTS).flat_map(|row| upright(row).chain(inverted(row)));
    parts.map(|(row, column, third)| thirds(row, column, third)).sum::<Vec3>() / (PARTS * PARTS) as f32
}
