//! Vertices with a position and more out of faces that name each separately.

use rayon::prelude::*;

/// The triangles of corners that each name what a vertex is made of; `vertex` is called for every one of their vertices,
/// in the order of its number.
///
/// Corners are sorted, not hashed: files with a normal for each face have as many vertices as corners.
pub(super) fn merge<K: Copy + Ord + Send>(
    corners: impl Iterator<Item = K>,
    mut vertex: impl FnMut(K),
) -> Vec<[u32; 3]> {
    let mut corners: Vec<(K, u32)> = corners.zip(0..).collect();
    corners.par_sort_unstable();
    let mut triangles = vec![[0; 3]; corners.len() / 3];
    let places = triangles.as_flattened_mut();
    for (number, alike) in (0..).zip(corners.chunk_by(|a, b| a.0 == b.0)) {
        alike.iter().for_each(|&(_, corner)| places[corner as usize] = number);
        vertex(alike[0].0);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_with_two_normals_becomes_two_vertices() {
        let named = [(0, 0), (1, 0), (2, 0), (2, 1), (0, 0), (3, 1)];
        let mut vertices = Vec::new();
        let triangles = merge(named.into_iter(), |vertex| vertices.push(vertex));
        assert_eq!(vertices, [(0, 0), (1, 0), (2, 0), (2, 1), (3, 1)]);
        let found = triangles.as_flattened().iter().map(|&vertex| vertices[vertex as usize]);
        assert!(found.eq(named));
    }
}
