//! Vertices with a position and a normal out of faces that name both separately.

use rayon::prelude::*;

use crate::geometry::Mesh;

/// The mesh with a vertex for each pair of a position and a normal that a corner names.
///
/// Pairs are sorted, not hashed: files with a normal for each face have as many pairs as corners.
pub(super) fn merge(positions: &[f32], normals: &[f32], indices: &[u32], normal_indices: &[u32]) -> Mesh {
    let (positions, _) = positions.as_chunks::<3>();
    let (normals, _) = normals.as_chunks::<3>();
    let mut corners: Vec<(u32, u32, u32)> =
        indices.iter().zip(normal_indices).zip(0..).map(|((&p, &n), corner)| (p, n, corner)).collect();
    corners.par_sort_unstable();
    let mut mesh = Mesh { triangles: vec![[0; 3]; indices.len() / 3], ..Mesh::default() };
    let places = mesh.triangles.as_flattened_mut();
    for pair in corners.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (position, normal, _) = pair[0];
        pair.iter().for_each(|&(.., corner)| places[corner as usize] = mesh.positions.len() as u32);
        mesh.positions.push(positions[position as usize]);
        mesh.normals.push(normals[normal as usize]);
    }
    mesh.normals.shrink_to_fit();
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_with_two_normals_becomes_two_vertices() {
        let positions = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let normals = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
        let mesh = merge(&positions, &normals, &[0, 1, 2, 2, 0, 3], &[0, 0, 0, 1, 0, 1]);
        assert_eq!(mesh.positions.len(), 5);
        let corners = mesh.triangles.as_flattened().iter().map(|&vertex| vertex as usize);
        let named: Vec<_> = corners.map(|vertex| (mesh.positions[vertex], mesh.normals[vertex])).collect();
        let (z, x) = ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        let expected =
            [([0.0; 3], z), (x, z), ([0.0, 1.0, 0.0], z), ([0.0, 1.0, 0.0], x), ([0.0; 3], z), (z, x)];
        assert_eq!(named, expected);
    }
}
