//! Mean radiance of a surface whose emission varies.

use glam::Vec3;

use crate::geometry::{Geometry, PrimitiveId, Shape};
use crate::shade::{Material, Texture};

/// Parts of an edge of a triangle: their squares are the parts of the triangle.
const PARTS: usize = 4;

/// The mean over a primitive of what its material emits: of a triangle over the middles of equal parts, looked up twice
/// as wide as they are, so that no texel is missed. What is no triangle has no textures.
pub(super) fn mean_radiance(
    geometry: &Geometry,
    (material, textures): (&Material, &[Texture]),
    primitive: PrimitiveId,
    shape: &Shape,
) -> Vec3 {
    let Shape::Triangle([a, b, c]) = *shape else { return material.emission };
    let Some(point) = geometry.mesh_point(primitive, (a + b + c) / 3.0) else { return material.emission };
    let width = 2.0 * shape.area().sqrt() / PARTS as f64;
    let emitted = |row: usize, column: usize, third: usize| {
        let [v, w] = [row, column].map(|index| (3 * index + third) as f64 / (3 * PARTS) as f64);
        material.emission_at(&point.moved([1.0 - v - w, v, w]), width, textures)
    };
    let upright = |row| (0..PARTS - row).map(move |column| (row, column, 1));
    let inverted = |row| (0..PARTS - 1 - row).map(move |column| (row, column, 2));
    let parts = (0..PARTS).flat_map(|row| upright(row).chain(inverted(row)));
    parts.map(|(row, column, third)| emitted(row, column, third)).sum::<Vec3>() / (PARTS * PARTS) as f32
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DQuat, DVec3};

    use super::*;
    use crate::geometry::{Attributes, Instance, Mesh, Primitives, Surface};
    use crate::shade::{Maps, MipImage, Raster, TextureId, UvTransform, Wrap};

    #[test]
    fn the_mean_over_a_triangle_is_that_of_the_texels_on_it() {
        let bright = |i: usize| i % 64 + i / 64 < 40 || (i * 7919).is_multiple_of(13);
        let texels = (0..64 * 64).map(|i| [if bright(i) { u16::MAX } else { 2000 }; 4]).collect();
        let image = Arc::new(MipImage::new(64, 64, Raster::Linear(texels)));
        let wrap = [Wrap::Clamp; 2];
        let texture = Texture { image, uv_set: 0, transform: UvTransform::IDENTITY, wrap, is_nearest: true };
        let textures = [texture];
        let maps = Maps { emission: Some(TextureId(0)), ..Maps::default() };
        let material = Material { emission: Vec3::new(1.0, 2.0, 3.0), maps, ..Material::default() };
        let uvs = vec![[0.1, 0.05], [0.9, 0.2], [0.8, 0.95], [0.15, 0.7]];
        let mesh = Mesh {
            positions: vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.5, 0.0], [0.0, 1.0, 0.0]],
            normals: Vec::new(),
            triangles: vec![[0, 1, 2], [3, 0, 2]],
            attributes: Attributes { uvs: vec![uvs], ..Attributes::default() },
        };
        let to_world = DAffine3::from_rotation_translation(DQuat::from_xyzw(0.6, 0.0, 0.8, 0.0), DVec3::Y);
        let placed = |to_world| (Instance { mesh: 0, to_world }, Surface { material: 0, entity: 0 });
        let instances = vec![placed(to_world), placed(DAffine3::from_translation(7.0 * DVec3::X))];
        let geometry = Geometry::build(Primitives { meshes: vec![mesh], instances, ..Primitives::default() });
        let shapes = geometry.shapes(|_| true);
        assert_eq!(shapes.len(), 4);
        for (primitive, shape, _) in shapes {
            let Shape::Triangle([a, b, c]) = shape else { panic!("{shape:?}") };
            let steps = 300;
            let places = (0..steps).flat_map(|i| (0..steps - i).map(move |j| [i, j]));
            let emitted = |[i, j]: [usize; 2]| {
                let [v, w] = [i, j].map(|index| (index as f64 + 1.0 / 3.0) / f64::from(steps as u32));
                let point = geometry.mesh_point(primitive, a + v * (b - a) + w * (c - a)).unwrap();
                material.emission_at(&point, 0.0, &textures)
            };
            let exact =
                places.clone().map(|place| emitted(place).as_dvec3()).sum::<DVec3>() / places.count() as f64;
            let mean = mean_radiance(&geometry, (&material, &textures), primitive, &shape).as_dvec3();
            // What is looked up reaches a little beyond the edges.
            let brightest = f64::from(material.emission.max_element());
            assert!((mean - exact).abs().max_element() < 0.03 * brightest, "{mean} for {exact}");
        }
    }
}
