//! Parsing and structural checks, after which the `gltf` crate's accessors cannot panic.

use gltf::json::validation::{Error as Invalid, Validate};
use gltf::json::{Path as JsonPath, Root};

use crate::asset::error::Flaw;

/// Bytes of a GLB header: magic, version, length.
const GLB_HEADER: usize = 12;

/// Required extensions without which the geometry is still known.
const HARMLESS: [&str; 4] =
    ["KHR_lights_punctual", "EXT_mesh_gpu_instancing", "KHR_mesh_quantization", "KHR_node_visibility"];
/// Families of such extensions.
const HARMLESS_PREFIXES: [&str; 3] = ["KHR_materials_", "KHR_texture_", "EXT_texture_"];

/// Parses a `.gltf` or `.glb` and checks its structure.
///
/// Two things that the crate's own validation rejects are let through: required extensions that change only what is
/// ignored anyway, and positions without bounds.
pub(super) fn parse(bytes: &[u8]) -> Result<gltf::Gltf, Flaw> {
    check_glb_header(bytes)?;
    let gltf = gltf::Gltf::from_slice_without_validation(bytes)
        .map_err(|error| Flaw::new(format!("not a glTF 2.0 file: {error}"), "export the file again"))?;
    let root = gltf.document.as_json();
    check_extensions(root)?;
    check_positions(root)?;
    let mut first = None;
    root.validate(root, JsonPath::new, &mut |path, error| {
        let path = path();
        if first.is_none() && !tolerated(path.as_str(), error) {
            first = Some(Flaw::new(format!("{error} at `{path}`"), "the file is damaged; export it again"));
        }
    });
    first.map_or(Ok(gltf), Err)
}

fn tolerated(path: &str, error: Invalid) -> bool {
    let bounds = path.ends_with(".min") || path.ends_with(".max");
    error == Invalid::Unsupported || (error == Invalid::Missing && bounds)
}

/// The crate subtracts the header's size from the length it reads.
fn check_glb_header(bytes: &[u8]) -> Result<(), Flaw> {
    if !bytes.starts_with(b"glTF") {
        return Ok(());
    }
    let length = bytes.get(8..GLB_HEADER).and_then(|field| field.try_into().ok()).map(u32::from_le_bytes);
    let complete = length.is_some_and(|length| {
        let length = length as usize;
        length >= GLB_HEADER && length <= bytes.len()
    });
    complete.then_some(()).ok_or_else(|| {
        Flaw::new(
            format!("the file is cut off: it has {} bytes and its header promises more", bytes.len()),
            "copy or export the file again",
        )
    })
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
