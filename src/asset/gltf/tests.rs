use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::texture::TextureInfo;
use super::*;
use crate::asset::image::Encoding;
use crate::light::Punctual;
use crate::shade::{Dielectric, Diffuse, Lobe, Material, Principled};

mod animation;
mod deform;
mod instancing;

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

struct GltfFolder {
    folder: tempfile::TempDir,
}

impl GltfFolder {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("the buffer.bin"), buffer()).unwrap();
        Self { folder }
    }

    fn load(&self, text: &[u8]) -> Result<Model, AssetError> {
        self.load_at(text, 0.0)
    }

    fn load_at(&self, text: &[u8], time: f64) -> Result<Model, AssetError> {
        let path: PathBuf = self.folder.path().join("a.gltf");
        std::fs::write(&path, text).unwrap();
        load(&path, &crate::asset::Files::default(), time)
    }
}

fn load_json(document: &Value) -> Result<Model, AssetError> {
    GltfFolder::new().load(document.to_string().as_bytes())
}

/// The only warning, without the file's name.
fn one_line(document: &Value) -> String {
    let warnings = load_json(document).unwrap_or_else(|error| panic!("{error}")).warnings;
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    warnings[0].split_once("gltf: ").unwrap().1.to_owned()
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
    glb_of(&[(b"JSON", text.as_slice()), (b"BIN\0", binary)])
}

fn glb_of(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let length: usize = chunks.iter().map(|(_, chunk)| 8 + chunk.len()).sum();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((12 + length as u32).to_le_bytes());
    for (kind, chunk) in chunks {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(*kind);
        bytes.extend(*chunk);
    }
    bytes
}

#[test]
fn a_strip_with_a_nested_camera_is_read() {
    let model = load_json(&document()).unwrap();
    assert_eq!(model.meshes[0].triangles, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(model.meshes[0].positions[3], [1.0, 1.0, 0.0]);
    assert_eq!(model.nodes[1].parent, Some(0));
    assert_eq!(
        model.nodes[1].camera,
        Some(ModelCamera { view: ModelView::Perspective { vertical_fov: 0.5 }, aspect: None })
    );
    assert_eq!(model.materials, [Material::default()]);
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
}

#[test]
fn a_binary_file_reads_like_the_text_one() {
    let mut binary = document();
    binary["buffers"] = json!([{ "byteLength": 72 }]);
    let model = GltfFolder::new().load(&glb(&binary, &buffer())).unwrap();
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
    let mut model = with("/accessors/1", bytes);
    model["meshes"][0]["primitives"][0]["mode"] = json!(4);
    model["accessors"][1]["count"] = json!(3);
    model["bufferViews"][2] = json!({ "buffer": 0, "byteOffset": 48, "byteLength": 3 });
    assert_eq!(one_line(&model), "surfaces without area (collapsed or empty) are left out, in mesh: mesh 0");
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
          "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_ior": { "ior": 1.45 },
                          "KHR_materials_volume": { "thicknessFactor": 1 } } },
        { "name": "lamp", "emissiveFactor": [1, 0.5, 0], "doubleSided": true,
          "pbrMetallicRoughness": { "metallicFactor": 0 },
          "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4 },
                          "KHR_materials_specular": { "specularFactor": 0 } } },
        { "name": "brass" },
        { "name": "lacquer", "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": 2, "clearcoatRoughnessFactor": 0.25 } } },
        { "name": "sign", "pbrMetallicRoughness": { "baseColorFactor": [1, 0.5, 0, 1] }, "extensions": { "KHR_materials_unlit": {} } },
        { "name": "pane", "pbrMetallicRoughness": { "metallicFactor": 0 },
          "extensions": { "KHR_materials_transmission": { "transmissionFactor": 0.5 },
                          "KHR_materials_volume": { "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0] } } },
        { "name": "water", "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 },
          "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 },
                          "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0] } } },
    ]);
    let model = load_json(&shiny).unwrap();
    let lobes: Vec<Lobe> = model.materials.iter().map(|material| material.lobe).collect();
    let metal = Principled { metallic: 1.0, ..Principled::PLAIN };
    let base = Vec3::new(0.9, 0.8, 0.7);
    assert_eq!(lobes[0], Lobe::Principled(Principled { roughness: 0.0, base, ..metal }));
    assert_eq!(lobes[1], Lobe::Dielectric(Dielectric { ior: 1.45, tint: Vec3::ONE }));
    assert_eq!(model.materials[2].emission, Vec3::new(4.0, 2.0, 0.0));
    assert!(model.materials[2].emits_both_sides && !model.materials[0].emits_both_sides);
    let warnings: Vec<&str> =
        model.warnings.iter().map(|line| line.split_once("gltf: ").unwrap().1).collect();
    assert_eq!(lobes[2], Lobe::Diffuse(Diffuse { albedo: Vec3::ONE }));
    assert_eq!(lobes[3], Lobe::Principled(metal));
    let coat = Principled { clearcoat: 1.0, clearcoat_roughness: 0.25, ..metal };
    assert_eq!(lobes[4], Lobe::Principled(coat));
    let sign = &model.materials[5];
    let black = Lobe::Diffuse(Diffuse { albedo: Vec3::ZERO });
    assert_eq!((sign.lobe, sign.emission), (black, Vec3::new(1.0, 0.5, 0.0)));
    let pane = Principled { transmission: 0.5, is_thin: true, ..Principled::PLAIN };
    assert_eq!((lobes[6], model.materials[6].attenuation), (Lobe::Principled(pane), Vec3::ZERO));
    let dims = model.materials[7].attenuation;
    assert_eq!((dims.x, lobes[7].ior()), (0.0, Some(1.5)));
    assert!((dims.y - 0.5 * 2f32.ln()).abs() < 1e-6 && dims.z > 40.0 && dims.is_finite(), "{dims}");
    assert_eq!(
        warnings,
        [
            "numbers outside of what the format allows are clamped, in material: lacquer",
            "glass without KHR_materials_volume is a wall without thickness, light is not bent, in material: pane",
        ]
    );
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
        ("/buffers/0/byteLength", json!(73), "buffer 0: it has 72 bytes instead of 73"),
        ("/buffers/0/uri", json!("gone.bin"), "gone.bin cannot be read"),
        ("/buffers/0/uri", json!("https://example.org/a.bin"), "https://example.org/a.bin is an address"),
        ("/buffers/0/uri", json!("data:text/plain,hello"), "buffer 0: it has 5 bytes instead of 72"),
        ("/buffers/0/uri", json!("data:;base64,a-b"), "buffer 0: the data URI is not base64"),
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
    let files = GltfFolder::new();
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
    let files = GltfFolder::new();
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

#[test]
fn containers_are_read_as_people_have_them() {
    let files = GltfFolder::new();
    let meshes = load_json(&document()).unwrap().meshes;
    let text = document().to_string();
    for wrapped in [format!("\u{feff}{text}"), format!("{text}\0\0\r\n")] {
        assert_eq!(files.load(wrapped.as_bytes()).unwrap_or_else(|error| panic!("{error}")).meshes, meshes);
    }
    let mut latin = text.replace("square", "caf#").into_bytes();
    let at = latin.iter().position(|byte| *byte == b'#').unwrap();
    latin[at] = 0xe9;
    assert_eq!(files.load(&latin).unwrap().nodes[0].name, "caf\u{fffd}");

    let mut binary = document();
    binary["buffers"] = json!([{ "byteLength": 72 }]);
    let mut json = format!("\u{feff}{binary}").into_bytes();
    json.resize(json.len().next_multiple_of(4), 0);
    let bin = buffer();
    let unknown: (&[u8; 4], &[u8]) = (b"EXTR", b"whatever");
    for chunks in [
        vec![(b"JSON", json.as_slice()), (b"BIN\0", &bin), unknown],
        vec![(b"JSON", json.as_slice()), unknown, (b"BIN\0", &bin)],
        vec![unknown, (b"JSON", json.as_slice()), (b"BIN\0", &bin)],
    ] {
        let mut glb = glb_of(&chunks);
        assert_eq!(files.load(&glb).unwrap().meshes, meshes);
        glb.extend(b"trailing");
        assert_eq!(files.load(&glb).unwrap().meshes, meshes);
    }
}

#[test]
fn files_that_are_no_gltf_2_say_what_they_are() {
    let utf16: Vec<u8> = "\u{feff}{}".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let mut old = glb(&document(), &[]);
    old[4] = 1;
    for (bytes, expected) in [
        (utf16, "UTF-16"),
        (b"\xef\xbb\xbf \0".to_vec(), "the file is empty"),
        (old, "GLB version 1 cannot be read"),
        (glb_of(&[(b"BIN\0", &[])]), "no JSON chunk"),
        (b"glTF\x02".to_vec(), "cut off"),
    ] {
        let message = GltfFolder::new().load(&bytes).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn names_with_percent_signs_are_looked_for_as_they_stand_too() {
    let files = GltfFolder::new();
    std::fs::write(files.folder.path().join("half%20full%41.bin"), buffer()).unwrap();
    std::fs::create_dir(files.folder.path().join("sub")).unwrap();
    std::fs::write(files.folder.path().join("sub/a.bin"), buffer()).unwrap();
    for name in ["half%20full%41.bin", "the%20buffer.bin", "the buffer.bin", "sub/a.bin", "sub\\a.bin"] {
        let model = files.load(with("/buffers/0/uri", json!(name)).to_string().as_bytes());
        assert_eq!(model.unwrap_or_else(|error| panic!("{error}")).meshes.len(), 1, "{name}");
    }
    let message = files
        .load(with("/buffers/0/uri", json!("a%20b.bin")).to_string().as_bytes())
        .unwrap_err()
        .to_string();
    assert!(message.contains("a b.bin cannot be read") && message.contains("a%20b.bin cannot"), "{message}");
}

#[test]
fn indices_left_over_are_said() {
    let list = with("/meshes/0/primitives/0/mode", json!(4));
    assert_eq!(load_json(&list).unwrap().meshes[0].triangles, [[0, 1, 2]]);
    assert!(one_line(&list).starts_with("indices left over"), "{}", one_line(&list));
}

#[test]
fn surfaces_without_area_are_left_out_and_the_rest_stays() {
    let mut model = with("/meshes/0/name", json!("card"));
    model["bufferViews"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "buffer": 0, "byteOffset": 63, "byteLength": 3 }));
    let collapsed = json!({ "bufferView": 4, "componentType": 5121, "count": 3, "type": "SCALAR" });
    model["accessors"].as_array_mut().unwrap().push(collapsed);
    let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 2 });
    model["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    assert_eq!(load_json(&model).unwrap().nodes[0].parts.len(), 1);
    assert_eq!(one_line(&model), "surfaces without area (collapsed or empty) are left out, in mesh: card");
}

#[test]
fn cameras_without_a_lens_are_left_out_by_name() {
    let without = "cameras without a lens (`perspective` or `orthographic`) are ignored: eye";
    let strange = "cameras whose field of view makes no sense are ignored: eye";
    let perspective = |yfov: f64| json!({ "yfov": yfov, "znear": 0.1 });
    let orthographic = |xmag: f64, ymag: f64| json!({ "xmag": xmag, "ymag": ymag, "zfar": 1, "znear": 0 });
    for (camera, expected) in [
        (json!({ "type": "perspective" }), without),
        (json!({ "type": "perspective", "orthographic": orthographic(1.0, 1.0) }), without),
        (json!({ "type": "orthographic" }), without),
        (json!({ "type": "orthographic", "perspective": perspective(0.5) }), without),
        (json!({ "type": "perspective", "perspective": perspective(0.0) }), strange),
        (json!({ "type": "perspective", "perspective": perspective(4.0) }), strange),
        (json!({ "type": "orthographic", "orthographic": orthographic(1.0, 0.0) }), strange),
        (json!({ "type": "orthographic", "orthographic": orthographic(1.0, 1e30) }), strange),
    ] {
        let model = with("/cameras/0", camera);
        assert_eq!(one_line(&model), expected);
        assert_eq!(load_json(&model).unwrap().nodes[1].camera, None);
    }
}

#[test]
fn orthographic_cameras_see_twice_their_magnitudes() {
    let lens = json!({ "xmag": 3.0, "ymag": 2.0, "zfar": 100, "znear": 0.1 });
    let model =
        load_json(&with("/cameras/0", json!({ "type": "orthographic", "orthographic": lens }))).unwrap();
    let view = ModelView::Orthographic { half_height: 2.0 };
    assert_eq!(model.nodes[1].camera, Some(ModelCamera { view, aspect: Some(1.5) }));
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
}

#[test]
fn the_aspect_ratio_of_a_camera_is_read_if_it_makes_sense() {
    let aspect = |ratio: f64| {
        let lens = json!({ "yfov": 0.5, "znear": 0.1, "aspectRatio": ratio });
        load_json(&with("/cameras/0/perspective", lens)).unwrap()
    };
    assert_eq!(aspect(1.5).nodes[1].camera.unwrap().aspect, Some(1.5));
    for ratio in [0.0, -1.0, 1e30, 1e300] {
        let model = aspect(ratio);
        assert_eq!(model.nodes[1].camera.unwrap().aspect, None);
        assert!(model.warnings[0].ends_with("aspect ratio that makes no sense is ignored, of camera: eye"));
    }
}

#[test]
fn emission_is_a_bounded_factor_on_its_texture() {
    let files = GltfFolder::new();
    let picture = image::RgbImage::from_fn(8, 8, |x, y| image::Rgb([if x + y == 0 { 255 } else { 0 }; 3]));
    picture.save(files.folder.path().join("lights.png")).unwrap();
    let mut model = document();
    model["images"] = json!([{ "uri": "lights.png" }, { "uri": "lights.png" }, { "uri": "gone.png" }]);
    model["textures"] = json!([{ "source": 0 }, { "source": 1 }, { "source": 2 }, {}]);
    let emissive = |texture: usize, factor: f64| {
        json!({ "name": format!("lamp {texture}"), "emissiveFactor": [factor, 0, 0],
                "pbrMetallicRoughness": { "metallicFactor": 0 },
                "extensions": { "KHR_materials_specular": { "specularFactor": 0 } },
                "emissiveTexture": { "index": texture } })
    };
    model["materials"] =
        json!([emissive(0, 2.0), emissive(1, 1.0), emissive(2, 1.0), emissive(3, 3.4e38), emissive(2, 0.0)]);
    let read = files.load(model.to_string().as_bytes()).unwrap();
    let red: Vec<f32> = read.materials.iter().map(|material| material.emission.x).collect();
    assert_eq!(red[..5], [2.0, 1.0, 1.0, 1e18, 0.0]);
    let maps: Vec<bool> = read.materials.iter().map(|material| material.maps.emission.is_some()).collect();
    assert_eq!(maps[..5], [true, true, false, false, false]);
    // One image, which two textures look at.
    assert!(read.textures.len() == 2 && Arc::ptr_eq(&read.textures[0].image, &read.textures[1].image));
    let all = read.warnings.join("\n");
    assert!(!all.contains("lamp 0") && !all.contains("lamp 1"), "{all}");
    assert!(all.contains("gone.png cannot be read") && all.contains("above 1e18 is clamped"), "{all}");
}

#[test]
fn images_of_one_source_are_decoded_once() {
    let files = GltfFolder::new();
    std::fs::write(files.folder.path().join("bad.png"), b"not a picture").unwrap();
    let mut model = document();
    model["images"] = json!([{ "uri": "bad.png" }]);
    model["textures"] = json!([{ "source": 0 }]);
    let material = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } });
    model["materials"] = json!(vec![material; 50]);
    let path = files.folder.path().join("a.gltf");
    std::fs::write(&path, model.to_string()).unwrap();
    let gltf = container::open(std::fs::read(&path).unwrap()).unwrap();
    let opened = crate::asset::Files::default();
    let buffers = Buffers::read(&gltf, files.folder.path(), &opened).unwrap();
    let mut textures = Textures::new(&gltf, &buffers);
    let texture = gltf.textures().next().unwrap();
    let read = |textures: &mut Textures| {
        let info = TextureInfo::moved(texture.clone(), 0, None);
        textures.read(&info, Encoding::Color)
    };
    assert!(read(&mut textures).is_err());
    std::fs::remove_file(files.folder.path().join("bad.png")).unwrap();
    let again = read(&mut textures).unwrap_err();
    assert!(!again.contains("cannot be read"), "{again}");
}

#[test]
fn a_huge_sparse_column_costs_what_is_used_of_it() {
    let mut model = document();
    model["accessors"][0] = json!({
        "componentType": 5126, "count": 1u32 << 30, "type": "VEC3",
        "sparse": {
            "count": 1,
            "indices": { "bufferView": 2, "componentType": 5121 },
            "values": { "bufferView": 3 },
        },
    });
    let read = load_json(&model).unwrap();
    assert!(read.meshes.is_empty(), "all but one vertex is 0");
    model["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    let message = load_json(&model).unwrap_err().to_string();
    assert!(message.contains("accessor 0 has too many elements"), "{message}");
}

#[test]
fn primitives_of_the_same_accessors_are_one_mesh() {
    let mut model = document();
    let primitive = model["meshes"][0]["primitives"][0].clone();
    model["meshes"][0]["primitives"] = json!(vec![primitive; 1000]);
    let read = load_json(&model).unwrap();
    assert_eq!((read.meshes.len(), read.nodes[0].parts.len()), (1, 1000));
}

#[test]
fn accessors_that_overlap_without_end_are_refused() {
    let files = GltfFolder::new();
    std::fs::write(files.folder.path().join("the buffer.bin"), vec![1; 1 << 16]).unwrap();
    let mut model = document();
    model["buffers"][0]["byteLength"] = json!(1 << 16);
    model["bufferViews"] = json!([{ "buffer": 0, "byteLength": 1 << 16, "byteStride": 4 }]);
    let accessor = |at: usize| {
        json!({ "bufferView": 0, "byteOffset": 4 * at, "componentType": 5121, "normalized": true,
                "count": 16000, "type": "VEC3" })
    };
    model["accessors"] = (0..100).map(accessor).collect();
    model["meshes"][0]["primitives"] =
        (0..100).map(|at| json!({ "attributes": { "POSITION": at } })).collect();
    assert!(files.load(model.to_string().as_bytes()).unwrap().meshes.is_empty(), "all vertices are equal");
    let mixed: Vec<u8> = (0..1u32 << 16).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    std::fs::write(files.folder.path().join("the buffer.bin"), mixed).unwrap();
    let message = files.load(model.to_string().as_bytes()).unwrap_err().to_string();
    assert!(message.contains("its accessors overlap"), "{message}");
}

#[test]
fn invisible_nodes_are_left_out_with_their_children() {
    let mut model = with("/nodes/0/extensions", json!({ "KHR_node_visibility": { "visible": false } }));
    assert_eq!(load_json(&model).unwrap().nodes.len(), 0);
    assert!(one_line(&model).ends_with("with all below them: square"));
    model["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = json!(true);
    let read = load_json(&model).unwrap();
    assert_eq!((read.nodes.len(), read.warnings.len()), (2, 0));
}

/// The document with this node in place of the camera's.
fn with_empty(node: Value) -> Value {
    with("/nodes/1", node)
}

#[test]
fn an_empty_called_black_hole_places_a_hole() {
    let hole = |node: Value| {
        load_json(&with_empty(node)).unwrap().nodes[1].hole.map(|hole| (hole.radius, hole.spin))
    };
    assert_eq!(hole(json!({ "name": "BlackHole" })), Some((1.0, 0.0)));
    assert_eq!(
        hole(json!({ "name": "blackhole.001", "extras": { "schwarzschild_radius": 0.25 } })),
        Some((0.25, 0.0))
    );
    assert_eq!(hole(json!({ "name": "BlackHole", "extras": { "other": 3 } })), Some((1.0, 0.0)));
    assert_eq!(hole(json!({ "name": "BlackHole", "extras": { "spin": -0.9 } })), Some((1.0, -0.9)));
    assert_eq!(hole(json!({ "name": "BlackHoles" })), None);
    assert_eq!(hole(json!({ "name": "BlackHole", "mesh": 0 })), None);
    let with_mesh = one_line(&with_empty(json!({ "name": "BlackHole", "mesh": 0 })));
    assert!(with_mesh.starts_with("only an Empty places a black hole"), "{with_mesh}");
    let wrong = [("schwarzschild_radius", json!(-1)), ("schwarzschild_radius", json!("big"))];
    for (key, value) in wrong.into_iter().chain([("schwarzschild_radius", json!(null)), ("spin", json!(1.5))])
    {
        let node = json!({ "name": "BlackHole", "extras": { key: value } });
        let message = load_json(&with_empty(node)).unwrap_err().to_string();
        assert!(message.contains("node `BlackHole`") && message.contains(key), "{message}");
    }
}

#[test]
fn lights_that_the_exporter_left_out_are_missed() {
    for name in ["Area", "Area.001", "Area_Orientation", "Light", "Sun.002", "area light"] {
        let line = one_line(&with_empty(json!({ "name": name })));
        assert!(line.starts_with("there is no light") && line.ends_with(name), "{line}");
    }
    for node in
        [json!({ "name": "Area", "mesh": 0 }), json!({ "name": "Areal" }), json!({ "name": "Pointer" })]
    {
        assert!(load_json(&with_empty(node)).unwrap().warnings.is_empty());
    }
}

#[test]
fn what_is_not_read_may_be_wrong() {
    let meshes = load_json(&document()).unwrap().meshes;
    for (pointer, value) in [
        (
            "/animations",
            json!([{ "channels": [{ "sampler": 7, "target": { "node": 99, "path": "odd" } }], "samplers": [] }]),
        ),
        ("/samplers", json!([{ "wrapS": 1, "magFilter": 2 }])),
        ("/skins", json!([{ "joints": [99] }])),
        ("/bufferViews/0/target", json!(1)),
        ("/accessors/0/min", json!("low")),
    ] {
        let model = load_json(&with(pointer, value)).unwrap_or_else(|error| panic!("{pointer}: {error}"));
        assert_eq!(model.meshes, meshes, "{pointer}");
    }
}
