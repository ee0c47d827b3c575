//! Instances of a node's mesh (`EXT_mesh_gpu_instancing`).

use glam::DAffine3;
use gltf::accessor::Dimensions;

use super::accessor::Column;
use super::buffers::Buffers;
use super::transform;
use crate::asset::flaw::Flaw;

pub(super) const EXTENSION: &str = "EXT_mesh_gpu_instancing";
/// Instances that need no reason; for each beyond them the buffers have a byte at least.
const SMALL: usize = 1 << 12;
/// Memory of an instance: as a node, as an entity and in the search tree.
const INSTANCE_BYTES: u64 = 1 << 10;

/// Most instances that a file may have.
pub(super) fn most(buffers: &Buffers) -> usize {
    let fitting = buffers.memory().left().map_or(u64::MAX, |left| left / INSTANCE_BYTES);
    (SMALL + buffers.size()).min(u32::try_from(fitting).unwrap_or(u32::MAX) as usize)
}

/// Space of each instance → the node's, of at most `left` instances; `None` if the node places its mesh once.
pub(super) fn placements(
    gltf: &gltf::Gltf,
    node: &gltf::Node,
    buffers: &Buffers,
    left: usize,
) -> Result<Option<Vec<DAffine3>>, Flaw> {
    let Some(extension) = node.extension_value(EXTENSION) else { return Ok(None) };
    let column = |key: &str, dimensions: Dimensions| {
        let Some(index) = extension.get("attributes").and_then(|attributes| attributes.get(key)) else {
            return Ok(None);
        };
        let index_of = index.as_u64().and_then(|index| usize::try_from(index).ok());
        let accessor = index_of.and_then(|index| gltf.accessors().nth(index)).ok_or_else(|| {
            let problem = format!("{key} of the instances is accessor {index}, which does not exist");
            Flaw::new(problem, "the file is damaged; export it again")
        })?;
        let column = Column::of_vectors(&accessor, &[dimensions], buffers);
        column.map(Some).map_err(|flaw| flaw.at(format!("{key} of the instances")))
    };
    let translations = column("TRANSLATION", Dimensions::Vec3)?;
    let rotations = column("ROTATION", Dimensions::Vec4)?;
    let scales = column("SCALE", Dimensions::Vec3)?;
    let mut counts = [&translations, &rotations, &scales].into_iter().flatten().map(Column::len);
    let Some(count) = counts.next() else { return Ok(None) };
    if let Some(other) = counts.find(|other| *other != count) {
        return Err(Flaw::new(
            format!(
                "translations, rotations and scales of the instances differ in number: {count} and {other}"
            ),
            "the file is damaged; export it again",
        ));
    }
    if count > left {
        return Err(Flaw::new(
            format!(
                "its {count} instances are more than memory and the size of the buffers leave room for ({left})"
            ),
            "place fewer of them, or allow more memory with --max-memory; if the file should be small, it is damaged",
        ));
    }
    let placement = |index: u32| {
        let translation = translations.as_ref().map_or([0.0; 3], |column| column.vector(index));
        let rotation = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |column| column.vector(index));
        let scale = scales.as_ref().map_or([1.0; 3], |column| column.vector(index));
        transform::of_parts(translation, rotation, scale).map_err(|flaw| flaw.at(format!("instance {index}")))
    };
    (0..count as u32).map(placement).collect::<Result<_, _>>().map(Some)
}
