use std::path::PathBuf;

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::*;
use crate::light::Punctual;
use crate::shade::{Lobe, Material};

/// Bytes of the test buffer: four positions, four u16 indices, a sparse index, a sparse value.
fn buffer() -> Vec<u8> {
    let positions = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 3].iter().flat_map(|index| index.to_le_bytes()));
    bytes.extend([2, 0, 0, 0]);
    bytes.extend([0f32, 5.0, 0.0].iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

fn document() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "square", "children": [1] }, { "camera": 0, "name": "eye" }],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "mode": 5 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 4, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 8 },
            { "buffer": 0, "byteOffset": 56, "byteLength": 4 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 12 },
        ],
        "buffers": [{ "uri": "the%20buffer.bin", "byteLength": 72 }],
    })
}

struct Files {
    folder: tempfile::TempDir,
}

impl Files {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("the buffer.bin"), buffer()).unwrap();
        Self { folder }
    }

    fn load(&self, text: &[u8]) -> Result<Model, AssetError> {
        let path: PathBuf = self.folder.path().join("a.gltf");
        std::fs::write(&path, text).unwrap();
        load(&path, &crate::asset::Files::default())
    }
}

fn load_json(document: &Value) -> Result<Model, AssetError> {
    Files::new().load(document.to_string().as_bytes())
}

/// The document with the value at a JSON pointer replaced; a new key is added.
fn with(pointer: &str, value: Value) -> Value {
    let mut document = document();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match document.pointer_mut(parent).unwrap() {
        Value::Array(entries) => entries[key.parse::<usize>().unwrap()] = value,
        parent => parent[key] = value,
    }
    document
}

fn glb(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + text.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", text.as_slice()), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

#[test]
fn a_strip_with_a_nested_camera_is_read() {
    let model = load_json(&document()).unwrap();
    assert_eq!(model.meshes[0].triangles, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(model.meshes[0].positions[3], [1.0, 1.0, 0.0]);
    assert_eq!(model.nodes[1].parent, Some(0));
    assert_eq!(model.nodes[1].lens, Some(Lens { vertical_fov: 0.5 }));
    assert_eq!(model.materials, [Material::default()]);
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
}

#[test]
fn a_binary_file_reads_like_the_text_one() {
    let mut binary = document();
    binary["buffers"] = json!([{ "byteLength": 72 }]);
    let model = Files::new().load(&glb(&binary, &buffer())).unwrap();
    assert_eq!(model.meshes, load_json(&document()).unwrap().meshes);
}

#[test]
fn sparse_values_replace_those_of_the_view() {
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": 2, "componentType": 5121 },
        "values": { "bufferView": 3 },
    });
    let model = load_json(&with("/accessors/0/sparse", sparse)).unwrap();
    assert_eq!(model.meshes[0].positions[2], [0.0, 5.0, 0.0]);
}

#[test]
fn bytes_and_missing_indices_work() {
    let bytes = json!({ "bufferView": 2, "componentType": 5121, "count": 4, "type": "SCALAR" });
    let message = load_json(&with("/accessors/1", bytes)).unwrap_err().to_string();
    assert!(message.contains("no triangle with an area is left of 2"), "{message}");
    let primitive = json!({ "attributes": { "POSITION": 0 }, "mode": 6 });
    let model = load_json(&with("/meshes/0/primitives/0", primitive)).unwrap();
    assert_eq!(model.meshes[0].triangles, [[1, 2, 0], [2, 3, 0]]);
}

#[test]
fn nodes_that_share_a_mesh_share_it_here() {
    let mut shared = document();
    shared["nodes"][0]["children"] = json!([1, 2]);
    shared["nodes"].as_array_mut().unwrap().push(json!({ "mesh": 0, "translation": [1, 2, 3] }));
    let model = load_json(&shared).unwrap();
    assert_eq!(model.meshes.len(), 1);
    assert_eq!(model.nodes[0].parts, model.nodes[2].parts);
}

#[test]
fn materials_become_the_nearest_lobe_and_say_so() {
    let mut shiny = document();
    shiny["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_materials_specular"]);
    shiny["extensionsRequired"] = json!(["KHR_lights_punctual", "KHR_texture_transform"]);
    shiny["materials"] = json!([
        { "name": "mirror", "pbrMetallicRoughness": { "roughnessFactor": 0, "baseColorFactor": [0.9, 0.8, 0.7, 1] } },
        { "name": "glass", "pbrMetallicRoughness": { "roughnessFactor": 0, "metallicFactor": 0 },
          "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_ior": { "ior": 1.45 } } },
        { "name": "lamp", "emissiveFactor": [1, 0.5, 0], "doubleSided": true,
          "pbrMetallicRoughness": { "metallicFactor": 0 },
          "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4 },
                          "KHR_materials_specular": { "specularFactor": 0 } } },
        { "name": "brass" },
    ]);
    let model = load_json(&shiny).unwrap();
    let lobes: Vec<Lobe> = model.materials.iter().map(|material| material.lobe).collect();
    assert_eq!(lobes[0], Lobe::Mirror { reflectance: Vec3::new(0.9, 0.8, 0.7) });
    assert_eq!(lobes[1], Lobe::Dielectric { ior: 1.45, tint: Vec3::ONE });
    assert_eq!(model.materials[2].emission, Vec3::new(4.0, 2.0, 0.0));
    assert!(model.materials[2].emits_both_sides && !model.materials[0].emits_both_sides);
    let warnings: Vec<&str> =
        model.warnings.iter().map(|line| line.split_once("gltf: ").unwrap().1).collect();
    assert_eq!(warnings, ["rough metal becomes diffuse, in material: brass"]);
}

/// The document with this light at its second node, `eye`.
fn lit(light: Value) -> Value {
    let mut document = with("/nodes/1/extensions", json!({ "KHR_lights_punctual": { "light": 0 } }));
    document["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
    document["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    document
}

#[test]
fn lights_shine_along_minus_z_of_their_node() {
    let read = |light| {
        let model = load_json(&lit(light)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((model.nodes[0].light, model.warnings), (None, Vec::new()));
        model.nodes[1].light
    };
    let (position, direction) = (DVec3::ZERO, DVec3::NEG_Z);
    let intensity = Vec3::new(2.0, 1.0, 0.0);
    let point = json!({ "type": "point", "color": [1, 0.5, 0], "intensity": 2 });
    assert_eq!(read(point), Some(Punctual::Point { position, intensity }));
    let sun = json!({ "type": "directional" });
    assert_eq!(read(sun), Some(Punctual::Distant { direction, irradiance: Vec3::ONE }));
    let spot =
        json!({ "type": "spot", "color": [1, 0.5, 0], "intensity": 2, "spot": { "innerConeAngle": 0.25 } });
    // The default of the outer angle is π/4, in f32.
    let (cos_inner, cos_outer) = (0.25f64.cos(), f64::from(std::f32::consts::FRAC_PI_4).cos());
    assert_eq!(read(spot), Some(Punctual::Spot { position, direction, intensity, cos_inner, cos_outer }));
    let half_space = json!({ "innerConeAngle": std::f64::consts::FRAC_PI_2, "outerConeAngle": std::f64::consts::FRAC_PI_2 });
    assert!(read(json!({ "type": "spot", "spot": half_space })).is_some());
}

#[test]
fn the_range_of_a_light_is_ignored_with_a_note() {
    let model = load_json(&lit(json!({ "type": "point", "name": "bulb", "range": 3 }))).unwrap();
    assert!(model.nodes[1].light.is_some());
    assert!(
        model.warnings[0].ends_with("range is ignored, light reaches everywhere, of light: bulb"),
        "{:?}",
        model.warnings
    );
}

#[test]
fn malformed_lights_are_errors_that_name_node_and_light() {
    let spot = |inner: f64, outer: f64| json!({ "type": "spot", "name": "bulb", "spot": { "innerConeAngle": inner, "outerConeAngle": outer } });
    for (light, expected) in [
        (
            json!({ "type": "point", "name": "bulb", "intensity": -1 }),
            "intensity must be finite and not negative, but is -1",
        ),
        (json!({ "type": "point", "name": "bulb", "intensity": 1e300 }), "intensity must be finite"),
        (
            json!({ "type": "directional", "name": "bulb", "color": [1, -0.5, 1] }),
            "colour must be finite and not negative",
        ),
        (spot(0.5, 0.4), "angles must be 0 ≤ inner ≤ outer ≤ π/2, but are 0.5 and 0.4"),
        (spot(-0.1, 0.4), "but are -0.1 and 0.4"),
        (spot(0.1, 1.6), "but are 0.1 and 1.6"),
    ] {
        let message = load_json(&lit(light)).unwrap_err().to_string();
        assert!(message.contains("node `eye`: light `bulb`: ") && message.contains(expected), "{message}");
        assert!(message.contains("help: "), "{message}");
    }
    for (light, expected) in [
        (json!({ "type": "area" }), "Invalid value"),
        (json!({ "type": "spot" }), "Missing data"),
        (json!({}), "missing field `type`"),
    ] {
        let message = load_json(&lit(light)).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
    let lights = json!({ "KHR_lights_punctual": { "light": 0 } });
    let message = load_json(&with("/nodes/1/extensions", lights)).unwrap_err().to_string();
    assert!(message.contains("Index out of bounds"), "{message}");
}

#[test]
fn malformed_files_are_errors_that_say_what_is_wrong() {
    let huge = json!(u64::MAX);
    for (pointer, value, expected) in [
        ("/meshes/0/primitives/0/attributes/POSITION", json!(7), "accessor 7, but there are 2"),
        ("/meshes/0/primitives/0/indices", json!(0), "accessor 0 does not hold indices"),
        ("/meshes/0/primitives/0/attributes/NORMAL", json!(1), "does not hold 3-vectors"),
        ("/meshes/0/primitives/0/attributes", json!({}), "Missing data"),
        ("/accessors/0/count", json!(5), "reaches beyond its buffer view"),
        ("/accessors/0/count", huge.clone(), "reaches beyond its buffer view"),
        ("/accessors/0/count", json!(3), "vertex index 3 is out of range: there are 3 vertices"),
        ("/accessors/0/byteOffset", huge.clone(), "reaches beyond its buffer view"),
        ("/accessors/0/componentType", json!(1), "Invalid value"),
        ("/accessors/0/bufferView", json!(9), "Index out of bounds"),
        ("/bufferViews/0/byteLength", huge, "reaches beyond its buffer"),
        ("/buffers/0/byteLength", json!(73), "has 72 bytes instead of 73"),
        ("/buffers/0/uri", json!("gone.bin"), "gone.bin cannot be read"),
        ("/buffers/0/uri", json!("data:text/plain,hello"), "not base64"),
        ("/nodes/1/children", json!([0]), "reached twice"),
        ("/nodes/0/children", json!([0]), "reached twice"),
        ("/nodes/0/rotation", json!([0, 0, 0, 0]), "not a quaternion"),
        ("/nodes/0/translation", json!([1e300, 0, 0]), "not finite"),
        ("/extensionsRequired", json!(["KHR_draco_mesh_compression"]), "KHR_draco_mesh_compression"),
    ] {
        match load_json(&with(pointer, value.clone())) {
            Ok(_) => panic!("{pointer} = {value} is accepted"),
            Err(error) => {
                let message = error.to_string();
                assert!(message.contains(expected), "{pointer} = {value}: {message}");
                assert!(message.contains("help: "), "{message}");
            }
        }
    }
}

#[test]
fn vertices_that_are_not_finite_are_errors() {
    let files = Files::new();
    for value in [f32::NAN, f32::INFINITY] {
        let mut bytes = buffer();
        bytes[12..16].copy_from_slice(&value.to_le_bytes());
        std::fs::write(files.folder.path().join("the buffer.bin"), bytes).unwrap();
        let message = files.load(document().to_string().as_bytes()).unwrap_err().to_string();
        assert!(message.contains("primitive 0: vertex 1 is not finite"), "{message}");
    }
}

#[test]
fn cut_and_corrupted_files_never_panic() {
    let files = Files::new();
    let mut binary = lit(json!({ "type": "spot", "spot": {} }));
    binary["buffers"] = json!([{ "byteLength": 72 }]);
    let whole = glb(&binary, &buffer());
    for length in 0..whole.len() {
        assert!(files.load(&whole[..length]).is_err(), "cut to {length} bytes");
    }
    for index in 0..whole.len() {
        for byte in [0, b'9', b'-', 255] {
            let mut corrupted = whole.clone();
            corrupted[index] = byte;
            let _ = files.load(&corrupted);
        }
    }
}
