//! Models by themselves on the command line: what is decided for them is said, and flags decide otherwise.

use std::process::Output;

use crate::support::command::{Folder, assert_good, assert_refused, stderr};
use serde_json::{Value, json};
use warpfront::film::read_exr;

/// A square of 2 × 2 in the plane Z = 0 and two cameras with pictures twice as wide as high.
fn model() -> Value {
    let corners: [f32; 12] = [-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, -1.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    let bytes = corners.map(f32::to_le_bytes).concat();
    let escaped: String = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0, 1, 2] }],
        "nodes": [
            { "mesh": 0, "name": "Square" },
            { "camera": 0, "name": "Near", "translation": [0, 0, 5] },
            { "camera": 0, "name": "Far", "translation": [0, 0, 50] },
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.6, "znear": 0.1, "aspectRatio": 2 } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "mode": 5 }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 48 }],
        "buffers": [{ "byteLength": 48, "uri": format!("data:,{escaped}") }],
    })
}

fn folder(model: &Value) -> Folder {
    Folder::with(&[("a.gltf", &model.to_string())])
}

fn render(folder: &Folder, flags: &[&str]) -> Output {
    folder.run(&[&["render", "a.gltf", "-o", "out.exr", "--no-png", "--spp", "1"], flags].concat())
}

/// Mean of the red channel.
fn mean(folder: &Folder) -> f64 {
    let picture = read_exr(&folder.path("out.exr")).unwrap();
    let red = &picture.channels.iter().find(|plane| plane.name == "R").unwrap().values;
    red.iter().map(|value| f64::from(*value)).sum::<f64>() / red.len() as f64
}

#[test]
fn what_is_decided_for_a_model_is_a_note_and_no_loss() {
    let mut one_camera = model();
    one_camera["nodes"][2].as_object_mut().unwrap().remove("camera");
    let folder = folder(&one_camera);
    let output = render(&folder, &["--strict", "--size", "16x8"]);
    assert_good(&output);
    let said = stderr(&output);
    assert!(said.contains("note: nothing in the model emits light"), "{said}");
    assert!(!said.contains("warning") && !said.contains("in the shape of"), "{said}");
}

#[test]
fn flags_choose_camera_and_surroundings() {
    let folder = folder(&model());
    let size = ["--size", "16x8"];
    let output = render(&folder, &[&size[..], &["--environment", "black"]].concat());
    assert!(stderr(&output).contains("warning: camera `Near` is used"), "{}", stderr(&output));
    assert_good(&output);
    assert_eq!(mean(&folder), 0.0);
    let output = render(&folder, &[&size[..], &["--environment", "0.5", "--camera", "Far"]].concat());
    assert_good(&output);
    assert!(!stderr(&output).contains("camera"), "{}", stderr(&output));
    let far = mean(&folder);
    assert_good(&render(&folder, &[&size[..], &["--environment", "0.5", "--camera", "Near"]].concat()));
    let near = mean(&folder);
    assert!(0.499 < far && far <= 0.5 && near < 0.49, "{far} {near}");
    assert_refused(&render(&folder, &["--camera", "near"]), &["no camera `near`", "`Near`, `Far`"]);
    assert_refused(&render(&folder, &["--environment", "gone.hdr"]), &["gone.hdr"]);
}

#[test]
fn the_factor_on_lights_goes_over_the_default() {
    let mut lit = model();
    lit["nodes"][2] = json!({ "name": "Lamp", "translation": [0, 0, 2], "extensions": { "KHR_lights_punctual": { "light": 0 } } });
    lit["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 683 }] } });
    let folder = folder(&lit);
    let size = ["--size", "16x8"];
    let output = render(&folder, &size);
    assert_good(&output);
    assert!(stderr(&output).contains("note: lights of glTF files are divided by 683"), "{}", stderr(&output));
    let default = mean(&folder);
    assert_good(&render(&folder, &[&size[..], &["--light-scale", "1"]].concat()));
    assert!(default > 0.0 && (mean(&folder) / default - 683.0).abs() < 0.1, "{default}");
}
