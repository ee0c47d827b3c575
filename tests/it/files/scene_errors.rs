//! Every kind of bad input gives an error that names the file, the place and the remedy, and none panics.

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use warpfront::scene::{self, Baked, LoadOptions, SceneError, load};

/// A scene that is fine, to be spoilt.
const GOOD: &str = r#"[spacetime]
kind = "schwarzschild"
center = [0, 0, 0]
schwarzschild_radius = 1

[camera]
position = [0, 0, 10]
look_at = [0, 0, 0]
vertical_fov = 40

[film]
width = 64
height = 48
filter = "tent"

[render]
spp = 4

[environment]
color = [1, 1, 1]

[[material]]
name = "porcelain"
albedo = 0.7

[[entity]]
name = "ball"
sphere = { center = [3, 0, 0], radius = 1 }
material = "porcelain"
"#;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

struct Files {
    folder: TempDir,
}

impl Files {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

fn load_text(text: &str) -> Result<Baked, String> {
    load_with(text, &[])
}

fn load_with(text: &str, overrides: &[&str]) -> Result<Baked, String> {
    let files = Files::new();
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    load(&files.write("scene.toml", text), &overrides).map_err(|error| error.to_string())
}

fn failure(result: Result<Baked, String>) -> String {
    match result {
        Ok(_) => panic!("the scene is accepted"),
        Err(message) => {
            assert!(message.contains("help: "), "no remedy: {message}");
            message
        }
    }
}

fn load_path(path: &Path) -> Result<Baked, String> {
    load(path, &[]).map_err(|error| error.to_string())
}

/// The message for the good scene with `from` replaced, which must hold the file, the place and all of `expected`.
fn assert_located(from: &str, to: &str, expected: &[&str]) {
    assert!(GOOD.contains(from), "{from}");
    let text = GOOD.replacen(from, to, 1);
    let message = failure(load_text(&text));
    assert!(message.contains("scene.toml:"), "no file: {message}");
    assert!(message.contains(" | ") && message.contains('^'), "no source line: {message}");
    for part in expected {
        assert!(message.contains(part), "{to}: no `{part}` in: {message}");
    }
}

#[test]
fn the_scene_that_the_other_tests_spoil_is_good() {
    let baked = load_text(GOOD).unwrap_or_else(|message| panic!("{message}"));
    assert_eq!(baked.warnings, Vec::<String>::new());
}

#[test]
fn missing_files_are_named() {
    let message = failure(load_path(Path::new("no/such/scene.toml")));
    assert!(message.contains("no/such/scene.toml: cannot be read"), "{message}");
    let message = failure(load_path(Path::new("no/such/model.glb")));
    assert!(message.contains("no/such/model.glb: cannot be read"), "{message}");
}

#[test]
fn a_wrong_extension_lists_the_right_ones() {
    let files = Files::new();
    for name in ["scene.xyz", "scene"] {
        let message = failure(load_path(&files.write(name, "")));
        assert!(message.contains(".toml, .gltf, .glb or .obj"), "{message}");
    }
}

#[test]
fn malformed_toml_shows_the_line() {
    assert_located("width = 64", "width = = 64", &["scene.toml:12:", "width = = 64", "TOML syntax"]);
    assert_located("[film]", "[film", &["[film"]);
    assert_located("position = [0, 0, 10]", "position = [0, 0, 10", &["scene.toml:"]);
}

#[test]
fn unknown_names_come_with_a_suggestion() {
    for (from, to, suggestion) in [
        ("albedo = 0.7", "albdo = 0.7", "did you mean `albedo`?"),
        ("[film]", "[flim]", "did you mean `film`?"),
        ("radius = 1 }", "raduis = 1 }", "did you mean `radius`?"),
        ("\"schwarzschild\"", "\"schwarzchild\"", "did you mean `schwarzschild`?"),
        ("\"tent\"", "\"tnet\"", "did you mean `tent`?"),
        ("spp = 4", "stepper = \"rk4paper\"", "did you mean `rk4-paper`?"),
        ("material = \"porcelain\"", "material = \"porcelan\"", "did you mean `porcelain`?"),
        ("material = \"porcelain\"", "transform = { rotation = [0, 0, 0] }", "did you mean `rotate`?"),
        (
            "material = \"porcelain\"",
            "transform = { rotate = { axes = [0, 0, 1], angle = 1 } }",
            "did you mean `axis`?",
        ),
    ] {
        assert_located(from, to, &[suggestion, to]);
    }
}

#[test]
fn values_without_meaning_show_their_line() {
    for (from, to, expected) in [
        ("radius = 1 }", "radius = -1 }", "radius must be positive, not -1"),
        ("radius = 1 }", "radius = nan }", "radius must be finite"),
        ("radius = 1 }", "radius = \"big\" }", "invalid type"),
        ("radius = 1\n", "radius = -2\n", "schwarzschild_radius must not be negative"),
        ("radius = 1\n", "radius = inf\n", "schwarzschild_radius must be finite"),
        ("schwarzschild_radius = 1\n", "", "needs the Schwarzschild radius"),
        ("kind = \"schwarzschild\"", "kind = \"reissner-nordstrom\"", "needs the charge Q/M"),
        (
            "kind = \"schwarzschild\"",
            "kind = \"reissner-nordstrom\"\ncharge = -1.01",
            "charge must be from -1 to 1, not -1.01: a hole of more charge than mass",
        ),
        ("kind = \"schwarzschild\"", "kind = \"schwarzchild\"", "did you mean `schwarzschild`?"),
        ("schwarzschild_radius = 1", "schwarzschild_radius = 1\ncharg = 1", "did you mean `charge`?"),
        ("center = [3, 0, 0]", "center = [3, inf, 0]", "center must be finite"),
        ("center = [3, 0, 0]", "center = [3, 0]", "invalid length 2"),
        ("albedo = 0.7", "albedo = [0.7, -1, 0]", "albedo must be between 0 and 1e18"),
        ("albedo = 0.7", "albedo = 1.5", "albedo must be at most 1"),
        ("albedo = 0.7", "albedo = [1, 1, 1, 1]", "three numbers"),
        ("albedo = 0.7", "ior = 1.5", "only a dielectric has an `ior`"),
        ("albedo = 0.7", "kind = \"dielectric\"\nior = 0", "ior must be positive"),
        ("albedo = 0.7", "roughness = 0.5", "only a principled material has `roughness`"),
        ("albedo = 0.7", "kind = \"principled\"\nmetallic = 1.5", "metallic must be from 0 to 1"),
        ("albedo = 0.7", "kind = \"principled\"\nior = 0.5", "ior must be from 1 to 100"),
        ("albedo = 0.7", "kind = \"principled\"\nsheen_color = 2", "sheen_color must be at most 1"),
        ("albedo = 0.7", "attenuation_color = 0.5", "so it has no `attenuation_color`"),
        ("albedo = 0.7", "kind = \"dielectric\"\nattenuation_distance = 2", "is given without a colour"),
        ("albedo = 0.7", "emission = -3", "emission must be between 0 and 1e18"),
        ("vertical_fov = 40", "vertical_fov = 180", "vertical_fov must be between 0 and 180"),
        ("vertical_fov = 40\n", "", "a perspective camera needs `vertical_fov`"),
        ("vertical_fov = 40", "projection = \"orthographic\"", "an orthographic camera needs `height`"),
        ("vertical_fov = 40", "projection = \"orthographic\"\nheight = 0", "height must be positive"),
        ("vertical_fov = 40", "projection = \"fish-eye\"", "did you mean `fisheye`?"),
        ("vertical_fov = 40", "projection = \"fisheye\"\nfov = 400", "fov must be from 0.01 to 360"),
        ("vertical_fov = 40", "vertical_fov = 40\naperture = -1", "aperture must not be negative"),
        ("vertical_fov = 40", "vertical_fov = 40\naperture = 1\nblades = 2", "2 blades leave no opening"),
        ("vertical_fov = 40", "vertical_fov = 40\nfocus_distance = 0", "focus_distance must be positive"),
        (
            "vertical_fov = 40",
            "vertical_fov = 40\naperture = 1\nfocus_distance = 1e-300",
            "a lens of radius 1 cannot focus",
        ),
        (
            "look_at = [0, 0, 0]",
            "direction = [0, 0, -1]\naperture = 1",
            "a lens needs the distance that is in focus",
        ),
        // Through the hole go the ends of the picture plane, the rim of the lens, and the near sphere.
        (
            "position = [0, 0, 10]\nlook_at = [0, 0, 0]\nvertical_fov = 40",
            "position = [3, 0, 0]\ndirection = [0, 0, -1]\nprojection = \"orthographic\"\nheight = 5",
            "rays of the camera start inside the black hole",
        ),
        (
            "position = [0, 0, 10]\nlook_at = [0, 0, 0]",
            "position = [0, 2, 0]\ndirection = [0, 0, -1]\naperture = 3\nfocus_distance = 1",
            "rays of the camera start inside the black hole",
        ),
        (
            "look_at = [0, 0, 0]\nvertical_fov = 40",
            "direction = [1, 0, 0]\nprojection = \"equirectangular\"\nnear = 10",
            "rays of the camera start inside the black hole",
        ),
        ("look_at = [0, 0, 0]", "look_at = [0, 0, 10]", "look_at equals position"),
        ("look_at = [0, 0, 0]", "direction = [0, 0, 0]", "direction has no direction"),
        ("look_at = [0, 0, 0]", "direction = [0, 1, 0]", "looks along its own `up`"),
        ("look_at = [0, 0, 0]\n", "", "the camera has no view direction"),
        ("position = [0, 0, 10]\n", "", "`look_at` needs `position`"),
        (
            "position = [0, 0, 10]\nlook_at = [0, 0, 0]\n",
            "",
            "no glTF file brings a camera that this could change",
        ),
        ("position = [0, 0, 10]", "position = [0, 0, 0.2]", "inside the black hole"),
        ("width = 64", "width = 0", "width must be between 1 and"),
        ("width = 64", "width = -64", "invalid value"),
        ("width = 64\nheight = 48", "width = 65536\nheight = 65536", "too large"),
        ("spp = 4", "spp = 0", "spp must be between 1 and 2147483648, not 0"),
        ("spp = 4", "spp = 99999999999", "spp must be between 1 and 2147483648, not 99999999999"),
        ("spp = 4", "max_depth = 0", "max_depth must be between 1 and 65535"),
        ("spp = 4", "max_depth = 65536", "max_depth must be between 1 and 65535"),
        ("spp = 4", "tolerance = 0", "tolerance must be between 0 and 1"),
        ("color = [1, 1, 1]", "color = [1, 1, 1]\nkind = \"sky\"", "exclude each other"),
        ("color = [1, 1, 1]", "color = 1\nrotation = 3", "`rotation` is for an `image`"),
        ("color = [1, 1, 1]", "image = \"gone.exr\"", "gone.exr: cannot be read"),
        ("color = [1, 1, 1]", "strength = -1", "strength must not be negative"),
        ("color = [1, 1, 1]", "strength = 1e30", "strength must be finite and at most 1e18"),
        ("position = [0, 0, 10]", "position = [0, 0, 1e30]", "position must be finite and at most 1e18"),
        ("center = [0, 0, 0]", "center = [0, 0, 1e30]", "center must be finite and at most 1e18"),
        ("sphere = { center = [3, 0, 0], radius = 1 }", "mesh = \"a.glb\"", "`mesh` reads OBJ files"),
        ("sphere = { center = [3, 0, 0], radius = 1 }", "gltf = \"a.OBJ\"", "`gltf` reads glTF files"),
        ("material = \"porcelain\"", "transform = { scale = 0 }", "scale must be finite and not 0"),
        ("material = \"porcelain\"", "transform = { scale = [1, 2, 1] }", "cannot be scaled differently"),
        ("material = \"porcelain\"", "transform = { scale = 1e30 }", "farther than 1e18"),
        ("material = \"porcelain\"", "transform = { scale = 1e300 }", "flattens it or is not finite"),
        (
            "material = \"porcelain\"",
            "transform = { rotate = { axis = [0, 0, 0], angle = 1 } }",
            "the axis has no direction",
        ),
        ("material = \"porcelain\"", "mesh = \"gone.obj\"", "more than one shape"),
        ("sphere = { center = [3, 0, 0], radius = 1 }\n", "", "the entity has no shape"),
        ("sphere = { center = [3, 0, 0], radius = 1 }", "mesh = \"gone.obj\"", "gone.obj: cannot be read"),
        (
            "sphere = { center = [3, 0, 0], radius = 1 }",
            "disk = { center = [0, 0, 0], normal = [0, 1, 0], inner = 3, outer = 2 }",
            "the inner radius 3 is not less than the outer one, 2",
        ),
        (
            "sphere = { center = [3, 0, 0], radius = 1 }",
            "disk = { center = [0, 0, 0], normal = [0, 0, 0], outer = 2 }",
            "normal has no direction",
        ),
        (
            "[[entity]]",
            "[[material]]\nname = \"porcelain\"\n\n[[entity]]",
            "a second material is named `porcelain`",
        ),
        ("material = \"porcelain\"", "light_scale = 1", "`light_scale` is for a `gltf`"),
        (
            "sphere = { center = [3, 0, 0], radius = 1 }\nmaterial = \"porcelain\"",
            "gltf = \"gone.glb\"\nlight_scale = -1",
            "light_scale must not be negative",
        ),
    ] {
        assert_located(from, to, &[expected]);
    }
}

#[test]
fn lights_without_meaning_show_their_line() {
    let shape = "sphere = { center = [3, 0, 0], radius = 1 }\nmaterial = \"porcelain\"\n";
    for (light, expected) in [
        ("kind = \"point\", intensity = 1", "a point light needs `position`"),
        ("kind = \"point\", position = [0, 5, 0]", "a point light needs `intensity`"),
        ("kind = \"spot\", position = [0, 5, 0], intensity = 1", "a spot light needs `direction`"),
        ("kind = \"distant\", direction = [0, 1, 0]", "a distant light needs `irradiance`"),
        ("position = [0, 5, 0], intensity = 1", "missing field `kind`"),
        ("kind = \"pont\", position = [0, 5, 0], intensity = 1", "did you mean `point`?"),
        ("kind = \"point\", positon = [0, 5, 0], intensity = 1", "did you mean `position`?"),
        ("kind = \"point\", position = [0, 5, 0], intensity = -1", "intensity must be between 0 and 1e18"),
        ("kind = \"point\", position = [0, inf, 0], intensity = 1", "position must be finite"),
        ("kind = \"distant\", direction = [0, 0, 0], irradiance = 1", "direction has no direction"),
        (
            "kind = \"point\", position = [0, 5, 0], intensity = 1, direction = [0, 1, 0]",
            "a point light has no `direction`\n",
        ),
        (
            "kind = \"distant\", direction = [0, 1, 0], intensity = 1",
            "help: remove it; beside `kind` there are `direction`, `irradiance`",
        ),
        (
            "kind = \"point\", position = [0, 5, 0], intensity = 1, outer_angle = 3",
            "a point light has no `outer_angle`",
        ),
        (
            "kind = \"spot\", position = [0, 5, 0], direction = [0, -1, 0], intensity = 1, outer_angle = 91",
            "outer_angle must be at most 90, not 91",
        ),
        (
            "kind = \"spot\", position = [0, 5, 0], direction = [0, -1, 0], intensity = 1, inner_angle = 46",
            "the inner angle 46 is greater than the outer one, 45",
        ),
        (
            "kind = \"spot\", position = [0, 5, 0], direction = [0, -1, 0], intensity = 1, inner_angle = -1",
            "inner_angle must not be negative",
        ),
    ] {
        assert_located(shape, &format!("light = {{ {light} }}\n"), &[expected]);
    }
    let light = "light = { kind = \"point\", position = [0, 5, 0], intensity = 1 }\n";
    for (also, expected) in [
        ("material = \"porcelain\"\n", "a `light` has no surface, so no `material`"),
        ("emission = 3\n", "a `light` has no surface, so no `emission`"),
        ("light_scale = 1\n", "`light_scale` is for a `gltf`"),
        ("mesh = \"gone.obj\"\n", "more than one shape"),
        ("transform = { translate = [9e17, 0, 0], scale = 3e17 }\n", "position or direction is not usable"),
    ] {
        assert_located(shape, &format!("{light}{also}"), &[expected]);
    }
}

#[test]
fn an_empty_scene_says_what_to_add() {
    for text in ["", "[film]\nwidth = 10\n", "[environment]\ncolor = 0\n"] {
        let message = failure(load_text(text));
        assert!(message.contains("the scene is empty"), "{message}");
    }
    let light = "[[entity]]\nlight = { kind = \"point\", position = [0, 0, 0], intensity = 1 }\n";
    let message = failure(load_text(light));
    assert!(message.contains("the scene is empty"), "{message}");
}

#[test]
fn a_lit_environment_alone_is_a_scene() {
    let text = GOOD.split("[[entity]]").next().unwrap();
    assert!(load_text(text).is_ok());
}

#[test]
fn a_scene_without_light_is_a_warning() {
    let baked = load_text(&GOOD.replace("color = [1, 1, 1]", "color = 0")).ok().unwrap();
    assert_eq!(baked.warnings, ["nothing emits light: the picture will be black"]);
}

#[test]
fn a_light_without_extent_is_light() {
    let dark = GOOD.replace("color = [1, 1, 1]", "color = 0");
    for (intensity, warnings) in [(1, 0), (0, 1)] {
        let light = format!("light = {{ kind = \"point\", position = [0, 5, 0], intensity = {intensity} }}");
        let baked = load_text(&format!("{dark}\n[[entity]]\n{light}\n")).ok().unwrap();
        assert_eq!((baked.punctual.len(), baked.warnings.len()), (1, warnings), "{:?}", baked.warnings);
    }
}

#[test]
fn damaged_obj_files_name_the_line() {
    let files = Files::new();
    for (text, expected) in [
        ("v 0 0 0\nv nan 0 0\n", "model.obj: line 2: the vertex is not finite"),
        ("v 0 0 0\nv 1e999 0 0\n", "model.obj: line 2: the vertex is not finite"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "model.obj: line 4: vertex index 4 is out of range"),
        ("v 0 0 0\nf 1 1 1\n", "holds no triangles with an area"),
        ("", "holds no triangles"),
        ("\u{0}\u{1}f \u{fffd}", "holds no triangles"),
    ] {
        let path = files.write("model.obj", text);
        let message = failure(load_path(&path));
        assert!(message.contains(expected), "{message}");
        let scene = files.write("scene.toml", "[[entity]]\nmesh = \"model.obj\"\n");
        let message = failure(load_path(&scene));
        assert!(message.contains("scene.toml:2:8") && message.contains(expected), "{message}");
    }
}

#[test]
fn degenerate_triangles_are_one_warning_with_their_count() {
    let files = Files::new();
    let path = files.write("model.obj", format!("{TRIANGLE}f 1 1 2\nf 1 2 2\n"));
    let baked = load_path(&path).ok().unwrap();
    assert_eq!(baked.warnings.len(), 1);
    assert!(
        baked.warnings[0].contains("degenerate (zero-area) triangles dropped: 2"),
        "{:?}",
        baked.warnings
    );
}

#[test]
fn damaged_binary_gltf_files_are_errors() {
    let whole = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/room.glb")).unwrap();
    let files = Files::new();
    for length in [0, 3, 11, 12, 19, 20, 1000, whole.len() / 2, whole.len() - 1] {
        let message = failure(load_path(&files.write("room.glb", &whole[..length])));
        assert!(message.contains("room.glb: "), "{message}");
    }
    let message = failure(load_path(&files.write("room.glb", &whole[..1000])));
    assert!(message.contains("cut off"), "{message}");
}

#[test]
fn bad_overrides_name_themselves() {
    for (text, expected) in [
        ("spp", "not of the form path.to.key=value"),
        ("entity.bal.emission=1", "did you mean `ball`?"),
        ("entity.4.emission=1", "`entity` has 1 entries"),
        ("camera.position.x=1", "`position` is a value without keys"),
        ("camera.position=[1, 2", "is not a TOML value"),
    ] {
        let message = failure(load_with(GOOD, &[text]));
        assert!(message.starts_with(&format!("--set {text}: ")) && message.contains(expected), "{message}");
    }
    let message = failure(load_with(GOOD, &["entity.ball.emision=1"]));
    assert!(message.contains("did you mean `emission`?") && message.contains("--set"), "{message}");
    let message = failure(load_with(GOOD, &["entity.0.sphere.radius=-1"]));
    assert!(message.contains("radius must be positive") && message.contains("--set"), "{message}");
}

#[test]
fn overrides_change_the_scene() {
    let baked =
        load_with(GOOD, &["film.width=32", "render.sampler=independent", "material.0.albedo=[0.1,0.2,0.3]"])
            .unwrap_or_else(|message| panic!("{message}"));
    assert_eq!(baked.settings.width, 32);
    assert_eq!(baked.settings.sampler, warpfront::scene::SamplerKind::Independent);
    assert_eq!(baked.materials[0].albedo(), glam::Vec3::new(0.1, 0.2, 0.3));
}

fn load_with_hole(path: &Path, [x, y, z, radius]: [f64; 4]) -> Result<Baked, SceneError> {
    scene::load_with(
        path,
        &LoadOptions { black_hole: Some([x, y, z, radius, 0.0]), ..LoadOptions::default() },
    )
}

#[test]
fn unusable_black_holes_are_errors() {
    let files = Files::new();
    let path = files.write("model.obj", TRIANGLE);
    for hole in [[0.0, 0.0, 0.0, -1.0], [f64::NAN, 0.0, 0.0, 1.0]] {
        let message = failure(load_with_hole(&path, hole).map_err(|error| error.to_string()));
        assert!(message.contains("X,Y,Z,RS"), "{message}");
    }
    let huge = load_with_hole(&path, [0.0, 0.0, 0.0, 1e3]).map_err(|error| error.to_string());
    assert!(failure(huge).contains("inside the black hole"));
}

#[test]
fn arbitrary_text_never_panics() {
    for cut in (0..GOOD.len()).filter(|cut| GOOD.is_char_boundary(*cut)) {
        let _ = load_text(&GOOD[..cut]);
        let _ = load_text(&GOOD[cut..]);
        let _ = load_text(&format!("{}\u{e9}{}", &GOOD[..cut], &GOOD[cut..]));
    }
}

#[test]
fn things_at_rest_in_an_ergosphere_are_errors_that_name_them() {
    let scene = |shape: &str, camera: &str| {
        format!(
            "[spacetime]\nkind = \"kerr\"\nschwarzschild_radius = 2\nspin = 0.9\n[camera]\nposition = {camera}\nlook_at = [0, 0, 0]\nvertical_fov = 40\n\
             [environment]\n[[material]]\nname = \"m\"\n[[entity]]\nname = \"thing\"\nmaterial = \"m\"\n{shape}\n"
        )
    };
    let write = |text: &str| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, text).unwrap();
        scene::load(&path, &[])
    };
    let far = "[0, 0, 9]";
    for shape in [
        "sphere = { center = [2, 0, 0], radius = 0.3 }",
        "sphere = { center = [0, 0, 0], radius = 2.1 }",
        "disk = { center = [0, 0, 0], normal = [0, 1, 0], inner = 2, outer = 9 }",
    ] {
        let message = write(&scene(shape, far)).err().unwrap().to_string();
        assert!(message.contains("ergosphere") && message.contains("thing"), "{message}");
    }
    let camera = write(&scene("sphere = { center = [9, 0, 0], radius = 1 }", "[2, 0, 0.3]"));
    assert!(camera.err().unwrap().to_string().contains("ergosphere"));
    for shape in [
        "sphere = { center = [0, 0, 0], radius = 2.3 }",
        "sphere = { center = [0, 1.9, 0], radius = 0.2 }",
        "disk = { center = [0, 0, 0], normal = [0, 1, 0], inner = 2.3, outer = 9 }",
    ] {
        assert!(write(&scene(shape, far)).is_ok(), "{shape}");
    }
}

#[test]
fn several_holes_and_lenses_are_checked_and_shown() {
    let spoilt = |kind: &str, list: &str, expected: &[&str]| {
        let old = "kind = \"schwarzschild\"\ncenter = [0, 0, 0]\nschwarzschild_radius = 1\n";
        assert_located(old, &format!("kind = \"{kind}\"\n{list}"), expected);
    };
    let hole = |center: &str, mass: &str| format!("[[spacetime.hole]]\ncenter = {center}\nmass = {mass}\n");
    let good = hole("[1, 2, 3]", "0.5");
    for (list, expected) in [
        (String::new(), "needs holes"),
        (hole("[1, 2, 3]", "0"), "mass must be positive"),
        (hole("[1, 2, 3]", "-1"), "mass must be positive"),
        (hole("[1, 2, inf]", "1"), "center must be finite"),
        (good.clone() + &hole("[1, 2, 3]", "2"), "a second hole is at [1.0, 2.0, 3.0]"),
        (good.clone() + "masss = 1\n", "did you mean `mass`?"),
        ("[[spacetime.hole]]\ncenter = [1, 2, 3]\n".to_owned(), "missing field `mass`"),
    ] {
        spoilt("several-holes", &list, &[expected]);
    }
    let lens = |keys: &str| format!("[[spacetime.lens]]\ncenter = [1, 2, 3]\n{keys}\n");
    let gaussian = lens("kind = \"gaussian\"\nwidth = 1\namplitude = -0.6");
    for (list, expected) in [
        (String::new(), "needs lenses"),
        (lens("kind = \"gaussian\"\nwidth = 1"), "a gaussian lens needs `amplitude`"),
        (lens("kind = \"luneburg\""), "a luneburg lens needs `radius`"),
        (lens("kind = \"luneburg\"\nradius = 1\nwidth = 2"), "a luneburg lens has no `width`"),
        (lens("kind = \"luneburg\"\nradius = 0"), "radius must be positive"),
        (gaussian.clone() + &gaussian, "the index of refraction may fall to"),
        (gaussian.clone() + &lens("kind = \"luneburg\"\nradius = 1"), "the lens touches that at"),
        (lens("kind = \"gausian\"\nwidth = 1"), "did you mean `gaussian`?"),
    ] {
        spoilt("lenses", &list, &[expected]);
    }
    let two = GOOD.replacen("kind = \"schwarzschild\"", "kind = \"several-holes\"", 1);
    let two = two.replacen("schwarzschild_radius = 1\n", &good, 1).replacen("center = [0, 0, 0]\n", "", 1);
    assert_eq!(load_text(&two).unwrap().warnings, Vec::<String>::new());
    let unused =
        GOOD.replacen("schwarzschild_radius = 1\n", &("schwarzschild_radius = 1\n".to_owned() + &good), 1);
    assert_eq!(load_text(&unused).unwrap().warnings.len(), 1);
}
