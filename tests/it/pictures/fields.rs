//! Pictures of several holes and of lenses: furnaces, a white sky, both schedules, one hole as a charged one.

use crate::support::{
    camera, closed_box, film, material, red_range, render, scene, scene_file, scene_path, scene_with, sphere,
};
use glam::DVec3;
use warpfront::scene::Baked;
use warpfront::spacetime::{Entry, GradedLens, Hole, IndexMedium, Lenses, SeveralHoles, SpacetimeKind};
use warpfront::trace::Run;

const TWO_HOLES: &str = "[spacetime]\nkind = \"several-holes\"\n\
    [[spacetime.hole]]\ncenter = [-0.9, 0.1, 0.2]\nmass = 0.5\n\
    [[spacetime.hole]]\ncenter = [0.8, -0.6, -0.3]\nmass = 0.2\n";

/// Long paths, none ended by roulette: no noise is left.
const WHOLE_PATHS: &str =
    "[render]\nspp = 4\nmax_depth = 400\nroulette_depth = 400\nlight_sampling = \"off\"\n";

#[test]
fn a_furnace_with_two_holes_is_exactly_one() {
    // Every hole is in a sphere that emits: within its photon sphere, and beyond.
    for radius in [0.08, 0.5] {
        let text = TWO_HOLES.to_owned()
            + &camera(DVec3::new(1.2, 0.7, 1.9), DVec3::ZERO, 100.0)
            + &film(16, 16)
            + WHOLE_PATHS
            + &material("wall", 0.5, 0.5)
            + &sphere(DVec3::new(-0.9, 0.1, 0.2), radius, "wall")
            + &sphere(DVec3::new(0.8, -0.6, -0.3), radius, "wall")
            + "[[entity]]\nmesh = \"box.obj\"\nmaterial = \"wall\"\n";
        let walls = closed_box(DVec3::new(-2.0, -2.5, -3.0), DVec3::new(2.0, 1.5, 2.5));
        let files = [("box.obj", walls.as_str())];
        let (low, high) = red_range(&render(&scene_with(&text, &files), &Run::default()));
        assert!((low - 1.0).abs() < 1e-5 && (high - 1.0).abs() < 1e-5, "{radius}: {low} to {high}");
        let text = text.replace("light_sampling = \"off\"", "light_sampling = \"geodesic\"");
        let rendered = render(&scene_with(&text.replace("spp = 4", "spp = 64"), &files), &Run::default());
        let red = rendered.image.channel("R").unwrap();
        let mean = red.iter().map(|&value| f64::from(value)).sum::<f64>() / red.len() as f64;
        assert!((mean - 1.0).abs() < 3e-3, "{radius} with light sampling: {mean}");
    }
}

#[test]
fn a_white_sky_is_white_or_black_around_two_holes_and_white_through_lenses() {
    let lenses = "[spacetime]\nkind = \"lenses\"\n\
        [[spacetime.lens]]\nkind = \"luneburg\"\ncenter = [-1.5, 0, 0]\nradius = 1\n\
        [[spacetime.lens]]\nkind = \"gaussian\"\ncenter = [2, 0.5, 0]\nwidth = 0.2\namplitude = 0.7\n";
    for (spacetime, has_shadow) in [(TWO_HOLES, true), (lenses, false)] {
        let text = spacetime.to_owned()
            + &camera(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, 50.0)
            + &film(32, 32)
            + "[render]\nspp = 1\n[environment]\ncolor = 1\n";
        let rendered = render(&scene(&text), &Run::default());
        let red = rendered.image.channel("R").unwrap();
        assert!(red.iter().all(|&value| value == 0.0 || value == 1.0));
        assert_eq!(red.contains(&0.0), has_shadow);
        assert!(red.contains(&1.0));
    }
}

fn bits(scene: &Baked) -> Vec<u32> {
    let rendered = render(scene, &Run::default());
    let planes = rendered.image.channels.iter();
    planes.flat_map(|plane| plane.values.iter().map(|value| value.to_bits())).collect()
}

#[test]
fn several_holes_and_lenses_have_the_same_bits_by_both_schedules() {
    let common = ["film.width=24", "film.height=18", "render.spp=4"];
    let two_holes = |overrides: &[&str]| {
        bits(&scene_file(&scene_path("two_holes.toml"), &[&common[..], overrides].concat()))
    };
    // Many triangles are searched in a tree, few shapes side by side.
    let teapot = |overrides: &[&str]| {
        let mut scene = scene_file(&scene_path("teapot_black_hole.toml"), &[&common[..], overrides].concat());
        let center = scene.spacetime.center().unwrap();
        let lens = GradedLens::Gaussian { center, width: 4.0, amplitude: 0.4 };
        scene.spacetime = SpacetimeKind::Indexed(IndexMedium::Lenses(Lenses::new(&[lens])));
        bits(&scene)
    };
    for stepper in ["render.stepper=\"rkn6\"", "render.stepper=\"dop853\""] {
        let (wavefront, per_pixel) = ("render.schedule=\"wavefront\"", "render.schedule=\"per-pixel\"");
        assert_eq!(two_holes(&[stepper, wavefront]), two_holes(&[stepper, per_pixel]), "{stepper}");
        assert_eq!(teapot(&[stepper, wavefront]), teapot(&[stepper, per_pixel]), "{stepper}");
    }
}

#[test]
fn one_hole_is_seen_as_a_hole_of_extremal_charge() {
    let common = [
        "film.width=32",
        "film.height=24",
        "render.spp=8",
        "render.light_sampling=\"off\"",
        "render.stepper=\"dop853\"",
        "render.tolerance=1e-9",
    ];
    let mut scene = scene_file(&scene_path("cornell_black_hole.toml"), &common);
    let (center, r_s) = (scene.spacetime.center().unwrap(), scene.spacetime.schwarzschild_radius());
    let green = |scene: &Baked| render(scene, &Run::default()).image.channel("G").unwrap().to_vec();
    scene.spacetime = Entry::named("reissner-nordstrom").unwrap().with(center, &[r_s, 1.0]);
    let charged = green(&scene);
    let hole = SeveralHoles::new(&[Hole { center, mass: 0.5 * r_s }]);
    scene.spacetime = SpacetimeKind::Indexed(IndexMedium::SeveralHoles(hole));
    let one = green(&scene);
    // The same random numbers: only rays that pass an edge within the tolerance differ.
    let differ = charged.iter().zip(&one).filter(|(a, b)| (*a - *b).abs() > 1e-4 * a.abs().max(1e-3)).count();
    assert!(differ < charged.len() / 50, "{differ} of {}", charged.len());
}
