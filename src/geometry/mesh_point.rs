//! Points of meshes, and the values of vertex attributes there.

use glam::{DVec2, DVec3, DVec4, Vec4};

use super::scene::{Item, Placed};
use super::{Geometry, Mesh, PrimitiveId};

/// A point of a mesh's triangle.
#[derive(Clone, Copy, Debug)]
pub struct MeshPoint<'a> {
    mesh: &'a Mesh,
    placed: &'a Placed,
    triangle: u32,
    /// Its vertices.
    corners: [u32; 3],
    /// Barycentric coordinates.
    weights: [f64; 3],
    /// Normal of the triangle in the world, of twice its area.
    area_normal: DVec3,
}

impl MeshPoint<'_> {
    /// The point of the same triangle with other barycentric coordinates.
    pub fn moved(&self, weights: [f64; 3]) -> Self {
        Self { weights, ..*self }
    }

    /// Texture coordinates of a set, if there are any.
    pub fn uv(&self, set: usize) -> Option<DVec2> {
        let set = self.mesh.attributes.uvs.get(set).filter(|set| !set.is_empty())?;
        let weighted = |(index, weight): (u32, f64)| weight * DVec2::from(set[index as usize].map(f64::from));
        Some(self.corners.into_iter().zip(self.weights).map(weighted).sum())
    }

    /// Area in texture coordinates of a set over that in the world, on the triangle.
    pub fn uv_density(&self, set: usize) -> f64 {
        let Some(set) = self.mesh.attributes.uvs.get(set).filter(|set| !set.is_empty()) else { return 0.0 };
        let [a, b, c] = self.corners.map(|index| DVec2::from(set[index as usize].map(f64::from)));
        (b - a).perp_dot(c - a).abs() / self.area_normal.length()
    }

    /// Linear vertex colour and opacity; white if there are none.
    pub fn color(&self) -> Vec4 {
        let colors = &self.mesh.attributes.colors;
        if colors.is_empty() {
            return Vec4::ONE;
        }
        let weighted =
            |(index, weight): (u32, f64)| weight * DVec4::from(colors[index as usize].map(f64::from));
        self.corners.into_iter().zip(self.weights).map(weighted).sum::<DVec4>().as_vec4()
    }

    /// Unit normal in the world that a normal in tangent space (along tangent, bitangent and normal) stands for; `None`
    /// without tangents.
    pub fn from_tangent_space(&self, [x, y, z]: [f64; 3]) -> Option<DVec3> {
        let tangents = self.mesh.attributes.tangents.get(self.triangle as usize)?;
        let weighted = |(tangent, weight): (&[f32; 4], f64)| weight * DVec4::from(tangent.map(f64::from));
        let along: DVec4 = tangents.iter().zip(self.weights).map(weighted).sum();
        let to_world = self.placed.normal_to_world;
        let normal = self.mesh.interpolated_normal(self.triangle, || self.weights);
        let normal = normal.unwrap_or_else(|| (to_world.inverse() * self.area_normal).normalize_or_zero());
        let (tangent, sign) = (along.truncate(), along.w);
        let bitangent = sign * normal.cross(tangent);
        (to_world * (x * tangent + y * bitangent + z * normal)).try_normalize()
    }
}

impl Geometry {
    /// The point of a mesh at the world point `point` of a primitive; `None` if the primitive is no triangle.
    pub fn mesh_point(&self, primitive: PrimitiveId, point: DVec3) -> Option<MeshPoint<'_>> {
        let (owner, primitive) = self.owner(primitive);
        owner.own_mesh_point(primitive, point - owner.origin)
    }

    /// [`Self::mesh_point`] at a point relative to the origin.
    fn own_mesh_point(&self, primitive: PrimitiveId, point: DVec3) -> Option<MeshPoint<'_>> {
        let (instance, triangle, weights, area_normal) = match self.item(primitive.item) {
            Item::Sphere(_) | Item::Disk(_) => return None,
            Item::Triangle(number) => {
                let single = self.single(number);
                let weights = self.single_weights(primitive.item, single.instance, point);
                let area_normal = self.triangle(primitive.item).normal();
                (single.instance, number - single.first, weights, area_normal)
            }
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let shared = self.shared[placed.mesh as usize].as_ref()?;
                let corners = shared.triangles.get(primitive.triangle as usize);
                let (u, v) = corners.barycentrics(placed.to_object.transform_point3(point));
                let area_normal =
                    placed.normal_to_world * corners.normal() / placed.to_object.matrix3.determinant().abs();
                (i, shared.bvh.order()[primitive.triangle as usize], [1.0 - u - v, u, v], area_normal)
            }
        };
        let placed = &self.placed[instance as usize];
        let mesh = &self.meshes[placed.mesh as usize];
        // Of meshes without attributes the corners may be forgotten.
        let corners = mesh.triangles.get(triangle as usize).copied().unwrap_or_default();
        Some(MeshPoint { mesh, placed, triangle, corners, weights, area_normal })
    }
}
