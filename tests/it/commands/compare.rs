//! `warpfront compare` as a user meets it: the verdict on rendered pictures, the files, exit codes and messages.

use std::fs;
use std::process::Output;

use crate::support::command::{Folder, assert_code, assert_refused, stderr, stdout};
use warpfront::film::{Image, read_exr, write_exr};

/// A lit sphere on a floor: few paths find the lamp, so that there is noise.
const SCENE: &str = "
[camera]
position = [0, 1, 5]
look_at = [0, 0.5, 0]
vertical_fov = 40
[film]
width = 48
height = 36
[render]
spp = 32
[environment]
color = [0.1, 0.2, 0.3]
[[material]]
name = \"lamp\"
emission = 5
[[entity]]
sphere = { center = [0, 0.5, 0], radius = 0.5 }
[[entity]]
disk = { center = [0, 0, 0], normal = [0, 1, 0], outer = 3 }
[[entity]]
name = \"lamp\"
sphere = { center = [1.5, 2, 0], radius = 0.6 }
material = \"lamp\"
";

fn folder() -> Folder {
    Folder::with(&[("scene.toml", SCENE)])
}

/// With the pictures `a.exr` and `b.exr` of different seeds, with variances.
fn two_seeds() -> Folder {
    let place = folder();
    render(&place, "a.exr", &["--seed", "1", "--aov", "variance,depth"]);
    render(&place, "b.exr", &["--seed", "2", "--aov", "variance,depth"]);
    place
}

fn render(place: &Folder, name: &str, flags: &[&str]) {
    let output = place.run(&[&["render", "scene.toml", "--no-png", "-o", name], flags].concat());
    assert_code(&output, 0);
}

fn compare(place: &Folder, flags: &[&str]) -> Output {
    place.run(&[&["compare", "a.exr", "b.exr"], flags].concat())
}

fn as_json(place: &Folder, flags: &[&str]) -> serde_json::Value {
    let output = compare(place, &[&["--json"], flags].concat());
    assert_code(&output, 0);
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Reads a picture, lets `edit` change it, and writes it back.
fn edit(place: &Folder, name: &str, edit: impl Fn(&mut Image)) {
    let mut image = read_exr(&place.path(name)).unwrap();
    edit(&mut image);
    write_exr(&image, fs::File::create(place.path(name)).unwrap()).unwrap();
}

#[test]
fn two_seeds_of_a_scene_are_the_same_within_noise() {
    let place = two_seeds();
    let output = compare(&place, &["--strict"]);
    assert_code(&output, 0);
    let text = stdout(&output);
    assert!(text.contains("verdict      same within noise\n") && text.contains("depth.Z"), "{text}");
    let json = as_json(&place, &[]);
    assert_eq!((&json["a"], &json["verdict"]), (&"a.exr".into(), &"within-noise".into()));
    assert!(json["beauty"]["rmse"].as_f64().unwrap() > 0.0);
    assert_eq!(json["noise"]["same_seed"], false);
    assert_eq!(json["channels"].as_array().unwrap().len(), 8);
}

#[test]
fn a_changed_scene_differs() {
    let place = two_seeds();
    let flags = ["--seed", "3", "--aov", "variance", "--set", "environment.color=[0.1,0.2,0.33]"];
    render(&place, "b.exr", &flags);
    let output = compare(&place, &["--strict"]);
    assert_code(&output, 1);
    assert!(stdout(&output).contains("verdict      differ: so large a deviation"), "{}", stdout(&output));
    assert!(stdout(&output).contains("only in A    depth.Z\n"), "{}", stdout(&output));
    assert!(stderr(&output).contains("--strict"));
    let json = as_json(&place, &[]);
    assert_eq!((&json["verdict"], &json["only_a"][0]), (&"differ".into(), &"depth.Z".into()));
    assert_eq!(json["noise"]["largest"]["channel"], "B");
}

#[test]
fn a_picture_is_identical_with_itself() {
    let place = two_seeds();
    let output =
        place.run(&["compare", "a.exr", "a.exr", "--strict", "--max-rmse", "0", "--max-relmse", "0"]);
    assert_code(&output, 0);
    assert!(stdout(&output).contains("verdict      identical"), "{}", stdout(&output));
    assert!(stderr(&output).is_empty());
}

#[test]
fn without_variances_nothing_is_said_about_noise() {
    let place = folder();
    render(&place, "a.exr", &["--seed", "1"]);
    render(&place, "b.exr", &["--seed", "2", "--aov", "variance"]);
    let output = compare(&place, &[]);
    assert_code(&output, 0);
    assert!(stdout(&output).contains("--aov variance"), "{}", stdout(&output));
    assert_code(&compare(&place, &["--strict"]), 1);
    assert!(as_json(&place, &[])["noise"].is_null());
}

#[test]
fn a_shared_seed_is_told() {
    let place = folder();
    render(&place, "a.exr", &["--aov", "variance"]);
    render(&place, "b.exr", &["--aov", "variance", "--max-depth", "2"]);
    assert!(stdout(&compare(&place, &[])).contains("same seed"));
}

#[test]
fn differences_beyond_a_bound_are_exit_code_1() {
    let place = two_seeds();
    let rmse = as_json(&place, &[])["beauty"]["rmse"].as_f64().unwrap();
    assert_code(&compare(&place, &["--max-rmse", &(1.01 * rmse).to_string(), "--max-relmse", "1e6"]), 0);
    let output = compare(&place, &["--max-rmse", &(0.99 * rmse).to_string()]);
    assert_code(&output, 1);
    assert!(stderr(&output).contains("--max-rmse"), "{}", stderr(&output));
    assert_code(&compare(&place, &["--max-relmse", "1e-9"]), 1);
}

#[test]
fn the_difference_is_written_with_its_sign_and_its_picture() {
    let place = two_seeds();
    let output = compare(&place, &["-o", "diff.exr", "--png", "diff.png"]);
    assert_code(&output, 0);
    assert!(stderr(&output).contains("diff.exr") && stderr(&output).contains("logarithmic"));
    assert_eq!(place.files(), ["a.exr", "b.exr", "diff.exr", "diff.png", "scene.toml"]);
    let [a, b, difference] = ["a.exr", "b.exr", "diff.exr"].map(|name| read_exr(&place.path(name)).unwrap());
    let names = |image: &Image| image.channels.iter().map(|plane| plane.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&difference), names(&a));
    let pixel = |image: &Image| image.channel("G").unwrap()[700];
    assert_eq!(pixel(&difference), pixel(&a) - pixel(&b));
    let depth = difference.channel("depth.Z").unwrap();
    assert!(depth.iter().all(|value| !value.is_nan()) && depth[0] == 0.0);
    let png = image::open(place.path("diff.png")).unwrap();
    assert_eq!((png.width(), png.height()), (48, 36));
}

#[test]
fn values_that_are_not_finite_are_told_and_count_as_a_difference() {
    let place = two_seeds();
    edit(&place, "a.exr", |image| image.channels[0].values[5] = f32::NAN);
    let output = compare(&place, &["--max-rmse", "1e6"]);
    assert_code(&output, 1);
    let text = stdout(&output);
    assert!(text.contains("R: 1 pair is not finite, 1 of them unequal"), "{text}");
    // The sky, in both.
    assert!(text.contains("depth.Z: ") && text.contains("pairs are not finite"), "{text}");
    assert!(text.contains("verdict      differ: values that are not finite"), "{text}");
    assert_code(&compare(&place, &["--strict"]), 1);
    assert!(as_json(&place, &[])["beauty"]["rmse"].is_f64());
}

#[test]
fn pictures_of_other_sizes_windows_and_channels_are_refused() {
    let place = folder();
    render(&place, "a.exr", &[]);
    render(&place, "b.exr", &["--size", "24x18"]);
    assert_refused(&compare(&place, &[]), &["`a.exr`", "48x36", "`b.exr`", "24x18", "help:", "--size"]);
    render(&place, "b.exr", &["--crop", "0,0,8,8"]);
    assert_refused(&compare(&place, &["-o", "d.exr"]), &["`b.exr`", "8x8", "help:", "--crop"]);
    render(&place, "b.exr", &[]);
    edit(&place, "b.exr", |image| image.channels.retain(|plane| plane.name != "G"));
    assert_refused(&compare(&place, &[]), &["`b.exr` has no channel G", "help:"]);
    assert_eq!(place.files(), ["a.exr", "b.exr", "scene.toml"]);
}

#[test]
fn files_that_are_missing_or_no_pictures_are_refused_by_name() {
    let place = folder();
    render(&place, "a.exr", &["--spp", "1"]);
    assert_refused(&compare(&place, &[]), &["`b.exr`", "help:"]);
    for bytes in [&b""[..], b"no picture", b"\x76\x2f\x31\x01\x02\x00\x00\x00 but no more"] {
        fs::write(place.path("b.exr"), bytes).unwrap();
        assert_refused(&compare(&place, &["--json"]), &["`b.exr`", "help:"]);
    }
    let whole = fs::read(place.path("a.exr")).unwrap();
    fs::write(place.path("b.exr"), &whole[..whole.len() / 2]).unwrap();
    assert_refused(&compare(&place, &[]), &["`b.exr`", "help:"]);
}

#[test]
fn an_output_does_not_replace_a_picture_to_compare() {
    let place = folder();
    render(&place, "a.exr", &["--spp", "1"]);
    render(&place, "b.exr", &["--spp", "2"]);
    let before = fs::read(place.path("b.exr")).unwrap();
    for name in ["b.exr", "./b.exr"] {
        assert_refused(&compare(&place, &["-o", name]), &[name, "pictures to compare", "help:"]);
    }
    assert_eq!(fs::read(place.path("b.exr")).unwrap(), before);
    assert_refused(&compare(&place, &["-o", "nowhere/d.exr"]), &["`nowhere/d.exr`", "does not exist"]);
}

#[test]
fn bad_flags_are_refused_with_a_remedy() {
    let place = folder();
    let cases: &[(&[&str], &[&str])] = &[
        (&["--max-rmse", "-1"], &["--max-rmse", "'-1'", "from 0"]),
        (&["--max-relmse", "nan"], &["--max-relmse", "'nan'", "from 0"]),
        (&["-o", "d.png"], &["--output", ".exr"]),
        (&["--png", "d.exr"], &["--png", ".png"]),
    ];
    for (flags, said) in cases {
        assert_refused(&compare(&place, flags), said);
    }
}
