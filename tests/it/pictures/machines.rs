//! A picture is the same to the last bit on every machine: whatever vector instructions it has, and whichever variant
//! of its functions the C library picks there.

use crate::support::command::{Folder, assert_good, assert_refused};
use crate::support::scene_path;

/// Variables that have a machine pass for another: kernels without its vector instructions, and those of the C
/// library's functions that do without them.
const MACHINES: [(&str, &str); 4] = [
    ("WARPFRONT_SIMD", "baseline"),
    ("WARPFRONT_SIMD", "auto"),
    ("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA,-AVX2,-AVX512F,-AVX512VL"),
    ("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA4,-FMA,-AVX2,-AVX,-SSE4_1,-AVX512F,-AVX512VL"),
];

/// Asserts that the command gives the same on all machines, by what it prints or by the file that it writes.
fn assert_same_everywhere(arguments: &[&str], file: Option<&str>) {
    let folder = Folder::with(&[]);
    let result = |(variable, value): (&str, &str)| {
        let output = folder.command(arguments).env(variable, value).output().unwrap();
        assert_good(&output);
        file.map_or(output.stdout, |name| std::fs::read(folder.path(name)).unwrap())
    };
    let here = result(("WARPFRONT_SIMD", "auto"));
    for machine in MACHINES {
        assert!(result(machine) == here, "{arguments:?} differs with {machine:?}");
    }
}

fn assert_same_picture(scene: &str, flags: &[&str]) {
    let scene = scene_path(scene);
    let command = ["render", scene.to_str().unwrap(), "--no-png", "-o", "a.exr", "--size", "48x36"];
    assert_same_everywhere(&[&command[..], flags].concat(), Some("a.exr"));
}

#[test]
fn connections_are_the_same_to_the_last_digit_on_every_machine() {
    let pairs = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/schwarzschild_connections.csv");
    assert_same_everywhere(&["connect", pairs, "--max-winding", "3"], None);
}

#[test]
fn light_along_geodesics_is_the_same_on_every_machine() {
    assert_same_picture("hole_in_glass.toml", &["--spp", "4", "--precision", "f32", "--max-winding", "3"]);
}

#[test]
fn meshes_and_skies_are_the_same_on_every_machine() {
    assert_same_picture("teapot_black_hole.toml", &["--spp", "2"]);
}

#[test]
fn instructions_that_do_not_exist_are_refused() {
    let folder = Folder::with(&[]);
    let output = folder.command(&["connect", "none.csv"]).env("WARPFRONT_SIMD", "avx9000").output().unwrap();
    assert_refused(&output, &["avx9000", "baseline"]);
}
