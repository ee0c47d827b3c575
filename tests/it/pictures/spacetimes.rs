//! Pictures in every spacetime of the table: furnaces, light sampling, both schedules.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::support::lit::{Agreement, TWISTS, Twist, picture, room};
use crate::support::{
    Random, camera, closed_box, film, material, mean_red, render, scene_file, scene_path, scene_with, sphere,
};
use glam::DVec3;
use warpfront::scene::LightSampling::{Geodesic, Off};
use warpfront::spacetime::{Entry, Schwarzschild};
use warpfront::trace::{Run, Session};

/// `[spacetime]` of a charged hole.
fn charged(charge: f64) -> String {
    format!("[spacetime]\nkind = \"reissner-nordstrom\"\nschwarzschild_radius = 1\ncharge = {charge}\n")
}

#[test]
fn a_furnace_around_a_charged_hole_is_exactly_one() {
    // With a sphere that emits just outside the horizon, which for the extremal hole is at the centre.
    for (charge, radius) in [(0.7, 0.2), (-0.99, 0.1), (1.0, 0.01), (1.0, 0.5)] {
        let text = charged(charge)
            + &camera(DVec3::new(1.2, 0.3, -1.7), DVec3::ZERO, 100.0)
            + &film(16, 16)
            + "[render]\nspp = 64\nmax_depth = 400\nroulette_depth = 5\n"
            + &material("wall", 0.5, 0.5)
            + &sphere(DVec3::ZERO, radius, "wall")
            + "[[entity]]\nmesh = \"box.obj\"\nmaterial = \"wall\"\n";
        let walls = closed_box(DVec3::new(-2.0, -2.5, -3.0), DVec3::new(2.0, 1.5, 2.5));
        let mean = mean_red(&render(&scene_with(&text, &[("box.obj", &walls)]), &Run::default()));
        assert!((mean - 1.0).abs() < 3e-3, "charge {charge}, radius {radius}: {mean}");
    }
}

#[test]
fn rooms_with_charged_holes_look_the_same_with_and_without_light_sampling() {
    let entry = Entry::named("reissner-nordstrom").unwrap();
    for (number, charge) in [(0, 0.6), (2, 1.0), (3, -0.95), (5, 1.0), (7, 0.99)] {
        let twist: Twist = TWISTS[number as usize];
        let mut scene = room(&mut Random::new(100 + number), twist, 1.5);
        let center = scene.spacetime.center().unwrap();
        scene.spacetime = entry.with(center, &[scene.spacetime.schwarzschild_radius(), charge]);
        let with = picture(&mut scene, Geodesic, 32, 2 * number + 1);
        let without = picture(&mut scene, Off, 128, 2 * number);
        Agreement::of(&with, &without).check(&format!("{number} {twist:?}, charge {charge}"));
    }
}

fn values(path: &Path, overrides: &[&str]) -> Vec<u32> {
    let rendered = render(&scene_file(path, overrides), &Run::default());
    rendered
        .image
        .channels
        .iter()
        .flat_map(|plane| plane.values.iter().map(|value| value.to_bits()))
        .collect()
}

#[test]
fn charged_holes_have_the_same_bits_by_both_schedules_and_with_the_papers_scheme() {
    let path = scene_path("cornell_black_hole.toml");
    let common = [
        "spacetime.kind=\"reissner-nordstrom\"",
        "spacetime.charge=0.9",
        "film.width=24",
        "film.height=18",
        "render.spp=4",
    ];
    for stepper in ["rkn6", "series", "dop853", "rk4-paper"] {
        let stepper = format!("render.stepper=\"{stepper}\"");
        let with = |schedule: &str| values(&path, &[&common[..], &[&stepper, schedule]].concat());
        assert_eq!(with("render.schedule=\"wavefront\""), with("render.schedule=\"per-pixel\""), "{stepper}");
    }
}

#[test]
fn a_spacetime_of_ones_own_is_rendered_as_one_of_the_table() {
    let scene = scene_file(
        &scene_path("cornell_black_hole.toml"),
        &["film.width=24", "film.height=18", "render.spp=4"],
    );
    let (run, cancel) = (Run::default(), AtomicBool::new(false));
    let hole = Schwarzschild::new(scene.spacetime.schwarzschild_radius());
    let center = scene.spacetime.center().unwrap();
    let mut session = Session::around(&scene, (center, hole), &run, &cancel);
    while session.pass(scene.settings.spp, |_| ()) {}
    assert_eq!(session.image().channel("G"), render(&scene, &run).image.channel("G"));
    // Without mass there is nothing to see of it.
    let mut weak = Session::around(&scene, (center, Schwarzschild::new(1e-9)), &run, &cancel);
    while weak.pass(scene.settings.spp, |_| ()) {}
    assert_ne!(weak.image().channel("G"), session.image().channel("G"));
}
