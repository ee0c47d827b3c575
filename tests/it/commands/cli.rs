//! The command as a user meets it: exit codes, messages, and the files that are left.

use std::fs;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use crate::support::command::{Folder, assert_good, assert_refused, names, stderr, stdout};

const SCENE: &str = "
[camera]
position = [0, 0, 5]
look_at = [0, 0, 0]
vertical_fov = 40
[film]
width = 16
height = 12
[environment]
color = [1, 1, 1]
[[entity]]
sphere = { center = [0, 0, 0], radius = 1 }
";

fn folder() -> Folder {
    Folder::with(&[("scene.toml", SCENE)])
}

fn render(place: &Folder, flags: &[&str]) -> Output {
    place.run(&[&["render", "scene.toml", "-o", "out.exr"], flags].concat())
}

/// A small file system of its own at a new folder.
#[cfg(target_os = "linux")]
struct Mount(PathBuf);

#[cfg(target_os = "linux")]
impl Mount {
    /// `None`, with a note, where mounting is not permitted.
    fn new(folder: PathBuf, options: &str) -> Option<Self> {
        fs::create_dir(&folder).unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(&folder).stderr(Stdio::null());
        if mount.status().is_ok_and(|status| status.success()) {
            return Some(Self(folder));
        }
        println!("skipped: mounting a file system is not permitted here");
        None
    }
}

#[cfg(target_os = "linux")]
impl Drop for Mount {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[test]
fn bad_flags_are_refused_with_the_flag_the_value_and_a_remedy() {
    let place = folder();
    let cases: &[(&[&str], &[&str])] = &[
        (&["--no-such-flag"], &["--no-such-flag"]),
        (&["--size", "0x480"], &["--size", "0x480", "640x480"]),
        (&["--size", "640"], &["--size", "'640'", "640x480"]),
        (&["--size", "99999999x99999999"], &["--size", "65536"]),
        (&["--spp", "0"], &["--spp", "'0'", "from 1"]),
        (&["--spp", "-4"], &["--spp", "'-4'", "from 1"]),
        (&["--spp", "many"], &["--spp", "'many'", "whole number"]),
        (&["--spp", "4", "--spp", "5"], &["--spp", "multiple times"]),
        (&["--max-depth", "0"], &["--max-depth", "'0'"]),
        (&["--max-depth", "65536"], &["--max-depth", "'65536'", "65535"]),
        (&["--tolerance", "-1e-3"], &["--tolerance", "-1e-3", "above 0"]),
        (&["--tolerance", "nan"], &["--tolerance", "nan"]),
        (&["--arc-tolerance", "0"], &["--arc-tolerance", "above 0"]),
        (&["--quality", "best"], &["--quality", "best", "draft", "standard", "reference"]),
        (&["--stepper", "euler"], &["--stepper", "euler", "rkn4"]),
        (&["--schedule", "x"], &["--schedule", "wavefront", "per-pixel"]),
        (&["--filter", "x"], &["--filter", "tent"]),
        (&["--sampler", "x"], &["--sampler", "sobol"]),
        (&["--seed", "-1"], &["--seed", "-1", "whole number"]),
        (&["--threads", "-1"], &["--threads", "-1"]),
        (&["--threads", "1000000"], &["--threads", "1024"]),
        (&["--batch", "0"], &["--batch", "'0'"]),
        (&["--time-limit", "90"], &["--time-limit", "90s"]),
        (&["--time-limit", "0s"], &["--time-limit", "above 0"]),
        (&["--noise", "-0.1"], &["--noise", "-0.1"]),
        (&["--exposure", "inf"], &["--exposure", "inf", "stops"]),
        (&["--aov", "depth,colour"], &["--aov", "colour", "albedo"]),
        (&["--crop", "0,0,8"], &["--crop", "0,0,8", "X0,Y0,X1,Y1"]),
        (&["--crop", "-5,0,8,8"], &["--crop", "-5,0,8,8"]),
        (&["--crop", "8,0,8,8"], &["--crop", "empty"]),
        (&["--set", "camera"], &["--set", "camera", "key=value"]),
        (&["--black-hole", "0,0,0"], &["--black-hole", "X,Y,Z,RS"]),
        (&["--black-hole", "0,0,0,-1"], &["--black-hole", "radius above 0"]),
        (&["--png", "out.jpg"], &["--png", "out.jpg", ".png"]),
        (&["--png", "a.png", "--no-png"], &["--png", "--no-png"]),
        (&["--stats", "scene.toml"], &["--stats", "scene.toml", ".json"]),
    ];
    for (flags, said) in cases {
        assert_refused(&render(&place, flags), said);
        assert!(
            place.files_but("scene.toml").is_empty(),
            "{flags:?} left {:?}",
            place.files_but("scene.toml")
        );
    }
}

#[test]
fn an_unknown_subcommand_is_refused() {
    assert_refused(&folder().run(&["rendr", "scene.toml"]), &["rendr", "render"]);
}

#[test]
fn the_output_ends_in_exr() {
    let place = folder();
    for name in ["out", "out.png", ".exr", "out.exr/", ""] {
        assert_refused(&place.run(&["render", "scene.toml", "-o", name]), &["--output"]);
    }
    assert!(place.files_but("scene.toml").is_empty());
}

#[test]
fn a_picture_without_a_name_is_called_like_its_scene_in_the_current_folder() {
    let place = folder();
    fs::create_dir(place.path("models")).unwrap();
    fs::rename(place.path("scene.toml"), place.path("models/room.v2.toml")).unwrap();
    let output = place.run(&["render", "models/room.v2.toml", "--spp", "1"]);
    assert_good(&output);
    assert!(stderr(&output).contains("wrote room.v2.exr, room.v2.png"), "{}", stderr(&output));
    assert_eq!(place.files_but("scene.toml"), ["models", "room.v2.exr", "room.v2.png"]);
    assert_eq!(names(&place.path("models")), ["room.v2.toml"]);
}

#[test]
fn flags_of_other_programs_get_the_flag_that_does_their_job() {
    let place = folder();
    let cases: &[(&[&str], &str)] = &[
        (&["--samples", "64"], "'--spp N'"),
        (&["--samples=64"], "'--spp N'"),
        (&["-s", "64"], "'--spp N'"),
        (&["--fov", "50"], "--set camera.vertical_fov=50"),
        (&["--width", "640"], "'--size WIDTHxHEIGHT'"),
        (&["--resolution", "640", "480"], "'--size WIDTHxHEIGHT'"),
        (&["--output-file", "a.exr"], "'--output FILE'"),
        (&["--denoise"], "--aov albedo,normal,variance"),
        (&["--gpu"], "CPU"),
        (&["--bounces", "8"], "'--max-depth N'"),
        (&["--hole", "0,0,0,1"], "'--black-hole X,Y,Z,RS'"),
        (&["-t", "4"], "'--threads N'"),
        (&["--nthreads", "4"], "'--threads N'"),
        (&["--timeout", "60"], "'--time-limit TIME'"),
        (&["--verbose"], "'--stats FILE.json'"),
        (&["--film-transparent"], "'--background transparent'"),
        (&["--passes", "depth"], "'--aov LIST'"),
        (&["--region", "0,0,1,1"], "'--crop X0,Y0,X1,Y1'"),
        (&["-D", "a=b"], "'--set KEY=VALUE'"),
    ];
    for (flags, said) in cases {
        let output = render(&place, flags);
        assert_refused(&output, &[said, "tip: "]);
        assert_eq!(stderr(&output).matches("tip: ").count(), 1, "{}", stderr(&output));
    }
    // A slip of the pen keeps clap's own suggestion, and a subcommand without the flag gets no advice to use it.
    assert_refused(&render(&place, &["--sise", "4x4"]), &["'--size'"]);
    let output = place.run(&["compare", "a.exr", "b.exr", "--samples", "4"]);
    assert!(!stderr(&output).contains("--spp"), "{}", stderr(&output));
    assert_refused(&place.run(&["scene.toml", "-o", "out.exr"]), &["'warpfront render scene.toml'"]);
}

#[test]
fn files_that_are_no_scenes_are_told_how_to_become_one() {
    let place = folder();
    let cases = [
        ("room.blend", "a Blender file, not a scene file", "File › Export › glTF 2.0"),
        ("room.fbx", "an FBX file", "glTF"),
        ("ROOM.USDZ", "a USD file", "glTF"),
        ("room.usda", "a USD file", "glTF"),
        ("room.dae", "a COLLADA file", "glTF"),
        ("room.stl", "an STL file", "glTF"),
        ("room.ply", "a PLY file", "glTF"),
        ("room.abc", "an Alembic file", "glTF"),
        ("room.3ds", "a 3DS file", "glTF"),
        ("room.max", "a 3ds Max file", "glTF"),
        ("room.mb", "a Maya file", "glTF"),
        ("room.c4d", "a Cinema 4D file", "glTF"),
        ("room.exr", "a picture, not a scene file", "`warpfront compare`"),
        ("room.png", "a picture", "`[environment] image"),
        ("room.zip", "an archive", "unpack"),
        ("room.toml.txt", "a text file", ".toml"),
        ("room", "not a scene file", ".glb"),
        (".", "a folder, not a scene file", ".glb"),
    ];
    for (name, what, remedy) in cases {
        for command in ["render", "info"] {
            assert_refused(&place.run(&[command, name]), &[name, what, "help: ", remedy]);
        }
    }
    for key in ["mesh", "gltf"] {
        let entity = format!("{SCENE}[[entity]]\n{key} = \"room.blend\"\n");
        fs::write(place.path("scene.toml"), entity).unwrap();
        let reads = format!("`{key}` reads");
        let said = ["scene.toml:14:", &reads, "a Blender file", "File › Export › glTF 2.0"];
        assert_refused(&render(&place, &[]), &said);
    }
    assert!(place.files_but("scene.toml").is_empty());
}

#[test]
fn completions_and_manual_pages_know_all_flags() {
    let place = folder();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = place.run(&["completions", shell]);
        assert_good(&output);
        assert!(stdout(&output).contains("black-hole"), "{shell}");
    }
    let page = place.run(&["man"]);
    assert_good(&page);
    assert!(stdout(&page).contains(".TH warpfront 1") && stdout(&page).contains("Exit codes"));
    let page = stdout(&place.run(&["man", "render"]));
    assert!(page.contains("warpfront\\-render") && page.contains("black\\-hole"), "{page}");
    assert_refused(&place.run(&["man", "rendr"]), &["`rendr`", "render"]);
    fs::create_dir(place.path("man1")).unwrap();
    assert_good(&place.run(&["man", "-o", "man1"]));
    let pages = names(&place.path("man1"));
    assert!(pages.contains(&"warpfront.1".to_owned()) && pages.contains(&"warpfront-render.1".to_owned()));
    assert_eq!(pages.len(), 11, "{pages:?}");
    assert_refused(&place.run(&["man", "-o", "nowhere"]), &["nowhere", "help:"]);
}

#[test]
fn all_planes_are_asked_for_at_once() {
    let place = folder();
    assert_good(&render(&place, &["--spp", "1", "--no-png", "--aov", "depth,all"]));
    let image = warpfront::film::read_exr(&place.path("out.exr")).unwrap();
    let planes: Vec<&str> = image.channels.iter().map(|plane| plane.name.as_str()).collect();
    for aov in
        ["depth.Z", "normal.X", "albedo.R", "position.X", "entity.ID", "variance.R", "steps.N", "fate.ID"]
    {
        assert_eq!(planes.iter().filter(|name| **name == aov).count(), 1, "{planes:?}");
    }
}

#[test]
fn a_transparent_background_has_no_alpha_in_the_picture_the_preview_and_by_every_way_to_ask_for_it() {
    let place = folder();
    let flags = ["--spp", "4", "--stats", "out.json"];
    let corner = || {
        let image = warpfront::film::read_exr(&place.path("out.exr")).unwrap();
        [image.channel("R").unwrap()[0], image.channel("A").unwrap()[0]]
    };
    assert_good(&render(&place, &flags));
    assert_eq!(corner(), [1.0, 1.0]);
    assert_eq!(image::open(place.path("out.png")).unwrap().color(), image::ColorType::Rgb8);
    for way in [["--background", "transparent"], ["--set", "film.background=transparent"]] {
        assert_good(&render(&place, &[&flags[..], &way].concat()));
        assert_eq!(corner(), [0.0, 0.0], "{way:?}");
        let preview = image::open(place.path("out.png")).unwrap();
        assert_eq!(preview.color(), image::ColorType::Rgba8);
        let preview = preview.to_rgba8();
        assert_eq!((preview.get_pixel(0, 0).0[3], preview.get_pixel(8, 6).0[3]), (0, 255));
        let stats: serde_json::Value =
            serde_json::from_slice(&fs::read(place.path("out.json")).unwrap()).unwrap();
        assert_eq!(stats["settings"]["background"], "transparent");
    }
    let refused = render(&place, &["--set", "film.background=clear"]);
    assert_refused(&refused, &["clear", "opaque", "transparent"]);
}

#[test]
fn info_warns_as_render_does() {
    let place = folder();
    fs::write(place.path("m.obj"), "l 1 2\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let warnings = |text: &str| -> Vec<String> {
        let rows = text.lines().filter(|line| line.starts_with("warning"));
        rows.map(|line| line.trim_start_matches("warning").trim_start_matches(':').trim().to_owned())
            .collect()
    };
    let info = warnings(&stdout(&place.run(&["info", "m.obj"])));
    let render = warnings(&stderr(&place.run(&["render", "m.obj", "--spp", "1", "--size", "8x6"])));
    assert!(!info.is_empty() && info == render, "{info:?} {render:?}");
}

#[test]
fn info_writes_numbers_as_people_do() {
    let place = folder();
    let hole = ["--black-hole", "0.30000000000000004,0,-1e-9,0.1", "--set", "camera.vertical_fov=39.59775"];
    let text = stdout(&place.run(&[&["info", "scene.toml"][..], &hole].concat()));
    for said in ["r_s 0.1 at (0.3, 0, -1e-9)", "horizon 0.025, photon sphere 0.0933", "field of view 39.6°"]
    {
        assert!(text.contains(said), "{text}\nlacks {said}");
    }
    let limited = ["--spp", "100000000", "--time-limit", "1s", "--noise", "0.01"];
    let text = stdout(&place.run(&[&["info", "scene.toml"][..], &limited].concat()));
    assert!(text.contains("--time-limit ends it after 1s") && text.contains("--noise 0.01"), "{text}");
}

#[test]
fn a_crop_outside_the_picture_is_refused() {
    let place = folder();
    assert_refused(&render(&place, &["--crop", "0,0,17,12"]), &["--crop 0,0,17,12", "16x12", "help:"]);
    assert!(place.files_but("scene.toml").is_empty());
}

#[test]
fn a_missing_scene_is_refused_by_name() {
    let place = folder();
    for arguments in [&["render", "none.toml", "-o", "out.exr"][..], &["info", "none.toml"]] {
        assert_refused(&place.run(arguments), &["none.toml"]);
    }
    assert!(place.files_but("scene.toml").is_empty());
}

#[test]
fn an_output_that_is_a_folder_is_refused() {
    let place = folder();
    fs::create_dir(place.path("taken.exr")).unwrap();
    let output = place.run(&["render", "scene.toml", "-o", "taken.exr"]);
    assert_refused(&output, &["`taken.exr`", "it is a folder", "help:"]);
    assert_eq!(place.files_but("scene.toml"), ["taken.exr"]);
}

#[test]
fn a_missing_output_folder_is_refused() {
    let place = folder();
    let cases = [
        (&["-o", "nowhere/out.exr"][..], "`nowhere/out.exr`"),
        (&["-o", "out.exr", "--png", "nowhere/out.png"], "`nowhere/out.png`"),
        (&["-o", "out.exr", "--stats", "nowhere/out.json"], "`nowhere/out.json`"),
    ];
    for (flags, named) in cases {
        let output = place.run(&[&["render", "scene.toml"], flags].concat());
        assert_refused(&output, &[named, "folder `nowhere` does not exist", "help:"]);
        assert!(place.files_but("scene.toml").is_empty());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_folder_that_is_read_only_is_refused() {
    let place = folder();
    let Some(_mount) = Mount::new(place.path("fixed"), "ro") else {
        return;
    };
    let output = place.run(&["render", "scene.toml", "-o", "fixed/out.exr"]);
    assert_refused(&output, &["`fixed/out.exr`", "read-only", "help:"]);
}

#[cfg(unix)]
#[test]
fn an_output_folder_without_permission_is_refused() {
    use std::os::unix::fs::PermissionsExt;

    let place = folder();
    let folder = place.path("closed");
    fs::create_dir(&folder).unwrap();
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(folder.join("probe"), "").is_ok() {
        println!("skipped: this user may write to any folder");
        return;
    }
    let output = place.run(&["render", "scene.toml", "-o", "closed/out.exr"]);
    assert_refused(&output, &["`closed/out.exr`", "no permission", "help:"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_without_room_for_another_file_is_refused_before_the_render() {
    let place = folder();
    let Some(mount) = Mount::new(place.path("full"), "nr_inodes=1") else {
        return;
    };
    let output = place.run(&["render", "scene.toml", "-o", "full/out.exr"]);
    assert_refused(&output, &["`full/out.exr`", "full", "help:"]);
    assert!(names(&mount.0).is_empty());
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_leaves_the_old_file_and_no_other() {
    let place = folder();
    let Some(mount) = Mount::new(place.path("small"), "size=4k") else {
        return;
    };
    fs::write(mount.0.join("out.exr"), "old").unwrap();
    let flags = ["--no-png", "--size", "200x200", "--spp", "1", "--aov", "position,normal"];
    let output = place.run(&[&["render", "scene.toml", "-o", "small/out.exr"], &flags[..]].concat());
    assert_refused(&output, &["`small/out.exr`", "full", "help:"]);
    assert_eq!(fs::read_to_string(mount.0.join("out.exr")).unwrap(), "old");
    assert_eq!(names(&mount.0), ["out.exr"]);
}

#[cfg(target_os = "linux")]
#[test]
fn arguments_that_are_not_unicode_do_no_harm() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let place = folder();
    let cases: &[(&[&str], &[u8], &str)] = &[
        (&["render", "none.toml", "-o"], b"\xff\xfe.exr", "none.toml"),
        (&["render", "scene.toml", "-o"], b"\xff/x.exr", "does not exist"),
        (&["info"], b"\xff.toml", ".toml"),
        (&["info", "scene.toml", "--set"], b"\xff=1", "UTF-8"),
    ];
    for (arguments, odd, said) in cases {
        let output = place.command(arguments).arg(OsStr::from_bytes(odd)).output().unwrap();
        assert_refused(&output, &[said]);
    }
    assert!(place.files_but("scene.toml").is_empty());
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let place = folder();
    for arguments in [&["info", "scene.toml"][..], &["--help"], &["render", "--help"]] {
        let mut command = place.command(arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let mut text = String::new();
        child.stderr.take().unwrap().read_to_string(&mut text).unwrap();
        assert!(child.wait().unwrap().success() && text.is_empty(), "{text}");
    }
}

#[test]
fn errors_that_nobody_reads_do_not_panic() {
    let place = folder();
    let mut child = place.command(&["info", "none.toml"]).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

#[test]
fn help_and_version_are_good() {
    for flag in ["--help", "--version"] {
        assert_good(&folder().run(&[flag]));
    }
}

#[test]
fn info_tells_what_the_scene_holds_and_why_stages_run() {
    let place = folder();
    let output = place.run(&["info", "scene.toml"]);
    assert_good(&output);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("flat") && text.contains("no marching") && text.contains("16x12"), "{text}");
    let output = place.run(&["info", "scene.toml", "--black-hole", "-3,0,0,0.5", "--json"]);
    assert_good(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["spacetime"]["kind"], "schwarzschild");
    assert_eq!(json["spacetime"]["center"][0], -3.0);
}

#[test]
fn info_foretells_the_render_that_its_flags_ask_for() {
    let place = folder();
    let flags = ["--spp", "32", "--threads", "1", "--crop", "4,2,12,8", "--aov", "depth"];
    let output = place.run(&[&["info", "scene.toml", "--json"][..], &flags].concat());
    assert_good(&output);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let cost = &json["cost"];
    assert_eq!((&cost["threads"], &cost["paths"]), (&1.into(), &(8 * 6 * 32).into()));
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or_else(|| panic!("{json:#}"));
    let parts = [&cost["learning"], &cost["sampling"]["value"], &cost["edges"]["value"]].map(number);
    assert!(parts.iter().all(|&seconds| seconds >= 0.0) && parts[1] > 0.0, "{cost}");
    let seconds = number(&cost["seconds"]["value"]);
    assert!((parts.iter().sum::<f64>() - seconds).abs() < 1e-9 * seconds, "{cost}");
    assert!(number(&cost["per_pixel_over_wavefront"]["value"]) > 0.0);
    let schedule = &json["schedule"];
    assert!(schedule.is_null() || schedule == "wavefront" || schedule == "per-pixel", "{schedule}");
    assert!(number(&json["memory"]["film"]) >= (8 * 6 * 32) as f64);

    let text = stdout(&place.run(&[&["info", "scene.toml"][..], &flags].concat()));
    let row = |label: &str| text.lines().find(|line| line.starts_with(label)).unwrap_or_default().to_owned();
    assert!(row("cost").contains("on 1 thread: ") && row("cost").contains("for 1.54 k paths"), "{text}");
    assert!(row("schedule").contains("wavefront") && row("schedule").contains("per-pixel"), "{text}");
    assert!(text.contains("AOVs       runs     depth"), "{text}");
    assert_refused(&place.run(&["info", "scene.toml", "--crop", "0,0,99,5"]), &["--crop", "16x12"]);
}

#[test]
fn a_render_writes_the_picture_its_preview_and_the_statistics() {
    let place = folder();
    let flags = ["--spp", "2", "--aov", "depth,normal", "--crop", "4,2,12,8", "--stats", "out.json"];
    let output = render(&place, &flags);
    assert_good(&output);
    assert_eq!(place.files_but("scene.toml"), ["out.exr", "out.json", "out.png"]);
    let summary = stderr(&output);
    assert!(summary.contains("2 spp") && summary.contains("wrote out.exr, out.png, out.json"), "{summary}");

    let image = warpfront::film::read_exr(&place.path("out.exr")).unwrap();
    assert_eq!((image.width, image.height, image.origin, image.size), (16, 12, (4, 2), (8, 6)));
    let planes: Vec<&str> = image.channels.iter().map(|plane| plane.name.as_str()).collect();
    assert_eq!(planes, ["R", "G", "B", "A", "depth.Z", "normal.X", "normal.Y", "normal.Z"]);
    let stats: serde_json::Value =
        serde_json::from_slice(&fs::read(place.path("out.json")).unwrap()).unwrap();
    assert_eq!(stats["settings"]["spp"], 2);
    assert!(stats["stats"]["seconds"].is_number());
}

#[test]
fn no_preview_is_written_when_none_is_wanted() {
    let place = folder();
    assert_good(&render(&place, &["--spp", "1", "--no-png", "--strict"]));
    assert_eq!(place.files_but("scene.toml"), ["out.exr"]);
}

/// Starts a render that takes minutes, and waits until it is at work.
#[cfg(unix)]
fn long_render(place: &Folder) -> std::process::Child {
    let flags = ["--no-png", "--threads", "1", "--size", "512x512", "--spp", "60000"];
    let mut command = place.command(&[&["render", "scene.toml", "-o", "out.exr"], &flags[..]].concat());
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_secs(3));
    child
}

#[cfg(unix)]
fn interrupt(child: &std::process::Child) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_writes_what_it_has_and_says_how_much_that_is() {
    let place = folder();
    let child = long_render(&place);
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    // Shells make 130 of it.
    assert_eq!(std::os::unix::process::ExitStatusExt::signal(&output.status), Some(2));
    assert!(stderr(&output).contains("of 60000 samples"), "{}", stderr(&output));
    assert_eq!(place.files_but("scene.toml"), ["out.exr"]);
}
