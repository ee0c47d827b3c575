//! Vertex attributes of meshes, and their values at a point.

use glam::{DVec2, DVec3, DVec4, Vec4};

use super::scene::Item;
use super::{Geometry, Mesh, PrimitiveId};

/// What vertices have beside positions and normals: only what a material asks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Sets of texture coordinates, each empty or with one per position.
    pub uvs: Vec<Vec<[f32; 2]>>,
    /// Linear colours and opacities; empty, or one per position.
    pub colors: Vec<[f32; 4]>,
}

impl Attributes {
    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Heap memory, bytes.
    pub fn memory_bytes(&self) -> usize {
        self.uvs.iter().map(|set| size_of_val(set.as_slice())).sum::<usize>()
            + size_of_val(self.colors.as_slice())
    }
}

/// A point of a mesh's triangle.
#[derive(Clone, Copy, Debug)]
pub struct MeshPoint<'a> {
    attributes: &'a Attributes,
    corners: [u32; 3],
    /// Barycentric coordinates.
    weights: [f64; 3],
    /// Twice the area of the triangle in the world.
    doubled_area: f64,
}

impl MeshPoint<'_> {
    /// Texture coordinates of a set, if there are any.
    pub fn uv(&self, set: usize) -> Option<DVec2> {
        let set = self.attributes.uvs.get(set).filter(|set| !set.is_empty())?;
        let weighted = |(index, weight): (u32, f64)| weight * DVec2::from(set[index as usize].map(f64::from));
        Some(self.corners.into_iter().zip(self.weights).map(weighted).sum())
    }

    /// Area in texture coordinates of a set over that in the world, on the triangle.
    pub fn uv_density(&self, set: usize) -> f64 {
        let Some(set) = self.attributes.uvs.get(set).filter(|set| !set.is_empty()) else { return 0.0 };
        let [a, b, c] = self.corners.map(|index| DVec2::from(set[index as usize].map(f64::from)));
        (b - a).perp_dot(c - a).abs() / self.doubled_area
    }

    /// Linear vertex colour and opacity; white if there are none.
    pub fn color(&self) -> Vec4 {
        let colors = &self.attributes.colors;
        if colors.is_empty() {
            return Vec4::ONE;
        }
        let weighted =
            |(index, weight): (u32, f64)| weight * DVec4::from(colors[index as usize].map(f64::from));
        self.corners.into_iter().zip(self.weights).map(weighted).sum::<DVec4>().as_vec4()
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
        let (instance, triangle, weights, doubled_area) = match self.item(primitive.item) {
            Item::Sphere(_) | Item::Disk(_) => return None,
            Item::Triangle(number) => {
                let single = self.single(number);
                let weights = self.single_weights(primitive.item, single.instance, point);
                let doubled_area = self.triangle(primitive.item).normal().length();
                (single.instance, number - single.first, weights, doubled_area)
            }
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let shared = self.shared[placed.mesh as usize].as_ref()?;
                let corners = shared.triangles.get(primitive.triangle as usize);
                let (u, v) = corners.barycentrics(placed.to_object.transform_point3(point));
                let area_normal = placed.normal_to_world * corners.normal();
                let doubled_area = area_normal.length() / placed.to_object.matrix3.determinant().abs();
                (i, shared.bvh.order()[primitive.triangle as usize], [1.0 - u - v, u, v], doubled_area)
            }
        };
        let Mesh { triangles, attributes, .. } = &self.meshes[self.placed[instance as usize].mesh as usize];
        // Of meshes without attributes the corners may be forgotten.
        let corners = triangles.get(triangle as usize).copied().unwrap_or_default();
        Some(MeshPoint { attributes, corners, weights, doubled_area })
    }
}
