//! One glTF primitive → one triangle mesh.

use gltf::mesh::{Mode, Semantic};

use super::accessor::{read_indices, read_vectors};
use super::buffers::Buffers;
use crate::asset::error::Flaw;
use crate::asset::notes::Notes;
use crate::asset::tidy::tidy;
use crate::geometry::Mesh;

/// Reads a primitive of the mesh called `name`, and how many degenerate triangles it had; `None` if it has no surface.
pub(super) fn read(
    primitive: &gltf::Primitive,
    buffers: &Buffers,
    notes: &mut Notes,
    name: &str,
) -> Result<Option<(Mesh, usize)>, Flaw> {
    if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        notes.add("points and lines have no surface and are ignored, in mesh", name);
        return Ok(None);
    }
    if primitive.morph_targets().len() > 0 {
        notes.add("shape keys (morph targets) are ignored, in mesh", name);
    }
    if primitive.get(&Semantic::Colors(0)).is_some() {
        notes.add("vertex colours are ignored, in mesh", name);
    }
    let position = primitive
        .get(&Semantic::Positions)
        .ok_or_else(|| Flaw::new("there are no positions", "export the mesh with its vertex positions"))?;
    let positions = read_vectors(&position, buffers)?;
    let mut normals = match primitive.get(&Semantic::Normals) {
        Some(accessor) => read_vectors(&accessor, buffers)?,
        None => Vec::new(),
    };
    if !normals.is_empty() && normals.len() != positions.len() {
        notes.add("normals do not match the vertices, so shaded flat, in mesh", name);
        normals.clear();
    }
    let indices = match primitive.indices() {
        Some(accessor) => read_indices(&accessor, buffers)?,
        None => (0..u32::try_from(positions.len()).unwrap_or(u32::MAX)).collect(),
    };
    let mut mesh = Mesh { positions, normals, triangles: triangles(primitive.mode(), &indices) };
    let dropped = tidy(&mut mesh)?;
    Ok(Some((mesh, dropped)))
}

/// Triangles of a list, strip or fan, all with the winding of the first (glTF 2.0 §3.7.2.1).
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match (mode, indices) {
        (Mode::TriangleStrip, _) => {
            let corners = indices.windows(3).enumerate().filter_map(|(i, corners)| match *corners {
                [a, b, c] if i % 2 == 0 => Some([a, b, c]),
                [a, b, c] => Some([a, c, b]),
                _ => None,
            });
            corners.collect()
        }
        (Mode::TriangleFan, [hub, rim @ ..]) => {
            let corners = rim.windows(2).filter_map(|edge| match *edge {
                [b, c] => Some([b, c, *hub]),
                _ => None,
            });
            corners.collect()
        }
        _ => indices.as_chunks().0.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_the_winding() {
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3]), [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(triangles(Mode::TriangleFan, &[0, 1, 2, 3]), [[1, 2, 0], [2, 3, 0]]);
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3]), [[0, 1, 2]]);
        assert_eq!(triangles(Mode::TriangleFan, &[]), Vec::<[u32; 3]>::new());
    }
}
