//! What the command reads and what it refuses to: names, encodings, folders, memory, and outputs that would replace
//! inputs.

use std::fs;
use std::process::Output;

use crate::support::command::{Folder, assert_good, assert_refused, stderr};
use exr::prelude::write_rgb_file;

const CAMERA: &str = "[camera]\nposition = [0, 0, 3]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n";
const SKY: &str = "[environment]\nimage = \"sky.exr\"\n";
/// A triangle, with a library and a texture that is not used.
const MODEL: &str = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";

/// A folder with `scene.toml` and its sky.
fn place() -> Folder {
    let place =
        Folder::with(&[("scene.toml", &format!("{CAMERA}{SKY}")), ("a.obj", MODEL), ("a.mtl", "newmtl a\n")]);
    write_rgb_file(place.path("sky.exr"), 4, 2, |_, _| (1.0f32, 1.0f32, 1.0f32)).unwrap();
    place
}

fn render(place: &Folder, scene: &str, flags: &[&str]) -> Output {
    let common = ["render", scene, "--size", "4x3", "--spp", "1", "--threads", "1"];
    place.run(&[&common, flags].concat())
}

#[test]
fn outputs_never_replace_what_the_scene_is_made_of() {
    let place = place();
    fs::rename(place.path("sky.exr"), place.path("sky.png.exr")).unwrap();
    write_rgb_file(place.path("sky.exr"), 4, 2, |_, _| (1.0f32, 1.0f32, 1.0f32)).unwrap();
    fs::create_dir(place.path("folder")).unwrap();
    let keep = |name: &str| fs::read(place.path(name)).unwrap();
    let before = keep("sky.exr");
    for flags in [
        &["-o", "sky.exr", "--no-png"][..],
        &["-o", "./folder/../sky.exr"],
        &["-o", "out.exr", "--stats", "scene.json", "--png", "other.png"],
    ] {
        let output = render(&place, "scene.toml", flags);
        if flags.contains(&"--stats") {
            assert_good(&output);
        } else {
            assert_refused(&output, &["sky.exr"]);
        }
    }
    assert_eq!(keep("sky.exr"), before);
    let table = "x,y,z,dx,dy,dz,rs\n9,0,0,-1,0,0,1\n";
    fs::write(place.path("rays.csv"), table).unwrap();
    let study = place.run(&["study", "--rays", "rays.csv", "-o", "rays"]);
    assert_refused(&study, &["rays.csv"]);
    assert_eq!(keep("rays.csv"), table.as_bytes());
}

#[test]
fn a_preview_does_not_replace_a_texture_even_one_that_is_not_read() {
    let place = place();
    let model = r#"{"asset": {"version": "2.0"}, "images": [{"uri": "room%20n.png"}], "textures": [{"source": 0}],
        "materials": [{"normalTexture": {"index": 0}}], "scene": 0, "scenes": [{"nodes": []}]}"#;
    fs::write(place.path("room.gltf"), model).unwrap();
    fs::write(place.path("room n.png"), "a normal map").unwrap();
    fs::write(place.path("room.toml"), format!("{CAMERA}{SKY}[[entity]]\ngltf = \"room.gltf\"\n")).unwrap();
    assert_refused(&render(&place, "room.toml", &["-o", "room n.exr"]), &["room n.png"]);
    assert_eq!(fs::read(place.path("room n.png")).unwrap(), b"a normal map");
    assert_good(&render(&place, "room.toml", &["-o", "room n.exr", "--no-png"]));
    fs::write(place.path("a.mtl"), "newmtl a\nmap_Bump -bm 0.2 bumps.png\n").unwrap();
    fs::write(place.path("bumps.png"), "bumps").unwrap();
    assert_refused(&render(&place, "a.obj", &["-o", "bumps.exr"]), &["bumps.png"]);
}

#[cfg(unix)]
#[test]
fn an_output_that_links_to_an_input_is_refused() {
    let place = place();
    std::os::unix::fs::symlink("sky.exr", place.path("link.exr")).unwrap();
    assert_refused(&render(&place, "scene.toml", &["-o", "link.exr", "--no-png"]), &["link.exr", "sky.exr"]);
    std::os::unix::fs::symlink("scene.toml", place.path("scene.json")).unwrap();
    let flags = ["-o", "out.exr", "--no-png", "--stats", "scene.json"];
    assert_refused(&render(&place, "scene.toml", &flags), &["scene.toml"]);
}

#[test]
fn confined_reads_stay_in_the_folder_of_the_scene() {
    let place = place();
    fs::create_dir(place.path("inner")).unwrap();
    let scene = format!("{CAMERA}[environment]\nimage = \"../sky.exr\"\n");
    fs::write(place.path("inner/scene.toml"), scene).unwrap();
    assert_good(&render(&place, "inner/scene.toml", &["-o", "out.exr"]));
    let confined = render(&place, "inner/scene.toml", &["-o", "out.exr", "--confine"]);
    assert_refused(&confined, &["sky.exr", "outside the folder", "inner"]);
    assert_good(&render(&place, "scene.toml", &["-o", "out.exr", "--confine"]));
    let info = place.run(&["info", "inner/scene.toml", "--confine"]);
    assert_refused(&info, &["sky.exr"]);
    fs::write(place.path("inner/a.obj"), MODEL.replace("a.mtl", "../a.mtl")).unwrap();
    let library = render(&place, "inner/a.obj", &["-o", "out.exr", "--confine"]);
    assert_good(&library);
    assert!(stderr(&library).contains("outside the folder"), "{}", stderr(&library));
}

#[test]
fn what_does_not_fit_in_the_memory_allowed_is_an_error() {
    let place = place();
    let flags = ["-o", "out.exr", "--no-png", "--max-memory", "1M"];
    let message = ["a picture of 4096 × 2048 pixels", "MiB", "--max-memory", "sky.exr"];
    write_rgb_file(place.path("sky.exr"), 4096, 2048, |_, _| (1.0f32, 1.0f32, 1.0f32)).unwrap();
    assert_refused(&render(&place, "scene.toml", &flags), &["sky.exr", "MiB of memory"]);
    let flags = ["-o", "out.exr", "--no-png", "--max-memory", "150M"];
    assert_refused(&render(&place, "scene.toml", &flags), &message);
    let compare = place.run(&["compare", "sky.exr", "sky.exr", "--max-memory", "100M"]);
    assert_refused(&compare, &["sky.exr", "--max-memory"]);
    let film = ["render", "a.obj", "-o", "out.exr", "--max-memory", "100M", "--size", "5000x5000"];
    let film = place.run(&film);
    assert_refused(&film, &["a film of 5000x5000 pixels", "--max-memory"]);
    assert_good(&render(&place, "a.obj", &["-o", "out.exr", "--max-memory", "2G"]));
}

#[test]
fn a_scene_in_another_encoding_is_said() {
    let place = place();
    let wide: Vec<u8> = format!("\u{feff}{CAMERA}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(place.path("wide.toml"), wide).unwrap();
    assert_refused(
        &render(&place, "wide.toml", &["-o", "out.exr"]),
        &["wide.toml", "UTF-16", "save it as UTF-8"],
    );
    let latin = [CAMERA.as_bytes(), b"# caf\xe9\n", SKY.as_bytes()].concat();
    fs::write(place.path("latin.toml"), latin).unwrap();
    assert_refused(&render(&place, "latin.toml", &["-o", "out.exr"]), &["latin.toml:5:6", "0xe9"]);
    fs::write(place.path("marked.toml"), format!("\u{feff}{CAMERA}{SKY}")).unwrap();
    assert_good(&render(&place, "marked.toml", &["-o", "out.exr"]));
}

#[cfg(target_os = "linux")]
#[test]
fn file_names_need_not_be_text() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let place = place();
    let model = OsStr::from_bytes(b"m\xff.obj");
    fs::copy(place.path("a.obj"), place.folder().join(model)).unwrap();
    let command = |scene: &OsStr| {
        let mut command = place.command(&["render"]);
        command.arg(scene).args(["--size", "4x3", "--spp", "1", "-o"]).arg(OsStr::from_bytes(b"o\xff.exr"));
        command.output().unwrap()
    };
    assert_good(&command(model));
    assert!(place.folder().join(OsStr::from_bytes(b"o\xff.exr")).exists());
    assert_refused(&command(OsStr::from_bytes(b"gone\xff.obj")), &["gone"]);
}

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_refused_wherever_a_file_is_read() {
    let place = place();
    let ground = "[[entity]]\ndisk = { center = [0, 0, 0], normal = [0, 1, 0], outer = 1 }\n";
    fs::write(place.path("lit.toml"), format!("{CAMERA}{SKY}{ground}")).unwrap();
    for arguments in [
        &["compare", "/dev/zero", "sky.exr"][..],
        &["compare", "sky.exr", "/dev/zero"],
        &["trace", "/dev/zero", "--spacetime", "flat"],
        &["connect", "/dev/zero"],
        &["study", "--rays", "/dev/zero", "-o", "x"],
        &[
            "study",
            "lit.toml",
            "-o",
            "x",
            "--light-sampling",
            "off",
            "--reference",
            "/dev/zero",
            "--size",
            "4x3",
        ],
    ] {
        assert_refused(&place.run(arguments), &["/dev/zero", "not a regular file"]);
    }
}
