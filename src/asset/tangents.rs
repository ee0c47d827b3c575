//! Tangents of meshes for normal maps.

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::Vec3;

use crate::geometry::Mesh;

/// Makes the tangents that a mesh is given without, by a set of its texture coordinates; none if it has not that set.
///
/// By MikkTSpace, as glTF asks for and programs bake their normal maps: V upwards, flat normals where there are none.
pub(super) fn make_tangents(mesh: &mut Mesh, uv_set: usize) {
    let Some(uvs) = mesh.attributes.uvs.get(uv_set).filter(|uvs| !uvs.is_empty()) else { return };
    let tangents = vec![[[1.0, 0.0, 0.0, 1.0]; 3]; mesh.triangles.len()];
    let mut tangent_mesh = TangentMesh { mesh, uvs, tangents };
    // There is nothing that can go wrong.
    if let Ok(()) = generate_tangents(&mut tangent_mesh) {
        mesh.attributes.tangents = tangent_mesh.tangents;
    }
}

/// A mesh as the library asks for it.
struct TangentMesh<'a> {
    mesh: &'a Mesh,
    uvs: &'a [[f32; 2]],
    /// Of the corners of each triangle.
    tangents: Vec<[[f32; 4]; 3]>,
}

/// Functions with the same bits on every machine.
struct Libm;

impl Ops for Libm {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

impl TangentMesh<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry<Libm> for TangentMesh<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)]
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        if let Some(normal) = self.mesh.normals.get(self.vertex(face, corner)) {
            return Vec3::from(*normal).normalize_or_zero().to_array();
        }
        let [a, b, c] = [0, 1, 2].map(|corner| Vec3::from(self.position(face, corner)));
        (b - a).cross(c - a).normalize_or_zero().to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let [u, v] = self.uvs[self.vertex(face, corner)];
        if u.is_finite() && v.is_finite() { [u, 1.0 - v] } else { [0.0; 2] }
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(tangent) = tangent {
            self.tangents[face][corner] = tangent.tangent_encoded();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Attributes;

    #[test]
    fn the_tangent_goes_along_u_and_its_sign_tells_where_v_is_mirrored() {
        let uvs = |mirrored: bool| {
            let u = |u: f32| if mirrored { 1.0 - u } else { u };
            vec![[u(0.0), 1.0], [u(1.0), 1.0], [u(0.0), 0.0]]
        };
        for (mirrored, expected) in [(false, [1.0, 0.0, 0.0, 1.0]), (true, [-1.0, 0.0, 0.0, -1.0])] {
            let mut mesh = Mesh {
                positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
                triangles: vec![[0, 1, 2]],
                attributes: Attributes { uvs: vec![uvs(mirrored)], ..Attributes::default() },
                ..Mesh::default()
            };
            make_tangents(&mut mesh, 0);
            assert_eq!(mesh.attributes.tangents, [[expected; 3]]);
            mesh.attributes.tangents.clear();
            make_tangents(&mut mesh, 1);
            assert!(mesh.attributes.tangents.is_empty());
        }
    }
}
