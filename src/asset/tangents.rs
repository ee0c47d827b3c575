//! Tangents of meshes for normal maps.

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3};

use crate::geometry::Mesh;

/// Most triangles around a place: the library's recursion is as deep, and its time grows with the square.
const MOST_AROUND: usize = 512;

/// Makes the tangents that a mesh is given without, by a set of its texture coordinates; none if it has not that set.
///
/// By MikkTSpace, as glTF asks for and programs bake their normal maps: V upwards, flat normals where there are none.
/// Where very many triangles meet, each triangle has the tangent of its own.
pub(super) fn make_tangents(mesh: &mut Mesh, uv_set: usize) {
    let Some(uvs) = mesh.attributes.uvs.get(uv_set).filter(|uvs| !uvs.is_empty()) else { return };
    let mut tangent_mesh = TangentMesh { mesh, uvs, tangents: Vec::new() };
    let own = |face: usize| [tangent_mesh.of_triangle(face); 3];
    let tangents = (0..mesh.triangles.len()).map(own).collect();
    tangent_mesh.tangents = tangents;
    if most_around(mesh) <= MOST_AROUND {
        // There is nothing that can go wrong; what it leaves out stays as it is.
        let _ = generate_tangents(&mut tangent_mesh);
    }
    mesh.attributes.tangents = tangent_mesh.tangents;
}

/// Largest number of triangles that meet in one place.
fn most_around(mesh: &Mesh) -> usize {
    let mut around: HashMap<[u32; 3], usize> = HashMap::new();
    for &vertex in mesh.triangles.as_flattened() {
        // Adding 0 makes −0 a 0.
        let place = mesh.positions[vertex as usize].map(|coordinate| (coordinate + 0.0).to_bits());
        *around.entry(place).or_default() += 1;
    }
    around.into_values().max().unwrap_or(0)
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

    /// Tangent and sign of a triangle by itself.
    fn of_triangle(&self, face: usize) -> [f32; 4] {
        let [a, b, c] = [0, 1, 2].map(|corner| Vec3::from(self.position(face, corner)).as_dvec3());
        let [of_a, of_b, of_c] = [0, 1, 2].map(|corner| Vec2::from(self.tex_coord(face, corner)).as_dvec2());
        let ((e1, e2), (uv1, uv2)) = ((b - a, c - a), (of_b - of_a, of_c - of_a));
        let area = uv1.perp_dot(uv2);
        let tangent = ((e1 * uv2.y - e2 * uv1.y) * area.signum()).normalize_or(e1.normalize_or_zero());
        tangent.extend(area.signum()).as_vec4().to_array()
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

    #[test]
    fn very_many_triangles_around_a_place_have_tangents_as_well() {
        const COUNT: usize = 100_000;
        let rim = (0..COUNT).map(|i| std::f32::consts::TAU * i as f32 / COUNT as f32);
        let rim = rim.map(|angle| [libm::cosf(angle), libm::sinf(angle)]);
        let flat: Vec<[f32; 2]> = std::iter::once([0.0; 2]).chain(rim).collect();
        let mut mesh = Mesh {
            positions: flat.iter().map(|&[x, y]| [x, y, 0.0]).collect(),
            triangles: (1..COUNT as u32).map(|i| [0, i, i + 1]).collect(),
            attributes: Attributes {
                uvs: vec![flat.iter().map(|&[x, y]| [x, -y]).collect()],
                ..Attributes::default()
            },
            ..Mesh::default()
        };
        make_tangents(&mut mesh, 0);
        assert_eq!(mesh.attributes.tangents.len(), COUNT - 1);
        for tangent in mesh.attributes.tangents.as_flattened() {
            assert!(tangent[0] > 0.99 && tangent[3] == 1.0, "{tangent:?}");
        }
    }
}
