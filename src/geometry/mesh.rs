//! Triangle meshes as loaded: indexed columns in their own (object) space.

use glam::DAffine3;

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
}

/// A placed mesh: several instances may share one mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Index of the mesh in the geometry's mesh list.
    pub mesh: u32,
    /// Object space → world; any invertible affine map, mirroring included.
    pub to_world: DAffine3,
}
