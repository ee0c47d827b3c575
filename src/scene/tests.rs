use std::path::PathBuf;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::*;
use crate::geometry::{Primitives, Sphere};
use crate::shade::{Environment, Lobe};

struct Files {
    folder: tempfile::TempDir,
}

impl Files {
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
        let mut world = populate::populate(file::parse(&text).unwrap(), self.folder.path()).unwrap();
        let (primitives, shaped) = bake::flatten(&mut world).unwrap();
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
        assert!(!baked.entities.is_empty());
        count += 1;
    }
    assert_eq!(count, 9);
}

#[test]
fn the_black_hole_scene_is_the_papers_figure_5() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell_black_hole.toml");
    let baked = load(&path, &[]).unwrap();
    let center = DVec3::new(-1.0, -13.2, 60.0);
    assert_eq!(baked.spacetime, SpacetimeKind::Schwarzschild { center, schwarzschild_radius: 5.0 });
    assert_eq!(baked.entities.len(), 9);
    assert_eq!(baked.camera.near, 140.0);
    assert!((baked.camera.tan_half_fov - 0.5135 / 2.0).abs() < 1e-7);
    assert_eq!(baked.materials[5].lobe, Lobe::Dielectric { ior: 1.5, tint: Vec3::splat(0.999) });
    assert!(baked.warnings.is_empty());
    let flat = load(&path, &["spacetime.schwarzschild_radius=0".to_owned()]).unwrap();
    assert_eq!(flat.spacetime, SpacetimeKind::Flat);
}

#[test]
fn the_room_shares_no_extra_meshes_and_names_its_nodes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/room_black_hole.toml");
    let baked = load(&path, &[]).unwrap();
    assert!(baked.entities.contains(&"room/GlassBall".to_owned()), "{:?}", baked.entities);
    assert!(baked.materials.iter().any(|m| m.lobe == Lobe::Dielectric { ior: 1.45, tint: Vec3::ONE }));
    // The floor's only colour is that of its texture.
    assert!(baked.materials.iter().all(|m| m.lobe != Lobe::Diffuse { albedo: Vec3::ONE }));
    assert!((baked.camera.position - DVec3::new(-0.25, 1.45, 2.75)).length() < 1e-6);
    assert!((baked.camera.up - DVec3::new(0.013619, 0.990319, -0.138139)).length() < 1e-5);
    assert!(baked.warnings.iter().any(|line| line.contains("PointWarm, SpotCool")), "{:?}", baked.warnings);
}

#[test]
fn instances_share_their_mesh() {
    let files = Files::new(&[
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
    let files = Files::new(&[
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
    let files = Files::new(&[("a.gltf", &document.to_string())]);
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
    let files = Files::new(&[(
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
    let files = Files::new(&[("a b.OBJ", TRIANGLE)]);
    let baked =
        load_with_hole(&files.path("a b.OBJ"), &["film.width=320".to_owned()], Some([0.0, 0.0, -1.0, 0.1]))
            .unwrap();
    assert!(matches!(baked.environment, Environment::Gradient { .. }));
    assert_eq!(baked.settings.width, 320);
    assert!(baked.camera.position.y > 0.5 && baked.camera.forward.y < 0.0);
    assert!(matches!(baked.spacetime, SpacetimeKind::Schwarzschild { .. }));
}

#[test]
fn entity_emission_and_material_override_those_of_the_mesh() {
    let files = Files::new(&[
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
    assert_eq!(last.lobe, Lobe::Mirror { reflectance: Vec3::new(1.0, 0.8, 0.3) });
    assert_eq!(last.emission, Vec3::splat(3.0));
}

#[test]
fn an_environment_picture_turns_about_y() {
    let files = Files::new(&[(
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
