//! Triangle meshes as loaded: indexed columns in their own (object) space.

use glam::{DAffine3, DVec3, Vec3};

use super::attributes::Attributes;
use super::vertex_normals::VertexNormals;

/// An indexed triangle mesh with one material, in object space.
///
/// Positions are what the file holds (f32); normals are per vertex and empty when the file has none, in which case
/// triangles are flat.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, object space.
    pub positions: Vec<[f32; 3]>,
    /// Vertex normals (unit length not required); empty, or one per position.
    pub normals: Vec<[f32; 3]>,
    /// Vertex indices of each triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// What else vertices have.
    pub attributes: Attributes,
}

/// A placed mesh: several instances may share one mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index of the mesh in the geometry's mesh list.
    pub mesh: u32,
    /// Object space → world; any invertible affine map, mirroring included.
    pub to_world: DAffine3,
}

impl Mesh {
    /// The vertex normals of `triangle`; `None` if the mesh has none.
    #[inline(always)]
    pub(super) fn vertex_normals(&self, triangle: u32) -> Option<VertexNormals> {
        if self.normals.is_empty() {
            return None;
        }
        let [a, b, c] =
            self.triangles[triangle as usize].map(|vertex| Vec3::from(self.normals[vertex as usize]));
        Some(VertexNormals { a, b, c })
    }

    /// The vertex normals of `triangle`, weighted; `None` if the mesh has none, and nobody asks for the weights.
    pub(super) fn interpolated_normal(
        &self,
        triangle: u32,
        weights: impl FnOnce() -> [f64; 3],
    ) -> Option<DVec3> {
        Some(self.vertex_normals(triangle)?.weighted(weights()))
    }

    /// Once triangles are in a hierarchy, only vertex normals, attributes and what finds them are still read.
    pub(super) fn drop_what_shading_does_not_need(&mut self) {
        self.positions = Vec::new();
        if self.normals.is_empty() && self.attributes.is_empty() {
            self.triangles = Vec::new();
        }
    }

    /// Heap memory, bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        12 * (self.positions.len() + self.normals.len() + self.triangles.len())
            + self.attributes.memory_bytes()
    }
}
