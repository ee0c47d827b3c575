//! A picture is the same to the last bit on every machine: whatever vector instructions it has, and whichever variant of
//! its functions the C library picks there.

#[path = "common/command.rs"]
mod command;
mod common;

use command::{Folder, assert_good, assert_refused};
use common::scene_path;

/// Variables that have a machine pass for another: kernels without its vector instructions, and those of the C library's
/// functions that do without them.
const MACHINES: [(&str, &str); 4] = [
    ("WARPFRONT_SIMD", "baseline"),
    ("WARPFRONT_SIMD", "auto"),
    ("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA,-AVX2,-AVX512F,-AVX512VL"),
    ("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA4,-FMA,-AVX2,-AVX,-SSE4_1,-AVX512F,-AVX512VL"),
];

fn assert_same_everywhere(scene: &str, flags: &[&str]) {
    let folder = Folder::with(&[]);
    let scene = scene_path(scene);
    let render = |name: &str, (variable, value): (&str, &str)| {
        let command = ["render", scene.to_str().unwrap(), "--no-png", "-o", name, "--size", "48x36"];
        assert_good(&folder.command(&[&command[..], flags].concat()).env(variable, value).output().unwrap());
        std::fs::read(folder.path(name)).unwrap()
    };
    let here = render("here.exr", ("WARPFRONT_SIMD", "auto"));
    for machine in MACHINES {
        assert!(render("there.exr", machine) == here, "{} differs with {machine:?}", scene.display());
    }
}

#[test]
fn light_along_geodesics_is_the_same_on_every_machine() {
    assert_same_everywhere("cornell_small_light.toml", &["--spp", "16", "--max-winding", "3"]);
}

#[test]
fn meshes_glass_and_guided_light_are_the_same_on_every_machine() {
    assert_same_everywhere("hole_in_glass.toml", &["--spp", "4", "--precision", "f32", "--stepper", "rkf45"]);
    assert_same_everywhere("room_black_hole.toml", &["--spp", "2"]);
}

#[test]
fn skies_are_the_same_on_every_machine() {
    assert_same_everywhere("accretion_disk.toml", &["--spp", "4"]);
    assert_same_everywhere("teapot_black_hole.toml", &["--spp", "2"]);
}

#[test]
fn instructions_that_do_not_exist_are_refused() {
    let folder = Folder::with(&[]);
    let output = folder.command(&["connect", "none.csv"]).env("WARPFRONT_SIMD", "avx9000").output().unwrap();
    assert_refused(&output, &["avx9000", "baseline"]);
}
