//! Animations at a moment.

use glam::{DAffine3, DQuat, DVec3};
use serde_json::{Value, json};

use super::instancing::add_floats;
use super::{GltfFolder, document};
use crate::asset::model::Model;

fn at(model: &Value, time: f64) -> Model {
    let read = GltfFolder::new().load_at(model.to_string().as_bytes(), time);
    read.unwrap_or_else(|error| panic!("{error}"))
}

/// The document whose camera has a property animated, with keys at 1 s and 3 s and these values.
fn animated(path: &str, interpolation: &str, values: &[f32], of_each: usize) -> Value {
    let mut model = document();
    let input = add_floats(&mut model, &[1.0, 3.0], 1);
    let output = add_floats(&mut model, values, of_each);
    model["animations"] = json!([{
        "name": "move",
        "channels": [{ "sampler": 0, "target": { "node": 1, "path": path } }],
        "samplers": [{ "input": input, "output": output, "interpolation": interpolation }],
    }]);
    model
}

fn place(model: &Value, time: f64) -> DAffine3 {
    let read = at(model, time);
    assert_eq!(read.warnings, [""; 0]);
    read.nodes[1].to_parent
}

#[test]
fn translations_and_scales_go_straight_or_in_steps_between_their_keys() {
    let values = [0.0, 0.0, 0.0, 4.0, 8.0, 0.0];
    let straight = animated("translation", "LINEAR", &values, 3);
    let steps = animated("translation", "STEP", &values, 3);
    for (time, line, step) in
        [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.5, 1.0, 0.0), (3.0, 4.0, 4.0), (9.0, 4.0, 4.0)]
    {
        assert_eq!(place(&straight, time).translation, DVec3::new(line, 2.0 * line, 0.0), "{time}");
        assert_eq!(place(&steps, time).translation, DVec3::new(step, 2.0 * step, 0.0), "{time}");
    }
    let scale = animated("scale", "LINEAR", &[1.0, 1.0, 1.0, 3.0, 1.0, 1.0], 3);
    assert_eq!(place(&scale, 2.0), DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0)));
}

#[test]
fn rotations_turn_evenly_along_the_shorter_arc() {
    let turn = |angle: f64| DQuat::from_rotation_y(angle);
    for sign in [1.0, -1.0] {
        let end = (turn(2.0) * sign).to_array().map(|value| value as f32);
        let values = [[0.0, 0.0, 0.0, 1.0], end].concat();
        let model = animated("rotation", "LINEAR", &values, 4);
        for (time, angle) in [(1.5, 0.5), (2.0, 1.0), (2.5, 1.5)] {
            let expected = DAffine3::from_quat(turn(angle));
            assert!(place(&model, time).abs_diff_eq(expected, 1e-6), "{time}");
        }
    }
    let near = [[0.0, 0.0, 0.0, 1.0], turn(1e-3).to_array().map(|value| value as f32)].concat();
    let model = animated("rotation", "LINEAR", &near, 4);
    assert!(place(&model, 2.0).abs_diff_eq(DAffine3::from_quat(turn(5e-4)), 1e-7));
}

#[test]
fn splines_have_the_tangents_of_their_keys() {
    // x = t³, y = t² of the time t since the first key: cubic polynomials are met exactly.
    let keys =
        [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [12.0, 4.0, 1.0], [8.0, 4.0, 2.0], [9.0; 3]];
    let model = animated("translation", "CUBICSPLINE", &keys.concat(), 3);
    for t in [0.0, 0.25, 1.0, 1.75, 2.0, 5.0f64] {
        let u = t.min(2.0);
        assert!(place(&model, 1.0 + t).translation.distance(DVec3::new(u * u * u, u * u, u)) < 1e-12, "{t}");
    }
}

#[test]
fn weights_of_morph_targets_are_animated() {
    let mut model = animated("weights", "LINEAR", &[0.0, 1.0, 1.0, 0.0], 1);
    let [up, right] =
        [[0.0, 0.0, 4.0], [8.0, 0.0, 0.0]].map(|step| add_floats(&mut model, &step.repeat(4), 3));
    model["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": up }, { "POSITION": right }]);
    model["animations"][0]["channels"][0]["target"]["node"] = json!(0);
    assert_eq!(at(&model, 1.5).meshes[0].positions[0], [6.0, 0.0, 1.0]);
    assert_eq!(at(&model, 9.0).meshes[0].positions[0], [0.0, 0.0, 4.0]);
}

#[test]
fn joints_follow_their_animation() {
    let mut model = animated("translation", "STEP", &[0.0, 0.0, 1.0, 0.0, 0.0, 7.0], 3);
    let view = super::instancing::add_bytes(&mut model, &[0; 16], 4);
    let joints = super::instancing::add_accessor(
        &mut model,
        json!({ "bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4" }),
    );
    let weights = add_floats(&mut model, &[1.0, 0.0, 0.0, 0.0].repeat(4), 4);
    model["meshes"][0]["primitives"][0]["attributes"] =
        json!({ "POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": weights });
    model["nodes"][0]["skin"] = json!(0);
    model["skins"] = json!([{ "joints": [1] }]);
    for (time, height) in [(0.0, 1.0), (3.0, 7.0)] {
        assert_eq!(at(&model, time).meshes[0].positions[3], [1.0, 1.0, height]);
    }
}

#[test]
fn animations_that_cannot_be_evaluated_leave_what_is_stored_and_say_so() {
    let good = animated("translation", "LINEAR", &[1.0; 6], 3);
    for (pointer, value, expected) in [
        ("/channels/0/target/node", json!(99), "there is no such node"),
        ("/channels/0/target/path", json!("odd"), "the property or the interpolation is unknown"),
        ("/channels/0/sampler", json!(7), "there is no such sampler"),
        ("/samplers/0/interpolation", json!("CUBICSPLINE"), "there are fewer values than keys"),
        ("/samplers/0/input", json!(99), "there is no such accessor"),
        ("/samplers/0/output", json!(2), "does not hold 3-vectors"),
    ] {
        let mut model = good.clone();
        *model["animations"][0].pointer_mut(pointer).unwrap() = value;
        let read = at(&model, 2.0);
        assert_eq!(read.nodes[1].to_parent, DAffine3::IDENTITY, "{pointer}");
        let [line] = &read.warnings[..] else { panic!("{:?}", read.warnings) };
        assert!(line.contains(expected) && line.ends_with("in: move"), "{line}");
    }
}
