//! Morph targets and skins.

use glam::{DAffine3, DQuat, DVec3};
use serde_json::{Value, json};

use super::instancing::{add_accessor, add_bytes, add_floats};
use super::{document, load_json};
use crate::asset::model::Model;

/// The square with normals, and a morph target that moves each vertex by (0, 0, 2) and its normal by (1, 0, 0).
fn morphing() -> Value {
    let mut model = document();
    let normals = add_floats(&mut model, &[0.0, 0.0, 1.0].repeat(4), 3);
    let moved = add_floats(&mut model, &[0.0, 0.0, 2.0].repeat(4), 3);
    let turned = add_floats(&mut model, &[1.0, 0.0, 0.0].repeat(4), 3);
    let primitive = &mut model["meshes"][0]["primitives"][0];
    primitive["attributes"]["NORMAL"] = json!(normals);
    primitive["targets"] = json!([{ "POSITION": moved, "NORMAL": turned }, { "POSITION": moved }]);
    model
}

fn heights(model: &Model) -> Vec<f32> {
    model.meshes.iter().map(|mesh| mesh.positions[3][2]).collect()
}

#[test]
fn morph_targets_move_vertices_by_the_weights_of_the_mesh_or_of_the_node() {
    let mut model = morphing();
    let read = load_json(&model).unwrap();
    assert_eq!((heights(&read), read.meshes[0].normals[0]), (vec![0.0], [0.0, 0.0, 1.0]));
    model["meshes"][0]["weights"] = json!([0.5, 0.25]);
    let read = load_json(&model).unwrap();
    assert_eq!((heights(&read), read.meshes[0].normals[0]), (vec![1.5], [0.5, 0.0, 1.0]));
    assert_eq!(read.warnings, [""; 0]);
    // Nodes with the same weights share a mesh, others have their own.
    model["nodes"] =
        json!([{ "mesh": 0 }, { "mesh": 0, "weights": [2] }, { "mesh": 0, "weights": [0.5, 0.25] }]);
    model["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let read = load_json(&model).unwrap();
    let meshes: Vec<usize> = read.nodes.iter().map(|node| node.parts[0].mesh).collect();
    assert_eq!((heights(&read), meshes), (vec![1.5, 4.0], vec![0, 1, 0]));
}

/// The square on two joints: the vertices hang on the first, on the second, on both by halves, and on none. The joints
/// are nodes 2 and 3.
fn skinned() -> Value {
    let mut model = document();
    let normals = add_floats(&mut model, &[0.0, 0.0, 1.0].repeat(4), 3);
    let joints = [[0u8, 9, 9, 9], [1, 9, 9, 9], [0, 1, 9, 9], [1, 9, 9, 9]].concat();
    let view = add_bytes(&mut model, &joints, 4);
    let joints = add_accessor(
        &mut model,
        json!({ "bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4" }),
    );
    let weights = [[255u8, 0, 0, 0], [255, 0, 0, 0], [127, 127, 0, 0], [0; 4]].concat();
    let view = add_bytes(&mut model, &weights, 4);
    let weights = add_accessor(
        &mut model,
        json!({ "bufferView": view, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4" }),
    );
    let bind = DAffine3::from_translation(DVec3::new(0.0, -2.0, 0.0));
    let matrices: Vec<f32> = [DAffine3::IDENTITY, bind]
        .iter()
        .flat_map(|matrix| glam::DMat4::from(*matrix).to_cols_array())
        .map(|value| value as f32)
        .collect();
    let binds = add_floats(&mut model, &matrices, 16);
    model["meshes"][0]["primitives"][0]["attributes"] =
        json!({ "POSITION": 0, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights });
    let half = std::f64::consts::FRAC_1_SQRT_2;
    model["nodes"] = json!([
        { "name": "body", "mesh": 0, "skin": 0, "translation": [100, 0, 0], "children": [1] },
        { "name": "eye", "camera": 0 },
        { "name": "hip", "translation": [0, 0, 5], "children": [3] },
        { "name": "knee", "translation": [0, 2, 0], "rotation": [half, 0, 0, half], "scale": [1, 1, 3] },
    ]);
    model["scenes"][0]["nodes"] = json!([0, 2]);
    model["skins"] = json!([{ "joints": [2, 3], "inverseBindMatrices": binds }]);
    model
}

#[test]
fn a_skin_places_vertices_by_its_joints_and_not_by_the_node() {
    let read = load_json(&skinned()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read.warnings, [""; 0]);
    let names: Vec<_> =
        read.nodes.iter().map(|node| (node.name.as_str(), node.parts.len(), node.parent)).collect();
    let expected =
        [("body", 0, None), ("body", 1, None), ("hip", 0, None), ("eye", 0, Some(0)), ("knee", 0, Some(2))];
    assert_eq!(names, expected);
    assert_eq!(read.nodes[1].to_parent, DAffine3::IDENTITY);
    let hip = DAffine3::from_translation(DVec3::new(0.0, 0.0, 5.0));
    let turn = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let knee =
        hip * DAffine3::from_scale_rotation_translation(
            DVec3::new(1.0, 1.0, 3.0),
            turn,
            DVec3::new(0.0, 2.0, 0.0),
        ) * DAffine3::from_translation(DVec3::new(0.0, -2.0, 0.0));
    let stored = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]].map(DVec3::from);
    let both = 0.5 * (hip.transform_point3(stored[2]) + knee.transform_point3(stored[2]));
    let places = [
        hip.transform_point3(stored[0]),
        knee.transform_point3(stored[1]),
        both,
        knee.transform_point3(stored[3]),
    ];
    let mesh = &read.meshes[0];
    for (found, expected) in mesh.positions.iter().zip(places) {
        assert!(DVec3::from(found.map(f64::from)).distance(expected) < 1e-6, "{found:?} {expected}");
    }
    // +Z is turned to −Y; of the vertex on both joints, by the mean of the matrices.
    let normal = |vertex: usize| DVec3::from(mesh.normals[vertex].map(f64::from));
    assert!(normal(0).distance(DVec3::Z) < 1e-6 && normal(1).distance(DVec3::NEG_Y) < 1e-6);
    let mean = (0.5 * (hip.matrix3 + knee.matrix3)).inverse().transpose() * DVec3::Z;
    assert!(normal(2).distance(mean.normalize()) < 1e-6, "{}", normal(2));
}

#[test]
fn a_skin_comes_after_morph_targets() {
    let mut model = skinned();
    let moved = add_floats(&mut model, &[0.0, 0.0, 2.0].repeat(4), 3);
    model["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": moved }]);
    model["meshes"][0]["weights"] = json!([0.5]);
    let positions = &load_json(&model).unwrap().meshes[0].positions;
    assert_eq!(positions[0], [0.0, 0.0, 6.0]);
    // Turned about +X at (0, 2), +Z becomes −Y, three times as long.
    assert!((positions[1][1] + 1.0).abs() < 1e-6, "{positions:?}");
}

#[test]
fn malformed_skins_and_morph_targets_are_errors_that_say_where() {
    let few = |model: &mut Value| add_floats(model, &[0.0; 9], 3);
    type Damage = fn(&mut Value, usize);
    let cases: [(Damage, &str); 9] = [
        (
            |model, _| model["skins"][0]["joints"] = json!([2]),
            "vertex 1 hangs on joint 1, but the skin has 1",
        ),
        (
            |model, _| model["skins"][0]["joints"] = json!([2, 99]),
            "skin 0: joint 1 is node 99, which does not exist",
        ),
        (
            |model, _| model["skins"][0]["joints"] = json!([2, 3, 3]),
            "there are 3 joints, but 2 inverse bind matrices",
        ),
        (|model, _| model["skins"][0]["joints"] = json!([]), "but the skin has 0"),
        (|model, few| model["skins"][0]["inverseBindMatrices"] = json!(few), "does not hold matrices"),
        (
            |model, _| model["skins"][0]["inverseBindMatrices"] = json!(999),
            "accessor 999, which does not exist",
        ),
        (
            |model, few| model["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": few }]),
            "has 3 elements, but there are 4 vertices",
        ),
        (
            |model, _| model["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0 }),
            "the vertices have no joints and weights for the skin",
        ),
        (
            |model, _| model["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(0),
            "accessor 0 does not hold 4-vectors",
        ),
    ];
    for (damage, expected) in cases {
        let mut model = skinned();
        model["meshes"][0]["weights"] = json!([1]);
        let few = few(&mut model);
        damage(&mut model, few);
        let message = load_json(&model).unwrap_err().to_string();
        assert!(message.contains("node `body`: ") && message.contains(expected), "{expected}: {message}");
        assert!(message.contains("help: "), "{message}");
    }
}

#[test]
fn morph_targets_that_overlap_without_end_are_refused() {
    let mut model = morphing();
    let target = model["meshes"][0]["primitives"][0]["targets"][1].clone();
    model["meshes"][0]["primitives"][0]["targets"] = json!(vec![target; 4096]);
    model["meshes"][0]["weights"] = json!(vec![0; 4096]);
    assert_eq!(heights(&load_json(&model).unwrap()), [0.0]);
    model["meshes"][0]["weights"] = json!(vec![0; 4097]);
    let message = load_json(&model).unwrap_err().to_string();
    assert!(message.contains("node `square`: it has 4097 weights of morph targets"), "{message}");
    // 4000 times the 40 000 vertices of a file of half a megabyte.
    let many = add_floats(&mut model, &[1.0, 2.0, 3.0].repeat(40_000), 3);
    model["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": many }, "mode": 5, "targets": vec![json!({ "POSITION": many }); 4000] });
    model["meshes"][0]["weights"] = json!(vec![1; 4000]);
    let message = load_json(&model).unwrap_err().to_string();
    assert!(message.contains("morph targets and joints are many times larger than the file"), "{message}");
}
