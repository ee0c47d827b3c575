//! Integer attributes (`KHR_mesh_quantization`) and instances (`EXT_mesh_gpu_instancing`).

use std::fmt::Write;

use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use super::{GltfFolder, document, load_json, one_line};
use crate::asset::model::Model;

/// Adds a buffer with `bytes` to the document, and a view of it with this stride; returns the view.
pub(super) fn add_bytes(document: &mut Value, bytes: &[u8], stride: usize) -> usize {
    let uri = bytes.iter().fold("data:,".to_owned(), |mut uri, byte| {
        let _ = write!(uri, "%{byte:02x}");
        uri
    });
    let list = |document: &mut Value, key: &str, entry: Value| {
        let list = document[key].as_array_mut().unwrap();
        list.push(entry);
        list.len() - 1
    };
    let buffer = list(document, "buffers", json!({ "uri": uri, "byteLength": bytes.len() }));
    let view = json!({ "buffer": buffer, "byteLength": bytes.len(), "byteStride": stride });
    list(document, "bufferViews", view)
}

pub(super) fn add_accessor(document: &mut Value, accessor: Value) -> usize {
    let list = document["accessors"].as_array_mut().unwrap();
    list.push(accessor);
    list.len() - 1
}

/// Adds floats, `of_each` to an element.
pub(super) fn add_floats(document: &mut Value, values: &[f32], of_each: usize) -> usize {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let view = add_bytes(document, &bytes, 4 * of_each);
    let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"].get(of_each - 1).unwrap_or(&"MAT4");
    let count = values.len() / of_each;
    add_accessor(document, json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind }))
}

/// Adds `count` vectors, of which one is in the file and the others are 0.
fn add_implicit(document: &mut Value, count: u64) -> usize {
    let sparse = json!({ "count": 1, "indices": { "bufferView": 2, "componentType": 5121 }, "values": { "bufferView": 3 } });
    let accessor = json!({ "componentType": 5126, "count": count, "type": "VEC3", "sparse": sparse });
    add_accessor(document, accessor)
}

fn instanced(attributes: Value) -> Value {
    let mut document = document();
    document["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing", "KHR_mesh_quantization"]);
    document["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    document
}

#[test]
fn positions_are_integers_of_any_size_normalised_or_not() {
    // Each value as bytes, and what it stands for.
    let kinds: [(u32, &[u8], f64, f64); 4] = [
        (5120, &[0x81], -127.0, -1.0),
        (5121, &[51], 51.0, 0.2),
        (5122, &[0x01, 0x80], -32767.0, -1.0),
        (5123, &[0xff, 0x3f], 16383.0, 16383.0 / 65535.0),
    ];
    for (component, bytes, plain, normalized) in kinds {
        for (is_normalized, value) in [(false, plain), (true, normalized)] {
            let mut model = document();
            // Vertices (v, 0, 0), (0, v, 0), (0, 0, v), (v, v, v), 8 bytes apart.
            let mut all = Vec::new();
            for corner in 0..4 {
                let part =
                    |axis| if corner == axis || corner == 3 { bytes.to_vec() } else { vec![0; bytes.len()] };
                all.extend([0, 1, 2].map(part).concat());
                all.resize(8 * (corner + 1), 0);
            }
            let view = add_bytes(&mut model, &all, 8);
            model["accessors"][0] = json!({ "bufferView": view, "componentType": component, "count": 4,
                                            "normalized": is_normalized, "type": "VEC3" });
            model["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            let read = load_json(&model).unwrap_or_else(|error| panic!("{error}"));
            let v = value as f32;
            let expected = [[v, 0.0, 0.0], [0.0, v, 0.0], [0.0, 0.0, v], [v, v, v]];
            assert_eq!(read.meshes[0].positions, expected, "{component} {is_normalized}");
            assert_eq!(read.warnings, [""; 0]);
        }
    }
}

#[test]
fn normals_tangents_and_texture_coordinates_may_be_integers() {
    let files = GltfFolder::new();
    image::RgbImage::new(2, 2).save(files.folder.path().join("a.png")).unwrap();
    let mut model = document();
    model["images"] = json!([{ "uri": "a.png" }]);
    model["textures"] = json!([{ "source": 0 }]);
    model["materials"] = json!([{ "normalTexture": { "index": 0 } }]);
    let mut attribute = |bytes: [u8; 4], component: u32, normalized: bool, kind: &str| {
        let view = add_bytes(&mut model, &bytes.repeat(4), 4);
        add_accessor(
            &mut model,
            json!({ "bufferView": view, "componentType": component, "count": 4, "normalized": normalized, "type": kind }),
        )
    };
    let normal = attribute([0, 0, 127, 0], 5120, true, "VEC3");
    let tangent = attribute([0x81, 0, 0, 0x80], 5120, true, "VEC4");
    let (plain, normalized) =
        (attribute([2, 0, 3, 1], 5123, false, "VEC2"), attribute([0, 128, 255, 255], 5123, true, "VEC2"));
    for (uv, expected) in [(plain, [2.0, 259.0]), (normalized, [32768.0 / 65535.0, 1.0])] {
        let primitive = &mut model["meshes"][0]["primitives"][0];
        primitive["material"] = json!(0);
        primitive["attributes"] =
            json!({ "POSITION": 0, "NORMAL": normal, "TANGENT": tangent, "TEXCOORD_0": uv });
        let read = files.load(model.to_string().as_bytes()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(read.warnings, [""; 0]);
        let mesh = &read.meshes[0];
        assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 4]);
        assert_eq!(mesh.attributes.uvs, [vec![expected; 4]]);
        assert_eq!(mesh.attributes.tangents, [[[-1.0, 0.0, 0.0, -1.0]; 3]; 2]);
    }
}

/// World transform of a node.
fn to_world(model: &Model, index: usize) -> glam::DAffine3 {
    let node = &model.nodes[index];
    node.parent.map_or(node.to_parent, |parent| to_world(model, parent) * node.to_parent)
}

#[test]
fn instances_are_placed_by_their_own_transform_and_then_the_nodes() {
    let mut model = instanced(json!({}));
    model["nodes"][0]["translation"] = json!([10, 0, 0]);
    model["nodes"][0]["scale"] = json!([2, 2, 2]);
    let translation = add_floats(&mut model, &[0.0, 0.0, 0.0, 1.0, 2.0, 3.0], 3);
    let scale = add_floats(&mut model, &[1.0, 1.0, 1.0, 3.0, 4.0, 5.0], 3);
    // No rotation, and half a turn about +Z, not quite of unit length, in normalised integers of 16 bits.
    let quaternions = [0i16, 0, 0, 32767, 0, 0, 32700, 0];
    let bytes: Vec<u8> = quaternions.iter().flat_map(|value| value.to_le_bytes()).collect();
    let view = add_bytes(&mut model, &bytes, 8);
    let rotation = add_accessor(
        &mut model,
        json!({ "bufferView": view, "componentType": 5122, "normalized": true, "count": 2, "type": "VEC4" }),
    );
    model["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
        json!({ "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale, "_ID": 99 });
    let read = load_json(&model).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read.warnings, [""; 0]);
    let names: Vec<&str> = read.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["square", "square[0]", "square[1]", "eye"]);
    let parts: Vec<usize> = read.nodes.iter().map(|node| node.parts.len()).collect();
    assert_eq!((read.meshes.len(), parts), (1, vec![0, 1, 1, 0]));
    assert_eq!(read.nodes[3].parent, Some(0), "children are not repeated");
    let point = DVec3::new(1.0, 1.0, 1.0);
    assert_eq!(to_world(&read, 1).transform_point3(point), DVec3::new(12.0, 2.0, 2.0));
    let own = DQuat::from_rotation_z(std::f64::consts::PI) * (point * DVec3::new(3.0, 4.0, 5.0));
    let expected = 2.0 * (own + DVec3::new(1.0, 2.0, 3.0)) + DVec3::new(10.0, 0.0, 0.0);
    assert!(to_world(&read, 2).transform_point3(point).distance(expected) < 1e-12);
}

#[test]
fn five_hundred_instances_are_one_mesh() {
    let mut model = instanced(json!({}));
    let places: Vec<f32> = (0..1500).map(|i| i as f32).collect();
    let translation = add_floats(&mut model, &places, 3);
    model["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
        json!({ "TRANSLATION": translation });
    let read = load_json(&model).unwrap();
    assert_eq!((read.meshes.len(), read.nodes.len()), (1, 502));
    assert_eq!(read.nodes[500].to_parent.translation, DVec3::new(1497.0, 1498.0, 1499.0));
}

#[test]
fn instances_without_places_place_the_mesh_once() {
    for attributes in [json!({}), json!({ "_ID": 0 }), json!(3)] {
        let model = instanced(attributes);
        assert_eq!(load_json(&model).unwrap().nodes[0].parts.len(), 1);
        assert_eq!(one_line(&model), "instances without places are ignored, the mesh is placed once: square");
    }
}

#[test]
fn malformed_instances_are_errors_that_name_the_node() {
    let mut model = instanced(json!({}));
    let three = add_floats(&mut model, &[1.0; 9], 3);
    let four = add_floats(&mut model, &[0.0; 12], 3);
    let turns = add_floats(&mut model, &[0.0; 12], 4);
    let bad = add_floats(&mut model, &[0.0, f32::NAN, 0.0], 3);
    let many = add_implicit(&mut model, 1 << 40);
    for (attributes, expected) in [
        (json!({ "TRANSLATION": three, "SCALE": four }), "differ in number: 3 and 4"),
        (json!({ "TRANSLATION": 99 }), "TRANSLATION of the instances is accessor 99, which does not exist"),
        (json!({ "SCALE": -1 }), "SCALE of the instances is accessor -1"),
        (json!({ "SCALE": "x" }), "SCALE of the instances is accessor \"x\""),
        (json!({ "ROTATION": three }), "ROTATION of the instances: accessor 2 does not hold 4-vectors"),
        (json!({ "ROTATION": turns }), "instance 0: the rotation is not a quaternion"),
        (json!({ "TRANSLATION": bad }), "instance 0: the transform is not finite"),
        (json!({ "TRANSLATION": many }), "its 1099511627776 instances are more than memory"),
    ] {
        model["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
        let message = load_json(&model).unwrap_err().to_string();
        assert!(message.contains("node `square`: ") && message.contains(expected), "{message}");
        assert!(message.contains("help: "), "{message}");
    }
}

#[test]
fn nodes_that_repeat_the_same_instances_without_end_are_refused() {
    let mut model = instanced(json!({}));
    let many = add_implicit(&mut model, 4000);
    let node = json!({ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": many } } } });
    model["nodes"] = json!([node, node]);
    model["scenes"][0]["nodes"] = json!([0]);
    assert_eq!(load_json(&model).unwrap().nodes.len(), 4001);
    model["scenes"][0]["nodes"] = json!([0, 1]);
    let message = load_json(&model).unwrap_err().to_string();
    assert!(message.contains("node `node 1`: its 4000 instances are more than memory"), "{message}");
}
