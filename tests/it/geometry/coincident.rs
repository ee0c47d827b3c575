//! Surfaces that lie upon each other: objects doubled by accident, blocks of glass side by side, glass on a floor.

use std::fmt::Write;

use crate::support::{
    camera, closed_box, film, hole, material, mean_red, mesh, obj, red_range, render, scene_with, sphere,
    vector,
};
use glam::DVec3;
use warpfront::scene::Baked;
use warpfront::trace::Run;

const GLASS: &str = "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\n\
    [[material]]\nname = \"ice\"\nkind = \"dielectric\"\nior = 1.3\n\
    [[material]]\nname = \"mirror\"\nkind = \"mirror\"\nalbedo = 1\n";
/// Half the side of a cube: no power of two, so that nothing is exact.
const HALF: f64 = 8.1;

fn cube() -> String {
    closed_box(DVec3::splat(-HALF), DVec3::splat(HALF))
}

/// The same cube, its faces cut along their other diagonals.
fn recut() -> String {
    let corner = |i: usize| DVec3::from([0, 1, 2].map(|bit| if i >> bit & 1 == 0 { -HALF } else { HALF }));
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[usize; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[b, d, c], [a, d, b]]).collect();
    obj(&(0..8).map(corner).collect::<Vec<_>>(), &triangles)
}

fn disk(center: DVec3, normal: DVec3, radius: f64, material: &str) -> String {
    format!(
        "[[entity]]\ndisk = {{ center = {}, normal = {}, outer = {radius:?} }}\nmaterial = \"{material}\"\n",
        vector(center),
        vector(normal)
    )
}

fn baked(before: &str, from: DVec3, render: &str, content: &str) -> Baked {
    let text =
        before.to_owned() + &camera(from, DVec3::ZERO, 60.0) + &film(12, 12) + render + GLASS + content;
    scene_with(&text, &[("cube.obj", &cube()), ("recut.obj", &recut())])
}

/// What lies upon each other, by name.
fn scenes() -> Vec<(&'static str, String)> {
    let at = DVec3::ZERO;
    let ball = |x: f64, radius, material: &str| sphere(x * DVec3::X, radius, material);
    let block = |file, x: f64, material| mesh(file, x * DVec3::X, material);
    let floor = |material| disk(-HALF * DVec3::Y, DVec3::Y, 20.0, material);
    vec![
        ("a glass ball twice", ball(0.0, 10.0, "glass") + &ball(0.0, 10.0, "glass")),
        ("balls of glass and ice", ball(0.0, 10.0, "glass") + &ball(0.0, 10.0, "ice")),
        ("overlapping balls", ball(3.0, 10.0, "glass") + &ball(-3.0, 10.0, "ice")),
        ("touching balls", ball(7.0, 7.0, "glass") + &ball(-7.0, 7.0, "ice")),
        ("a ball in a ball", ball(0.0, 10.0, "glass") + &ball(0.0, 5.0, "ice")),
        ("a cube of glass three times", block("cube.obj", 0.0, "glass").repeat(3)),
        ("a cube of glass recut in ice", block("cube.obj", 0.0, "glass") + &block("recut.obj", 0.0, "ice")),
        ("cubes side by side", block("cube.obj", 0.0, "glass") + &block("cube.obj", 2.0 * HALF, "ice")),
        ("a cube of glass on a floor", block("cube.obj", 0.0, "glass") + &floor("wall")),
        ("a floor under a cube of glass", floor("wall") + &block("cube.obj", 0.0, "glass")),
        ("a cube of glass on a mirror", block("cube.obj", 0.0, "glass") + &floor("mirror")),
        ("a ball of glass on a mirror", ball(0.0, HALF, "glass") + &floor("mirror")),
        ("a solid ball twice", ball(0.0, 10.0, "wall") + &ball(0.0, 10.0, "wall")),
        ("a solid ball in a skin of glass", ball(0.0, 10.0, "wall") + &ball(0.0, 10.0, "glass")),
        ("a solid cube, recut", block("cube.obj", 0.0, "wall") + &block("recut.obj", 0.0, "wall")),
        (
            "tilted disks",
            disk(at, DVec3::new(0.1, 1.0, 0.3), 20.0, "wall")
                + &disk(at, DVec3::new(-0.2, -2.0, -0.6), 9.0, "wall"),
        ),
    ]
}

#[test]
fn a_furnace_is_as_bright_whatever_lies_upon_each_other_in_it() {
    let far = hole(DVec3::new(100.0, 20.0, 0.0), 10.0);
    let way = "[render]\nspp = 4\nmax_depth = 1000\nroulette_depth = 1000\nlight_sampling = \"off\"\n";
    let mut wrong = String::new();
    for (name, content) in scenes() {
        for before in ["", &far] {
            for schedule in ["wavefront", "per-pixel"] {
                let render_settings = format!("{way}schedule = \"{schedule}\"\n");
                let room = material("wall", 0.5, 1.0) + &sphere(DVec3::ZERO, 50.0, "wall");
                let scene = baked(before, 30.0 * DVec3::Z, &render_settings, &(room + &content));
                let (low, high) = red_range(&render(&scene, &Run::default()));
                // A path may be caught in glass for as long as it is followed.
                let mean = mean_red(&render(&scene, &Run::default()));
                if high > 2.0001 || (mean - 2.0).abs() > 1e-3 {
                    let _ = writeln!(wrong, "{name}, {schedule}, {before:?}: {mean} from {low} to {high}");
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn doubled_glass_looks_as_it_does_once() {
    let way = "[render]\nspp = 16\nmax_depth = 64\nlight_sampling = \"off\"\n[environment]\nkind = \"sky\"\n";
    let picture = |content: &str| {
        let scene = baked("", DVec3::new(9.0, 14.0, 25.0), way, content);
        render(&scene, &Run::default()).image.channel("R").unwrap().to_vec()
    };
    let cube = |file, material| mesh(file, DVec3::ZERO, material);
    let once = picture(&cube("cube.obj", "glass"));
    for other in ["cube.obj", "recut.obj"] {
        let twice = picture(&(cube("cube.obj", "glass") + &cube(other, "glass")));
        let differ = once.iter().zip(&twice).filter(|(a, b)| (*a - *b).abs() > 1e-3).count();
        // Paths that pass near an edge of a triangle go another way.
        assert!(differ * 20 <= once.len(), "{other}: {differ} of {} pixels", once.len());
    }
    let ball = |material| sphere(DVec3::ZERO, 10.0, material);
    assert_eq!(picture(&ball("glass")), picture(&(ball("glass") + &ball("glass"))));
}

#[test]
fn nothing_shines_through_walls_that_are_doubled_or_have_glass_upon_them() {
    let way = "[render]\nspp = 64\nmax_depth = 12\nroulette_depth = 12\n";
    let grey = material("grey", 0.9, 0.0) + &material("lamp", 0.9, 1.0);
    let lamp = sphere(DVec3::new(0.5, 1.0, -0.5), 2.0, "lamp");
    let cube = |file, material| mesh(file, DVec3::ZERO, material);
    for walls in [
        cube("cube.obj", "grey") + &cube("recut.obj", "grey"),
        cube("cube.obj", "grey") + &cube("recut.obj", "glass"),
        cube("recut.obj", "glass") + &cube("cube.obj", "grey"),
    ] {
        let scene = baked("", 30.0 * DVec3::Z, way, &(grey.clone() + &lamp + &walls));
        assert_eq!(mean_red(&render(&scene, &Run::default())), 0.0, "{walls}");
    }
}

#[test]
fn doubles_are_said() {
    let way = "[render]\nspp = 1\n[environment]\nkind = \"sky\"\n";
    let ball = sphere(DVec3::ZERO, 10.0, "glass");
    let scene = baked("", 30.0 * DVec3::Z, way, &ball.repeat(3));
    assert!(scene.warnings.iter().any(|line| line.starts_with("2 objects lie exactly where another does")));
    assert_eq!(scene.geometry.counts().spheres, 1);
}

#[test]
fn a_camera_in_glass_in_ice_knows_where_it_is() {
    // What is seen of the sky is what it is with the camera outside: here, from inside, through both at right angles,
    // all of it but what is reflected.
    let way = "[render]\nspp = 1024\nmax_depth = 64\nroulette_depth = 64\nlight_sampling = \"off\"\n[environment]\ncolor = [1, 1, 1]\n";
    let ball = |radius, material| sphere(DVec3::ZERO, radius, material);
    let shell = |around: &str| {
        let black = material("black", 0.0, 0.0);
        // A black ball that is behind the camera takes what is reflected.
        let scene = baked(
            "",
            1e-3 * DVec3::Z,
            way,
            &(black + &sphere(0.5 * DVec3::Z, 0.4, "black") + &ball(2.0, "glass") + around),
        );
        mean_red(&render(&scene, &Run::default()))
    };
    let (alone, around) = (shell(""), shell(&ball(4.0, "glass")));
    // Glass in glass of the same kind is no surface at all; the outer one has the same normals.
    assert!((alone - around).abs() < 5e-3, "{alone} {around}");
}
