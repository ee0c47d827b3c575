use std::path::{Path, PathBuf};

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::bare_model::bare_scene;
use super::populate::AssetSource;
use super::*;
use crate::geometry::{Primitives, Sphere};
use crate::light::Punctual;
use crate::shade::{Dielectric, Diffuse, Environment, Lobe, Material, Mirror};
use crate::spacetime::{Placement, SpacetimeKind};

struct SceneFolder {
    folder: tempfile::TempDir,
}

impl SceneFolder {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Primitives of the scene, and the names of their entities.
    fn primitives(&self, name: &str) -> (Primitives, Vec<String>) {
        let path = self.path(name);
        let text = match name.split_once('.').unwrap().1 {
            "toml" => std::fs::read_to_string(&path).unwrap(),
            "obj" => bare_scene(&path, "mesh"),
            _ => bare_scene(&path, "gltf"),
        };
        let mut world = populate::populate(
            file::parse(&text).unwrap(),
            &AssetSource {
                folder: self.folder.path(),
                bare: None,
                files: &Default::default(),
                light_scale: None,
                time: 0.0,
            },
        )
        .unwrap();
        let ([primitives, _], shaped) = bake::flatten(&mut world).unwrap();
        let names = shaped.iter().map(|entity| world.name(*entity)).collect();
        (primitives, names)
    }
}

const TRIANGLE: &str = "o leaf\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn assert_near(actual: DAffine3, expected: DAffine3) {
    let difference = (actual.matrix3 - expected.matrix3).to_cols_array();
    let offset = (actual.translation - expected.translation).to_array();
    let largest = difference.iter().chain(&offset).fold(0.0f64, |largest, value| largest.max(value.abs()));
    assert!(largest < 1e-6, "{actual:?} is not {expected:?}");
}

#[test]
fn every_scene_of_the_repository_loads() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let baked = load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((baked.settings.width, baked.settings.height), (640, 480), "{}", path.display());
        assert!(!baked.entities.is_empty() || !baked.environment.is_black());
        count += 1;
    }
    assert_eq!(count, 16);
}

#[test]
fn the_black_hole_scene_is_the_papers_figure_5() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell_black_hole.toml");
    let baked = load(&path, &[]).unwrap();
    let center = DVec3::new(-1.0, -13.2, 60.0);
    assert_eq!(baked.spacetime, SpacetimeKind::black_hole(center, 5.0));
    assert_eq!(baked.entities.len(), 9);
    assert_eq!(baked.camera.near, 140.0);
    let Projection::Perspective(perspective) = baked.camera.projection else { panic!("{:?}", baked.camera) };
    assert!((perspective.tan_half_fov - 0.5135 / 2.0).abs() < 1e-7);
    assert_eq!(baked.materials[5].lobe, Lobe::Dielectric(Dielectric { ior: 1.5, tint: Vec3::splat(0.999) }));
    assert!(baked.warnings.is_empty());
    let flat = load(&path, &["spacetime.schwarzschild_radius=0".to_owned()]).unwrap();
    assert_eq!(flat.spacetime, SpacetimeKind::Flat);
}

#[test]
fn the_room_shares_no_extra_meshes_and_names_its_nodes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/room_black_hole.toml");
    let baked = load(&path, &[]).unwrap();
    assert!(baked.entities.contains(&"room/GlassBall".to_owned()), "{:?}", baked.entities);
    assert!(
        baked.materials.iter().any(|m| m.lobe == Lobe::Dielectric(Dielectric { ior: 1.45, tint: Vec3::ONE }))
    );
    // The floor's only colour is that of its texture.
    let is_white = |m: &&Material| m.lobe == Lobe::Diffuse(Diffuse { albedo: Vec3::ONE });
    assert!(baked.materials.iter().find(is_white).is_some_and(|m| m.maps.base_color.is_some()));
    assert!((baked.camera.position - DVec3::new(-0.25, 1.45, 2.75)).length() < 1e-6);
    assert!((baked.camera.up - DVec3::new(0.013619, 0.990319, -0.138139)).length() < 1e-5);
}

#[test]
fn the_lights_of_the_room_are_those_of_blender_in_watts() {
    let baked = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/room.glb"), &[]).unwrap();
    let [
        Punctual::Point { position: warm, intensity: orange },
        Punctual::Spot { position: cool, direction, intensity: blue, cos_inner, cos_outer },
    ] = baked.punctual[..]
    else {
        panic!("{:?}", baked.punctual);
    };
    assert!(warm.abs_diff_eq(DVec3::new(-1.9, 2.2, -2.2), 1e-6), "{warm}");
    assert!(cool.abs_diff_eq(DVec3::new(2.1, 2.6, 1.6), 1e-6), "{cool}");
    // Blender's 12 W and 60 W, into 4π.
    let per_watt = 0.25 * std::f32::consts::FRAC_1_PI;
    assert!(orange.abs_diff_eq(12.0 * per_watt * Vec3::new(1.0, 0.6, 0.3), 1e-6), "{orange}");
    assert!(blue.abs_diff_eq(60.0 * per_watt * Vec3::new(0.55, 0.75, 1.0), 1e-6), "{blue}");
    assert!((cos_inner.acos() - 0.38135443).abs() < 1e-7 && (cos_outer.acos() - 0.40142572).abs() < 1e-7);
    // −Z turned by the node's quaternion q: −(2(xz + wy), 2(yz − wx), 1 − 2(x² + y²)).
    assert!(direction.abs_diff_eq(DVec3::new(-0.352789, -0.676178, -0.646779), 1e-6), "{direction}");
    assert!(!baked.warnings.iter().any(|line| line.contains("PointWarm")), "{:?}", baked.warnings);
}

#[test]
fn entities_that_share_a_file_may_scale_its_lights_differently() {
    let room = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/room.glb");
    let gltf = toml_edit::Value::from(room.to_str().unwrap());
    let text = format!(
        "[[entity]]\ngltf = {gltf}\nlight_scale = 1\n[[entity]]\ngltf = {gltf}\n[[entity]]\ngltf = {gltf}\nlight_scale = 0\n"
    );
    let files = SceneFolder::new(&[("a.toml", &text)]);
    let baked = load(&files.path("a.toml"), &[]).unwrap();
    let red: Vec<f32> = baked.punctual.iter().step_by(2).map(|light| light.peak().x).collect();
    assert!((red[0] - 652.217).abs() < 1e-3 && (red[1] - 652.217 / 683.0).abs() < 1e-6, "{red:?}");
    assert_eq!((red.len(), red[2]), (3, 0.0));
}

#[test]
fn lights_follow_their_transform_and_keep_their_intensity() {
    let files = SceneFolder::new(&[(
        "a.toml",
        "[[entity]]\nsphere = { center = [0, 0, 0], radius = 1 }\n\
         [[entity]]\nlight = { kind = \"spot\", position = [1, 0, 0], direction = [0, 0, -2], intensity = 3 }\n\
         transform = { scale = [1, 1, -4], rotate = [0, 90, 0], translate = [0, 5, 0] }\n\
         [[entity]]\nlight = { kind = \"distant\", direction = [0, -2, 0], irradiance = [1, 2, 3] }\n\
         transform = { translate = [9, 9, 9] }\n\
         [[entity]]\nlight = { kind = \"point\", position = [1, 2, 3], intensity = 4 }\n",
    )]);
    let baked = load(&files.path("a.toml"), &[]).unwrap();
    assert_eq!(baked.entities, ["sphere 0"]);
    assert_eq!(baked.warnings, Vec::<String>::new());
    let Punctual::Spot { position, direction, intensity, cos_inner, cos_outer } = baked.punctual[0] else {
        panic!("{:?}", baked.punctual);
    };
    // About Y: x → −z, z → x; the axis is mirrored before.
    assert!(position.abs_diff_eq(DVec3::new(0.0, 5.0, -1.0), 1e-12), "{position}");
    assert!(direction.abs_diff_eq(DVec3::X, 1e-12), "{direction}");
    assert_eq!((intensity, cos_inner), (Vec3::splat(3.0), 1.0));
    assert!((cos_outer - 0.5f64.sqrt()).abs() < 1e-12);
    assert_eq!(
        baked.punctual[1..],
        [
            Punctual::Distant { direction: DVec3::NEG_Y, irradiance: Vec3::new(1.0, 2.0, 3.0) },
            Punctual::Point { position: DVec3::new(1.0, 2.0, 3.0), intensity: Vec3::splat(4.0) },
        ]
    );
}

/// A glTF file with a triangle and this light at a node that is scaled by zero along Z.
fn lit_triangle(light: &str) -> String {
    let positions = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "scenes": [{{ "nodes": [0, 1] }}],
            "nodes": [{{ "mesh": 0, "name": "leaf" }},
                      {{ "name": "lamp", "scale": [1, 1, 0], "extensions": {{ "KHR_lights_punctual": {{ "light": 0 }} }} }}],
            "extensions": {{ "KHR_lights_punctual": {{ "lights": [{light}] }} }},
            "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0 }} }}] }}],
            "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }}],
            "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}],
            "buffers": [{{ "byteLength": 36, "uri": "data:application/octet-stream;base64,{positions}" }}] }}"#
    )
}

#[test]
fn a_bare_model_with_a_light_gets_no_sky() {
    let load =
        |light| load(&SceneFolder::new(&[("a.gltf", &lit_triangle(light))]).path("a.gltf"), &[]).unwrap();
    let baked = load(r#"{ "type": "point", "intensity": 683 }"#);
    assert!(baked.environment.is_black());
    assert_eq!((baked.punctual.len(), baked.warnings.len()), (1, 0), "{:?}", baked.warnings);
    assert!(!load(r#"{ "type": "point", "intensity": 0 }"#).environment.is_black());
}

#[test]
fn a_light_whose_direction_a_scale_of_0_loses_is_left_out_by_name() {
    for light in [r#"{ "type": "directional" }"#, r#"{ "type": "spot", "spot": {} }"#] {
        let files = SceneFolder::new(&[("a.gltf", &lit_triangle(light))]);
        let baked = load(&files.path("a.gltf"), &[]).unwrap();
        assert!(baked.punctual.is_empty());
        let expected = "lights left out, since scales of 0 leave them no direction: `lamp`";
        assert!(baked.warnings.iter().any(|line| line == expected), "{:?}", baked.warnings);
    }
}

#[test]
fn a_light_that_is_too_bright_is_an_error_that_names_it() {
    let files = SceneFolder::new(&[("a.gltf", &lit_triangle(r#"{ "type": "point", "intensity": 1e30 }"#))]);
    let message = load(&files.path("a.gltf"), &[]).err().unwrap().to_string();
    assert!(message.contains("`lamp`: the light is brighter than 1e18"), "{message}");
}

/// A glTF file of these nodes; mesh 0 is a triangle in the plane Z = 0, camera 0 looks through 60 degrees at a picture
/// that is half as wide as high.
fn model_of(nodes: serde_json::Value) -> String {
    let roots: Vec<usize> = (0..nodes.as_array().unwrap().len()).collect();
    serde_json::json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "cameras": [{ "type": "perspective", "perspective": { "yfov": std::f32::consts::FRAC_PI_3, "znear": 0.1, "aspectRatio": 0.5 } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        // Three positions: (0, 0, 0), (1, 0, 0), (0, 1, 0).
        "buffers": [{ "byteLength": 36, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" }],
    })
    .to_string()
}

fn load_model(nodes: serde_json::Value, options: &LoadOptions) -> Result<Baked, SceneError> {
    load_with(&SceneFolder::new(&[("a.gltf", &model_of(nodes))]).path("a.gltf"), options)
}

#[test]
fn the_camera_is_the_first_or_the_one_that_is_named() {
    let nodes = serde_json::json!([
        { "mesh": 0 },
        { "camera": 0, "name": "Front", "translation": [0, 0, 5] },
        { "camera": 0, "name": "Back", "translation": [0, 0, 9] },
        { "camera": 0, "name": "Third" },
    ]);
    let of = |name: Option<&str>| {
        load_model(nodes.clone(), &LoadOptions { camera: name.map(str::to_owned), ..LoadOptions::default() })
    };
    let first = of(None).unwrap();
    assert_eq!(first.camera.position.z, 5.0);
    let expected = "camera `Front` is used, the first; --camera NAME takes another; ignored: `Back`, `Third`";
    assert_eq!(first.warnings, [expected]);
    let second = of(Some("Back")).unwrap();
    assert_eq!((second.camera.position.z, second.warnings.len()), (9.0, 0));
    let message = of(Some("back")).err().unwrap().to_string();
    assert!(
        message.contains("no camera `back`") && message.contains("`Front`, `Back`, `Third`"),
        "{message}"
    );
    let none = load_model(
        serde_json::json!([{ "mesh": 0 }]),
        &LoadOptions { camera: Some("x".to_owned()), ..LoadOptions::default() },
    );
    assert!(none.err().unwrap().to_string().contains("the scene has no camera"));
}

#[test]
fn cameras_of_scene_files_and_of_their_models_go_by_name_too() {
    let nodes = serde_json::json!([{ "mesh": 0 }, { "camera": 0, "name": "Eye", "translation": [0, 0, 5] }]);
    let camera = "[camera]\nposition = [0, 0, 3]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n";
    let entity = "[[entity]]\nname = \"room\"\ngltf = \"a.gltf\"\n";
    let files = SceneFolder::new(&[("a.gltf", &model_of(nodes)), ("a.toml", &format!("{camera}{entity}"))]);
    for (name, z) in [(None, 3.0), (Some("camera"), 3.0), (Some("room/Eye"), 5.0), (Some("Eye"), 5.0)] {
        let options = LoadOptions { camera: name.map(str::to_owned), ..LoadOptions::default() };
        let baked = load_with(&files.path("a.toml"), &options).unwrap();
        assert_eq!(baked.camera.position.z, z, "{name:?}");
    }
}

#[test]
fn the_cameras_own_shape_is_that_of_the_picture_unless_something_says_its_size() {
    let nodes = serde_json::json!([{ "mesh": 0 }, { "camera": 0, "name": "Eye", "translation": [0, 0, 5] }]);
    let size = |options: &LoadOptions| {
        let baked = load_model(nodes.clone(), options).unwrap();
        let said = baked.notes.iter().any(|note| note.contains("in the shape of camera `Eye`"));
        (baked.settings.width, baked.settings.height, said)
    };
    assert_eq!(size(&LoadOptions::default()), (240, 480, true));
    let given = LoadOptions { size: Some((30, 20)), ..LoadOptions::default() };
    assert_eq!(size(&given), (30, 20, false));
    let set = LoadOptions { overrides: vec!["film.height=100".to_owned()], ..LoadOptions::default() };
    assert_eq!(size(&set), (640, 100, false));
}

#[test]
fn orthographic_cameras_of_files_go_by_name_and_shape() {
    let mut document: serde_json::Value = serde_json::from_str(&model_of(serde_json::json!([
        { "mesh": 0 },
        { "camera": 0, "name": "Eye", "translation": [0, 0, 5] },
        { "camera": 1, "name": "Plan", "translation": [0, 0, 7] },
    ])))
    .unwrap();
    let lens = serde_json::json!({ "xmag": 3, "ymag": 2, "zfar": 100, "znear": 0.1 });
    let plan = serde_json::json!({ "type": "orthographic", "orthographic": lens });
    document["cameras"].as_array_mut().unwrap().push(plan);
    let files = SceneFolder::new(&[("a.gltf", &document.to_string())]);
    let options = LoadOptions { camera: Some("Plan".to_owned()), ..LoadOptions::default() };
    let baked = load_with(&files.path("a.gltf"), &options).unwrap();
    let half_height = 2.0;
    assert_eq!(baked.camera.projection, Projection::Orthographic(Orthographic { half_height }));
    assert_eq!((baked.camera.position.z, baked.settings.width, baked.settings.height), (7.0, 720, 480));
}

#[test]
fn a_camera_without_position_changes_the_lens_of_the_files_own() {
    let nodes = serde_json::json!([{ "mesh": 0 }, { "camera": 0, "name": "Eye", "translation": [0, 0, 5] }]);
    let with = |overrides: &[&str]| {
        let overrides = overrides.iter().map(|text| (*text).to_owned()).collect();
        load_model(nodes.clone(), &LoadOptions { overrides, ..LoadOptions::default() })
    };
    let lens = with(&["camera.aperture=0.1", "camera.focus_distance=4", "camera.near=0.5"]).unwrap();
    let Projection::Perspective(Perspective { tan_half_fov, lens: Some(thin) }) = lens.camera.projection
    else {
        panic!("{:?}", lens.camera)
    };
    assert!((tan_half_fov - libm::tan(std::f64::consts::FRAC_PI_6)).abs() < 1e-7, "{tan_half_fov}");
    assert_eq!((thin.radius, thin.focus_distance, lens.camera.near), (0.1, 4.0, 0.5));
    assert_eq!((lens.camera.position.z, lens.settings.width), (5.0, 240));
    let dome = with(&["camera.projection=fisheye"]).unwrap();
    assert_eq!((dome.camera.position.z, dome.settings.width), (5.0, 480));
    for (change, expected) in [
        ("camera.aperture=0.1", "a lens needs the distance that is in focus"),
        ("camera.look_at=[0,0,0]", "`look_at` needs `position`"),
        ("camera.side=far", "`side` needs `position`"),
        ("camera.projection=orthographic", "an orthographic camera needs `height`"),
    ] {
        let message = with(&[change]).err().unwrap().to_string();
        assert!(message.contains(expected), "{change}: {message}");
    }
}

#[test]
fn keys_of_other_projections_are_said_and_pictures_all_around_have_their_shape() {
    let of = |keys: &str| {
        let text =
            format!("[environment]\ncolor = 1\n[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n{keys}");
        let files = SceneFolder::new(&[("a.toml", &text)]);
        load(&files.path("a.toml"), &[]).unwrap()
    };
    let dome = of("projection = \"fisheye\"\nvertical_fov = 40\n");
    assert_eq!(dome.warnings, ["camera.vertical_fov has no effect, since camera.projection is fisheye"]);
    assert_eq!((dome.settings.width, dome.settings.height), (480, 480));
    let around = of("projection = \"equirectangular\"\n");
    assert_eq!((around.settings.width, around.settings.height), (960, 480));
    let lens = of("vertical_fov = 40\naperture = 0.1\n");
    let Projection::Perspective(Perspective { lens: Some(lens), .. }) = lens.camera.projection else {
        panic!("{:?}", lens.camera)
    };
    assert_eq!((lens.radius, lens.focus_distance, lens.blades), (0.1, 5.0, 0));
}

#[test]
fn a_framed_camera_is_said_and_goes_by_the_size_of_the_picture() {
    let framed = |size| {
        let options = LoadOptions { size: Some(size), ..LoadOptions::default() };
        load_model(serde_json::json!([{ "mesh": 0 }]), &options).unwrap()
    };
    let (wide, narrow) = (framed((400, 100)), framed((100, 400)));
    assert!(wide.notes.contains(&"there is no camera, so one frames the whole scene".to_owned()));
    assert!(narrow.camera.position.length() > 2.0 * wide.camera.position.length());
}

#[test]
fn what_is_around_a_model_is_said_and_can_be_chosen() {
    let dark = serde_json::json!([{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 5] }]);
    let around = |environment| {
        let options = LoadOptions { environment, ..LoadOptions::default() };
        load_model(dark.clone(), &options).unwrap()
    };
    let default = around(None);
    assert!(matches!(default.environment, Environment::Gradient { .. }));
    assert!(
        default
            .notes
            .iter()
            .any(|note| note.contains("nothing in the model emits light") && note.contains("--environment"))
    );
    let grey = around(Some(Surroundings::Color(Vec3::splat(0.5))));
    assert_eq!(grey.environment.radiance(DVec3::X), Vec3::splat(0.5));
    assert!(!grey.notes.iter().any(|note| note.contains("--environment")), "{:?}", grey.notes);
    assert!(around(Some(Surroundings::Color(Vec3::ZERO))).environment.is_black());
    let files = SceneFolder::new(&[("a.gltf", &lit_triangle(r#"{ "type": "point" }"#))]);
    let lit = load(&files.path("a.gltf"), &[]).unwrap();
    assert!(lit.notes.iter().any(|note| note.contains("carries no world")), "{:?}", lit.notes);
    image::GrayImage::from_pixel(4, 2, image::Luma([255u8])).save(files.path("white.png")).unwrap();
    let picture = |name: &str| {
        let environment = Some(Surroundings::Image(files.path(name)));
        load_with(&files.path("a.gltf"), &LoadOptions { environment, ..LoadOptions::default() })
    };
    assert_eq!(picture("white.png").unwrap().environment.radiance(DVec3::X), Vec3::ONE);
    assert!(picture("gone.png").err().unwrap().to_string().contains("gone.png: cannot be read"));
}

#[test]
fn the_factor_on_lights_is_said_and_can_be_chosen() {
    let files = SceneFolder::new(&[("a.gltf", &lit_triangle(r#"{ "type": "point", "intensity": 683 }"#))]);
    let with = |light_scale| {
        let options = LoadOptions { light_scale, ..LoadOptions::default() };
        load_with(&files.path("a.gltf"), &options).unwrap()
    };
    let (default, own) = (with(None), with(Some(2.0)));
    assert!((default.punctual[0].peak().x - 1.0).abs() < 1e-6);
    assert_eq!(own.punctual[0].peak().x, 1366.0);
    let says = |baked: &Baked| {
        baked.notes.iter().any(|note| note.contains("683 lm/W") && note.contains("--light-scale"))
    };
    assert!(says(&default) && !says(&own));
    assert!(default.warnings.is_empty(), "{:?}", default.warnings);
    // Blender's 10 W, exported without its unit.
    let dim = SceneFolder::new(&[("a.gltf", &lit_triangle(r#"{ "type": "point", "intensity": 0.8 }"#))]);
    let warnings = load(&dim.path("a.gltf"), &[]).unwrap().warnings;
    assert!(warnings[0].contains("Unitless") && warnings[0].contains("--light-scale 1"), "{warnings:?}");
}

#[test]
fn an_empty_called_black_hole_places_a_hole_by_its_scale_and_its_property() {
    let hole = |name: &str, scale: f64, extras: serde_json::Value, options: &LoadOptions| {
        let nodes = serde_json::json!([
            { "mesh": 0 },
            { "camera": 0, "translation": [0, 0, 5] },
            { "name": name, "scale": [scale, scale, -scale], "translation": [1, 2, -3], "extras": extras },
        ]);
        load_model(nodes, options).unwrap()
    };
    let plain = LoadOptions::default();
    let at = |radius| SpacetimeKind::black_hole(DVec3::new(1.0, 2.0, -3.0), radius);
    let scaled = hole("BlackHole", 0.25, serde_json::json!({}), &plain);
    assert_eq!(scaled.spacetime, at(0.25));
    let note = "`BlackHole` places a black hole of Schwarzschild radius 0.25 at 1,2,-3";
    assert!(scaled.notes.contains(&note.to_owned()), "{:?}", scaled.notes);
    let with_extra = serde_json::json!({ "schwarzschild_radius": 0.5 });
    assert_eq!(hole("blackhole.001", 0.25, with_extra, &plain).spacetime, at(0.125));
    let spins = hole("BlackHole", 0.5, serde_json::json!({ "spin": 0.9 }), &plain);
    let turned = Placement::from(DVec3::new(1.0, 2.0, -3.0));
    assert_eq!(spins.spacetime, SpacetimeKind::spinning(turned, 0.5, 0.9));
    assert!(spins.notes.iter().any(|note| note.contains("radius 0.5 and spin 0.9 at")), "{:?}", spins.notes);
    let given = LoadOptions { black_hole: Some([0.0, 0.0, 0.0, 1.0, 0.0]), ..LoadOptions::default() };
    let own = hole("BlackHole", 1.0, serde_json::json!({}), &given);
    assert_eq!(own.spacetime, SpacetimeKind::black_hole(DVec3::ZERO, 1.0));
    assert!(own.notes.iter().any(|note| note.contains("`BlackHole` places no hole")), "{:?}", own.notes);
    let flat = LoadOptions { overrides: vec!["spacetime.kind=flat".to_owned()], ..LoadOptions::default() };
    assert_eq!(hole("BlackHole", 1.0, serde_json::json!({}), &flat).spacetime, SpacetimeKind::Flat);
    let none = hole("BlackHole", 1.0, serde_json::json!({ "schwarzschild_radius": 0 }), &plain);
    assert_eq!(none.spacetime, SpacetimeKind::Flat);
    assert!(none.warnings.iter().any(|line| line.contains("its radius is 0")), "{:?}", none.warnings);
}

#[test]
fn of_several_holes_the_first_counts_and_entities_move_them() {
    let nodes = serde_json::json!([
        { "mesh": 0 },
        { "camera": 0, "name": "Eye", "translation": [0, 0, 5] },
        { "name": "BlackHole", "translation": [1, 0, 0] },
        { "name": "BlackHole.001" },
    ]);
    let text = "[[entity]]\nname = \"room\"\ngltf = \"a.gltf\"\ntransform = { scale = 0.5, translate = [0, 1, 0] }\n";
    let files = SceneFolder::new(&[
        ("a.gltf", &model_of(nodes)),
        ("a.toml", &format!("[environment]\nstrength = 1\n{text}")),
    ]);
    let baked = load(&files.path("a.toml"), &[]).unwrap();
    let center = DVec3::new(0.5, 1.0, 0.0);
    assert_eq!(baked.spacetime, SpacetimeKind::black_hole(center, 0.5));
    let expected = "there can be only one black hole yet, at `room/BlackHole`; ignored: `room/BlackHole.001`";
    assert!(baked.warnings.contains(&expected.to_owned()), "{:?}", baked.warnings);
}

#[test]
fn nodes_of_scale_0_are_flat_or_left_out_by_name() {
    let nodes = serde_json::json!([
        { "mesh": 0, "name": "whole" },
        { "mesh": 0, "name": "point", "scale": [0, 0, 0] },
        { "mesh": 0, "name": "line", "scale": [1, 0, 1] },
        { "mesh": 0, "name": "card", "scale": [2, 1, 0], "translation": [0, 0, 7] },
        { "mesh": 0, "name": "tilted", "scale": [1, 1, 0], "rotation": [0.6, 0, 0, 0.8] },
        { "camera": 0, "name": "blind", "scale": [1, 1, 0] },
    ]);
    let files = SceneFolder::new(&[("a.gltf", &model_of(nodes))]);
    let (primitives, names) = files.primitives("a.gltf");
    assert_eq!(names, ["whole", "card", "tilted"]);
    let card = primitives.instances[1].0;
    assert_eq!(primitives.meshes[card.mesh as usize].triangles.len(), 1);
    assert_near(
        card.to_world,
        DAffine3::from_scale_rotation_translation(
            DVec3::new(2.0, 1.0, 2.0),
            Default::default(),
            DVec3::Z * 7.0,
        ),
    );
    assert_eq!(card.mesh, primitives.instances[2].0.mesh, "flat copies are shared");
    let warnings = load(&files.path("a.gltf"), &[]).unwrap().warnings;
    assert!(warnings.contains(&"left out, since scales of 0 leave no area: `point`, `line`".to_owned()));
    let blind = "cameras left out, since scales of 0 leave them no direction: `blind`".to_owned();
    assert!(warnings.contains(&blind), "{warnings:?}");
}

#[test]
fn instances_share_their_mesh() {
    let files = SceneFolder::new(&[
        ("leaf.obj", TRIANGLE),
        (
            "a.toml",
            "[[entity]]\nname = \"one\"\nmesh = \"leaf.obj\"\n[[entity]]\nmesh = \"leaf.obj\"\ntransform = { scale = 2 }\n",
        ),
    ]);
    let (primitives, names) = files.primitives("a.toml");
    assert_eq!(primitives.meshes.len(), 1);
    assert_eq!(primitives.instances.len(), 2);
    assert_eq!(names, ["one/leaf", "leaf"]);
    assert_eq!(primitives.instances[1].1.entity, 1);
    assert_near(primitives.instances[1].0.to_world, DAffine3::from_scale(DVec3::splat(2.0)));
}

#[test]
fn scale_comes_before_rotation_before_translation() {
    let files = SceneFolder::new(&[
        ("leaf.obj", TRIANGLE),
        (
            "a.toml",
            "[[entity]]\nmesh = \"leaf.obj\"\ntransform = { translate = [1, 2, 3], rotate = [90, 0, 90], scale = [2, 3, -4] }\n\
             [[entity]]\nmesh = \"leaf.obj\"\ntransform = { rotate = { axis = [0, 2, 0], angle = 90 } }\n",
        ),
    ]);
    let (primitives, _) = files.primitives("a.toml");
    // About X: y → z, z → −y; then about Z: x → y, y → −x.
    let euler = DMat3::from_cols(DVec3::Y * 2.0, DVec3::Z * 3.0, DVec3::X * -4.0);
    assert_near(
        primitives.instances[0].0.to_world,
        DAffine3::from_mat3_translation(euler, DVec3::new(1.0, 2.0, 3.0)),
    );
    let about_y = DMat3::from_cols(-DVec3::Z, DVec3::Y, DVec3::X);
    assert_near(primitives.instances[1].0.to_world, DAffine3::from_mat3(about_y));
}

#[test]
fn nested_mirrored_and_stretched_nodes_compose() {
    let document = serde_json::json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "scale": [2, 1, -1], "translation": [10, 0, 0], "children": [1] },
            // A quarter turn about Z, then the parent's stretch: a shear for anything below.
            { "rotation": [0, 0, 0.5f64.sqrt(), 0.5f64.sqrt()], "translation": [0, 5, 1], "mesh": 0, "name": "leaf" },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        // Three positions: (0, 0, 0), (1, 0, 0), (0, 1, 0).
        "buffers": [{ "byteLength": 36, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA" }],
    });
    let files = SceneFolder::new(&[("a.gltf", &document.to_string())]);
    let (primitives, names) = files.primitives("a.gltf");
    assert_eq!(names, ["leaf"]);
    assert_eq!(primitives.meshes[0].positions[1], [1.0, 0.0, 0.0]);
    // x → y → y; y → −x → −2x; z → z → −z. Origin: (0, 5, 1) → (10, 5, −1).
    let expected = DMat3::from_cols(DVec3::Y, DVec3::X * -2.0, -DVec3::Z);
    assert_near(
        primitives.instances[0].0.to_world,
        DAffine3::from_mat3_translation(expected, DVec3::new(10.0, 5.0, -1.0)),
    );
}

#[test]
fn spheres_follow_a_uniform_scale() {
    let files = SceneFolder::new(&[(
        "a.toml",
        "[[entity]]\nsphere = { center = [1, 0, 0], radius = 2 }\ntransform = { rotate = [0, 90, 0], scale = 3, translate = [0, 1, 0] }\n",
    )]);
    let (primitives, names) = files.primitives("a.toml");
    let Sphere { center, radius } = primitives.spheres[0].0;
    assert!((center - DVec3::new(0.0, 1.0, -3.0)).length() < 1e-12);
    assert!((radius - 6.0).abs() < 1e-12);
    assert_eq!(names, ["sphere 0"]);
}

#[test]
fn a_bare_model_gets_a_camera_and_a_sky_and_may_get_a_hole() {
    let files = SceneFolder::new(&[("a b.OBJ", TRIANGLE)]);
    let baked = load_with(
        &files.path("a b.OBJ"),
        &LoadOptions {
            overrides: vec!["film.width=320".to_owned()],
            black_hole: Some([0.0, 0.0, -1.0, 0.1, 0.0]),
            ..LoadOptions::default()
        },
    )
    .unwrap();
    assert!(matches!(baked.environment, Environment::Gradient { .. }));
    assert_eq!(baked.settings.width, 320);
    assert!(baked.camera.position.y > 0.5 && baked.camera.forward.y < 0.0);
    assert!(!baked.spacetime.is_flat());
}

#[test]
fn entity_emission_and_material_override_those_of_the_mesh() {
    let files = SceneFolder::new(&[
        ("leaf.obj", TRIANGLE),
        (
            "a.toml",
            "[[material]]\nname = \"gold\"\nkind = \"mirror\"\nalbedo = [1, 0.8, 0.3]\n\
             [[entity]]\nmesh = \"leaf.obj\"\nmaterial = \"gold\"\nemission = 3\n",
        ),
    ]);
    let (path, mut materials) = (files.path("a.toml"), Vec::new());
    materials.extend(load(&path, &[]).unwrap().materials);
    let last = materials.last().unwrap();
    assert_eq!(last.lobe, Lobe::Mirror(Mirror { reflectance: Vec3::new(1.0, 0.8, 0.3) }));
    assert_eq!(last.emission, Vec3::splat(3.0));
}

#[test]
fn an_environment_picture_turns_about_y() {
    let files = SceneFolder::new(&[(
        "a.toml",
        "[environment]\nimage = \"sky.png\"\nrotation = 90\n[camera]\nposition = [0, 0, 0]\ndirection = [0, 0, -1]\nvertical_fov = 40\n",
    )]);
    // Four columns look along +Z−X, −X−Z, −Z+X, X+Z; the second is white.
    let white = |x, _| image::Luma([if x == 1 { 255u8 } else { 0 }]);
    image::GrayImage::from_fn(4, 2, white).save(files.path("sky.png")).unwrap();
    let baked = load(&files.path("a.toml"), &[]).unwrap();
    // A quarter turn to the left takes −X−Z to −X+Z.
    assert_eq!(baked.environment.radiance(DVec3::new(-1.0, 0.0, 1.0).normalize()), Vec3::ONE);
    assert_eq!(baked.environment.radiance(DVec3::new(-1.0, 0.0, -1.0).normalize()), Vec3::ZERO);
}
