//! Structural checks, after which the `gltf` crate's accessors cannot panic.

use gltf::json::validation::{Error as Invalid, Validate};
use gltf::json::{Path as JsonPath, Root};

use crate::asset::flaw::Flaw;

/// Required extensions without which the geometry is still known.
const HARMLESS: [&str; 4] =
    ["KHR_lights_punctual", "EXT_mesh_gpu_instancing", "KHR_mesh_quantization", "KHR_node_visibility"];
/// Families of such extensions.
const HARMLESS_PREFIXES: [&str; 3] = ["KHR_materials_", "KHR_texture_", "EXT_texture_"];

/// Checks the structure of a document.
///
/// Parts that are unread, or read with care, may be wrong: animations, samplers, skins, bounds of accessors, targets of
/// buffer views. Cameras without a lens and extensions that change only what is ignored anyway are let through as well.
/// Of what is read, the crate's accessors unwrap
///
/// - enumerations, the keys of attributes, indices of accessors, buffer views, cameras, images, lights, materials,
///   meshes, nodes, scenes, skins and textures, and the cone of a spot light: which its validation checks;
/// - `Camera::projection` the lens, and `Image::source` a media type or an address, which nothing checks: both are
///   read from the JSON instead.
pub(super) fn check(root: &Root) -> Result<(), Flaw> {
    check_extensions(root)?;
    check_positions(root)?;
    let mut first = None;
    root.validate(root, JsonPath::new, &mut |path, error| {
        let path = path();
        if first.is_none() && !tolerated(path.as_str(), error) {
            first = Some(Flaw::new(format!("{error} at `{path}`"), "the file is damaged; export it again"));
        }
    });
    first.map_or(Ok(()), Err)
}

fn tolerated(path: &str, error: Invalid) -> bool {
    let harmless = ["animations[", "samplers[", "skins["].iter().any(|start| path.starts_with(start))
        || [".min", ".max", ".target"].iter().any(|end| path.ends_with(end));
    let lens = path.starts_with("cameras[") && path.ends_with(']');
    harmless || error == Invalid::Unsupported || (error == Invalid::Missing && lens)
}

fn check_extensions(root: &Root) -> Result<(), Flaw> {
    let harmless = |name: &str| {
        HARMLESS.contains(&name) || HARMLESS_PREFIXES.iter().any(|prefix| name.starts_with(prefix))
    };
    match root.extensions_required.iter().find(|name| !harmless(name)) {
        None => Ok(()),
        Some(name) => Err(Flaw::new(
            format!("requires the extension {name}, which is not supported"),
            "export without it (for instance without mesh compression)",
        )),
    }
}

/// The crate's validation looks up position accessors before it has checked their index.
fn check_positions(root: &Root) -> Result<(), Flaw> {
    for (index, mesh) in root.meshes.iter().enumerate() {
        let mut accessors = mesh.primitives.iter().flat_map(|primitive| primitive.attributes.values());
        if let Some(accessor) = accessors.find(|accessor| accessor.value() >= root.accessors.len()) {
            return Err(Flaw::new(
                format!(
                    "mesh {index} uses accessor {}, but there are {}",
                    accessor.value(),
                    root.accessors.len()
                ),
                "the file is damaged; export it again",
            ));
        }
    }
    Ok(())
}
