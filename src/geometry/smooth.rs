//! Surfaces of many hits: normals of smooth triangles are found lane beside lane.

use glam::DVec3;

use super::scene::{Item, Single};
use super::vertex_normals::{Interpolating, SmoothHit, SurfaceNormals, VertexNormals};
use super::{Geometry, PrimitiveId, Surface, SurfacePoint, Triangle};
use crate::math::columns::Columns;
use crate::math::kernel::map;

/// Surfaces of many hits. Its memory is used again.
#[derive(Default)]
pub struct SurfacesMet {
    /// The surfaces of smooth triangles, by number of the hit; empty if there are none.
    surfaces: Vec<Option<SurfacePoint>>,
    /// Numbers of those.
    smooth: Vec<usize>,
    triangles: Columns<(Triangle, VertexNormals)>,
    hits: Columns<SmoothHit>,
    normals: Columns<SurfaceNormals>,
}

impl SurfacesMet {
    /// The surface of the hit of a number, if it was worth while to find it with others.
    #[inline(always)]
    pub fn get(&self, number: usize) -> Option<SurfacePoint> {
        *self.surfaces.get(number)?
    }
}

impl Geometry {
    /// [`Self::surface_point`] of those of many hits, given by primitive and world point, that are on smooth triangles.
    #[inline]
    pub fn surface_points(
        &self,
        of: impl Iterator<Item = (PrimitiveId, DVec3)>,
        SurfacesMet { surfaces, smooth, triangles, hits, normals }: &mut SurfacesMet,
    ) {
        surfaces.clear();
        smooth.clear();
        if !self.is_smooth && self.far.as_ref().is_none_or(|far| !far.is_smooth) {
            return;
        }
        for (primitive, point) in of {
            let (owner, primitive) = self.owner(primitive);
            let Some((surface, triangle, hit)) = owner.smooth_hit(primitive, point - owner.origin) else {
                surfaces.push(None);
                continue;
            };
            let lane = smooth.len();
            triangles.grow(lane + 1);
            hits.grow(lane + 1);
            triangles.set(lane, triangle);
            hits.set(lane, hit);
            smooth.push(surfaces.len());
            surfaces.push(Some(SurfacePoint { normal: DVec3::ZERO, shading_normal: DVec3::ZERO, surface }));
        }
        let lanes = smooth.len();
        normals.grow(lanes);
        map(&Interpolating, triangles.blocks(lanes), hits.blocks(lanes), normals.blocks_mut(lanes));
        for (lane, &number) in smooth.iter().enumerate() {
            let SurfaceNormals { geometric, shading } = normals.get(lane);
            if let Some(surface) = &mut surfaces[number] {
                (surface.normal, surface.shading_normal) = (geometric, shading);
            }
        }
    }

    /// Presence of triangles with vertex normals among many, of meshes that appear once.
    pub(super) fn find_smooth(&self) -> bool {
        let mesh = |single: &Single| self.placed[single.instance as usize].mesh;
        let is_smooth = |single: &Single| !self.meshes[mesh(single) as usize].normals.is_empty();
        self.flat.is_empty() && self.singles.iter().any(is_smooth)
    }

    /// A hit at a point relative to the origin as one on a smooth triangle of a mesh that appears once, if it is.
    #[inline(always)]
    fn smooth_hit(
        &self,
        primitive: PrimitiveId,
        point: DVec3,
    ) -> Option<(Surface, (Triangle, VertexNormals), SmoothHit)> {
        let Item::Triangle(number) = self.item(primitive.item) else { return None };
        let Single { instance, first } = self.single(number);
        let placed = &self.placed[instance as usize];
        let vertices = self.meshes[placed.mesh as usize].vertex_normals(number - first)?;
        Some((placed.surface, (self.triangle(primitive.item), vertices), placed.smooth_hit(point)))
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::geometry::{Instance, Line, Mesh, Primitives, Sphere};

    #[test]
    fn surfaces_of_many_hits_are_those_of_each() {
        // A strip of triangles, bent by its normals; they stand in rows that lines go through.
        let positions = (0..40).map(|i| [(i / 2) as f32, (i % 2) as f32, 0.1 * (i % 3) as f32]).collect();
        let normals = (0..40).map(|i| [0.1 * (i % 5) as f32 - 0.2, 0.3 * (i % 2) as f32, 1.0]).collect();
        let triangles = (0..38).map(|i| [i, i + 1 + i % 2, i + 2 - i % 2]).collect();
        let smooth = Mesh { positions, normals, triangles, ..Mesh::default() };
        let flat = Mesh { normals: Vec::new(), ..smooth.clone() };
        // Two are placed once, one of them mirrored, one is flat, and one is placed twice.
        let places = [(0, 1.0), (1, -1.0), (2, 1.0), (3, 1.0), (3, -1.0)];
        let instance = |(row, (mesh, scale)): (u32, (u32, f64))| {
            let scale = DVec3::new(1.0, 1.0 + 0.5 * f64::from(row), 2.0 * scale);
            let to_world = DAffine3::from_scale(scale);
            let translated = DAffine3::from_translation(DVec3::new(0.0, 4.0 * f64::from(row), 0.0));
            (Instance { mesh, to_world: translated * to_world }, Surface { material: row, entity: 0 })
        };
        let sphere = Sphere { center: DVec3::new(9.0, -3.0, 0.0), radius: 1.0 };
        let geometry = Geometry::build(Primitives {
            spheres: vec![(sphere, Surface { material: 9, entity: 0 })],
            meshes: vec![smooth.clone(), smooth.clone(), flat, smooth],
            instances: (0..).zip(places).map(instance).collect(),
            ..Primitives::default()
        });
        let mut hits = Vec::new();
        for i in 0..4000 {
            let down = DVec3::new(0.31 * f64::from(i % 61), 0.37 * f64::from(i / 61) - 4.0, 5.0);
            let line = Line { p0: down, p2: down - 10.0 * DVec3::Z };
            let hit = geometry.intersect(&line, PrimitiveId::NONE);
            hits.extend(hit.map(|hit| (hit.primitive, line.p0 + hit.s * (line.p2 - line.p0))));
        }
        let mut met = SurfacesMet::default();
        geometry.surface_points(hits.iter().copied(), &mut met);
        let alone: Vec<_> =
            hits.iter().map(|&(primitive, point)| geometry.surface_point(primitive, point)).collect();
        for (number, alone) in alone.iter().enumerate() {
            let is_smooth = [0, 1].contains(&alone.surface.material);
            assert_eq!(met.get(number), is_smooth.then_some(*alone));
        }
        for material in [0, 1, 2, 3, 4, 9] {
            let of = |surface: &&SurfacePoint| surface.surface.material == material;
            let surfaces: Vec<&SurfacePoint> = alone.iter().filter(of).collect();
            let is_smooth = surfaces.iter().any(|surface| surface.normal != surface.shading_normal);
            assert!(surfaces.len() > 10 && is_smooth != [2, 9].contains(&material), "{material}");
        }
    }
}
