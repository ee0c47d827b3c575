//! One glTF primitive → one triangle mesh.

use gltf::accessor::Dimensions;
use gltf::mesh::{Mode, Semantic};

use super::accessor::Column;
use super::buffers::Buffers;
use super::deform::{Deformation, DeformationKey, MeshPose};
use super::texture::UV_SETS;
use crate::asset::flaw::Flaw;
use crate::asset::notes::Notes;
use crate::asset::tangents::make_tangents;
use crate::asset::tidy::tidy;
use crate::geometry::{Attributes, Mesh};

/// Bytes of surfaces that need no reason.
pub(super) const SMALL: usize = 1 << 20;
/// Most bytes of surfaces per byte of the buffers: a triangle of three indices of a byte each, with its own three
/// vertices, is 28 times as large here, with texture coordinates, colours and tangents 68 times.
pub(super) const MOST_PER_BYTE: usize = 128;

/// The accessors that a surface is made of, by index, and how; primitives with the same ones are the same surface.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct SurfaceKey {
    positions: usize,
    normals: Option<usize>,
    indices: Option<usize>,
    /// Texture coordinates by set, of those that the material looks at.
    uvs: [Option<usize>; UV_SETS],
    colors: Option<usize>,
    tangents: Option<TangentSource>,
    deformation: DeformationKey,
    /// As in the file.
    mode: u32,
}

/// Source of tangents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum TangentSource {
    /// An accessor.
    Read(usize),
    /// A set of texture coordinates, by which they are made.
    Made(usize),
}

/// Attributes that a material asks for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AskedFor {
    /// Sets of texture coordinates.
    pub uv_sets: [bool; UV_SETS],
    /// Tangents, with the set of texture coordinates by which they are made if there are none.
    pub tangents: Option<usize>,
}

/// Source of a primitive of the mesh called `name` in a pose, with the attributes that are asked for; `None` if it has no
/// surface.
pub(super) fn source(
    primitive: &gltf::Primitive,
    AskedFor { uv_sets, tangents }: AskedFor,
    pose: &MeshPose,
    notes: &mut Notes,
    name: &str,
) -> Result<Option<SurfaceKey>, Flaw> {
    if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        notes.add("points and lines have no surface and are ignored, in mesh", name);
        return Ok(None);
    }
    let positions = primitive
        .get(&Semantic::Positions)
        .ok_or_else(|| Flaw::new("there are no positions", "export the mesh with its vertex positions"))?;
    Ok(Some(SurfaceKey {
        positions: positions.index(),
        normals: primitive.get(&Semantic::Normals).map(|accessor| accessor.index()),
        indices: primitive.indices().map(|accessor| accessor.index()),
        uvs: std::array::from_fn(|set| {
            let accessor = primitive.get(&Semantic::TexCoords(set as u32)).filter(|_| uv_sets[set]);
            if uv_sets[set] && accessor.is_none() {
                notes.add("textures without texture coordinates count as their means, in mesh", name);
            }
            Some(accessor?.index())
        }),
        colors: primitive.get(&Semantic::Colors(0)).map(|accessor| accessor.index()),
        tangents: tangents.map(|uv_set| match primitive.get(&Semantic::Tangents) {
            // Without normals, those of the file are not to be used.
            Some(accessor) if primitive.get(&Semantic::Normals).is_some() => {
                TangentSource::Read(accessor.index())
            }
            _ => TangentSource::Made(uv_set),
        }),
        deformation: DeformationKey::new(primitive, pose),
        mode: primitive.mode().as_gl_enum(),
    }))
}

/// Reads the surface of a primitive of the mesh called `name` in a pose, with the attributes that `source` tells, and how
/// many degenerate triangles it had; it may be left without triangles.
pub(super) fn read(
    primitive: &gltf::Primitive,
    source: &SurfaceKey,
    pose: &MeshPose,
    buffers: &Buffers,
    notes: &mut Notes,
    name: &str,
) -> Result<(Mesh, usize), Flaw> {
    let vectors = |semantic| {
        let accessor = primitive.get(&semantic);
        accessor.map(|accessor| Column::of_vectors(&accessor, &[Dimensions::Vec3], buffers)).transpose()
    };
    let positions = vectors(Semantic::Positions)?
        .ok_or_else(|| Flaw::new("there are no positions", "export the mesh with its vertex positions"))?;
    let normals = vectors(Semantic::Normals)?.filter(|normals| {
        let fits = normals.len() == positions.len();
        if !fits {
            notes.add("normals do not match the vertices, so shaded flat, in mesh", name);
        }
        fits
    });
    let indices = match primitive.indices() {
        Some(accessor) => Column::of_indices(&accessor, buffers)?.indices()?,
        None => (0..positions.len_in_full()?).collect(),
    };
    if primitive.mode() == Mode::Triangles && !indices.len().is_multiple_of(3) {
        notes.add("indices left over (their number is not a multiple of 3) are ignored, in mesh", name);
    }
    let mut triangles = triangles(primitive.mode(), &indices);
    let vertices = number_vertices(&mut triangles, positions.len())?;
    let deformation = Deformation::open(primitive, pose, buffers, positions.len())?;
    if vertices.len().saturating_mul(deformation.bytes_of_each()) > SMALL + MOST_PER_BYTE * buffers.size() {
        return Err(Flaw::new(
            "its morph targets and joints are many times larger than the file",
            "the file is damaged: its accessors overlap; export it again",
        ));
    }
    let position = |&vertex: &u32| deformation.position(vertex, positions.vector(vertex));
    let normals = normals.map(|normals| {
        let normal = |&vertex: &u32| deformation.normal(vertex, normals.vector(vertex));
        vertices.iter().map(normal).collect::<Result<_, _>>()
    });
    let mut attribute = |semantic: Semantic, dimensions: &[Dimensions]| {
        let Some(accessor) = primitive.get(&semantic) else { return Ok(None) };
        let column = Column::of_vectors(&accessor, dimensions, buffers)?;
        let fits = column.len() == positions.len();
        if !fits {
            notes.add(
                "texture coordinates, colours or tangents do not match the vertices and are ignored, in mesh",
                name,
            );
        }
        Ok(Some(column).filter(|_| fits))
    };
    let mut attributes = Attributes::default();
    for (set, _) in (0..).zip(source.uvs).filter(|(_, accessor)| accessor.is_some()) {
        if let Some(column) = attribute(Semantic::TexCoords(set), &[Dimensions::Vec2])? {
            attributes.uvs.resize(set as usize + 1, Vec::new());
            attributes.uvs[set as usize] = vertices.iter().map(|&index| column.vector(index)).collect();
        }
    }
    if source.colors.is_some()
        && let Some(column) = attribute(Semantic::Colors(0), &[Dimensions::Vec3, Dimensions::Vec4])?
    {
        let unit = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
        attributes.colors = vertices.iter().map(|&index| column.vector(index).map(unit)).collect();
    }
    let tangents = match source.tangents {
        Some(TangentSource::Read(_)) => attribute(Semantic::Tangents, &[Dimensions::Vec4])?,
        Some(TangentSource::Made(_)) | None => None,
    };
    let mut mesh = Mesh {
        positions: vertices.iter().map(position).collect::<Result<_, _>>()?,
        normals: normals.transpose()?.unwrap_or_default(),
        triangles,
        attributes,
    };
    let dropped = tidy(&mut mesh)?;
    if let Some(column) = tangents {
        let tangent = |&vertex: &u32| deformation.tangent(vertex, column.vector(vertex));
        let tangents: Vec<[f32; 4]> = vertices.iter().map(tangent).collect::<Result<_, _>>()?;
        let of_corner = |vertex: u32| tangents[vertex as usize];
        mesh.attributes.tangents = mesh.triangles.iter().map(|triangle| triangle.map(of_corner)).collect();
    } else if let Some(TangentSource::Made(uv_set)) = source.tangents {
        make_tangents(&mut mesh, uv_set);
    }
    Ok((mesh, dropped))
}

/// Indices of the vertices that are read: all, or those in use if they are few, which the triangles then number anew.
///
/// Many primitives may share one large column, each for a part of it.
fn number_vertices(triangles: &mut [[u32; 3]], count: usize) -> Result<Vec<u32>, Flaw> {
    if let Some(index) = triangles.iter().flatten().find(|index| **index as usize >= count) {
        return Err(Flaw::new(
            format!("vertex index {index} is out of range: there are {count} vertices"),
            "the file is damaged; export it again",
        ));
    }
    if count <= 3 * triangles.len() {
        return Ok((0..count as u32).collect());
    }
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    for index in triangles.iter_mut().flatten() {
        *index = used.partition_point(|vertex| vertex < index) as u32;
    }
    Ok(used)
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

    #[test]
    fn of_a_large_column_only_the_vertices_in_use_are_read() {
        let mut triangles = [[7, 900, 8], [8, 900, 31]];
        assert_eq!(number_vertices(&mut triangles, 1000), Ok(vec![7, 8, 31, 900]));
        assert_eq!(triangles, [[0, 3, 1], [1, 3, 2]]);
        let mut all = [[0, 2, 1]];
        assert_eq!(number_vertices(&mut all, 3), Ok(vec![0, 1, 2]));
        assert!(number_vertices(&mut all, 2).unwrap_err().problem.contains("index 2 is out of range"));
    }
}
