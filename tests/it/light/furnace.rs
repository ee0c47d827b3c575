//! Closed rooms and white skies, where the answer is the same number everywhere.

use crate::support::{
    camera, closed_box, film, hole, material, red_range, render, scene, scene_with, sphere, table,
};
use glam::DVec3;
use warpfront::scene::Baked;
use warpfront::trace::Run;

/// Long paths, none ended by roulette and none that looks for lights: no noise is left.
const WHOLE_PATHS: &str =
    "[render]\nspp = 4\nmax_depth = 400\nroulette_depth = 400\nlight_sampling = \"off\"\n";

fn assert_uniform(scene: &Baked, expected: f64, tolerance: f64) {
    let (low, high) = red_range(&render(scene, &Run::default()));
    println!("between {low} and {high}, exactly {expected}");
    for value in [low, high] {
        let error = (f64::from(value) - expected).abs() / expected;
        assert!(error < tolerance, "between {low} and {high}, exactly {expected}");
    }
}

/// A camera in a box of triangles, around which `inside` is placed.
fn furnace(before: &str, render: &str, albedo: f64, emission: f64, inside: &str) -> Baked {
    let text = before.to_owned()
        + &camera(DVec3::new(1.2, 0.3, -1.7), DVec3::ZERO, 100.0)
        + &film(16, 16)
        + render
        + &material("wall", albedo, emission)
        + inside
        + "[[entity]]\nmesh = \"box.obj\"\nmaterial = \"wall\"\n";
    let room = closed_box(DVec3::new(-2.0, -2.5, -3.0), DVec3::new(2.0, 1.5, 2.5));
    scene_with(&text, &[("box.obj", &room)])
}

#[test]
fn a_room_of_albedo_and_emission_one_half_has_radiance_one_everywhere() {
    assert_uniform(&furnace("", WHOLE_PATHS, 0.5, 0.5, ""), 1.0, 1e-6);
}

#[test]
fn russian_roulette_keeps_the_mean_of_a_furnace() {
    let scene = furnace("", "[render]\nspp = 256\nmax_depth = 400\nroulette_depth = 2\n", 0.5, 0.5, "");
    let mean = crate::support::mean_red(&render(&scene, &Run::default()));
    println!("{mean}");
    assert!((mean - 1.0).abs() < 2e-3, "{mean}");
}

#[test]
fn light_sampling_keeps_the_mean_of_a_furnace() {
    // In flat space, and around holes in closed spheres that emit: at the photon sphere, at 0.93, no ray that goes
    // around is lost; a sphere of radius 0.3 is all but the horizon.
    let inside = |radius| sphere(DVec3::ZERO, radius, "wall");
    let bent = [0.3, 0.4, 0.93, 1.3].map(|radius| (hole(DVec3::ZERO, 1.0), inside(radius)));
    for (before, inside) in [(String::new(), String::new())].into_iter().chain(bent) {
        for heuristic in ["balance", "power"] {
            let render =
                format!("[render]\nspp = 64\nmax_depth = 400\nroulette_depth = 5\nmis = \"{heuristic}\"\n");
            let scene = furnace(&before, &render, 0.5, 0.5, &inside);
            let mean = crate::support::mean_red(&crate::support::render(&scene, &Run::default()));
            println!("{heuristic}, {inside:?}: {mean}");
            assert!((mean - 1.0).abs() < 3e-3, "{heuristic}, {inside:?}: {mean}");
        }
    }
}

#[test]
fn furnaces_have_the_radiance_of_every_row_of_the_table() {
    let mut count = 0;
    for row in table("flat.csv").iter().filter(|row| row.text("kind") == "furnace") {
        let (albedo, reflections) = (row.number("param1"), row.number("param2"));
        let depth = if reflections < 0.0 { 400 } else { reflections as u32 + 1 };
        let render = format!(
            "[render]\nspp = 1\nmax_depth = {depth}\nroulette_depth = 400\nlight_sampling = \"off\"\n"
        );
        assert_uniform(&furnace("", &render, albedo, 1.0, ""), row.number("value"), 1e-5);
        count += 1;
    }
    assert_eq!(count, 12);
}

#[test]
fn a_furnace_bent_by_a_hole_in_a_closed_sphere_is_as_bright_as_a_flat_one() {
    // Through the photon sphere, at 0.93: many rays that leave the inner sphere fall back on it.
    for radius in [0.4, 0.93, 1.3] {
        let inside = sphere(DVec3::ZERO, radius, "wall");
        let scene = furnace(&hole(DVec3::ZERO, 1.0), WHOLE_PATHS, 0.5, 0.5, &inside);
        assert_uniform(&scene, 1.0, 1e-6);
    }
}

/// A scene under a white sky with a sphere in the middle.
fn under_white_sky(before: &str, surface: &str, radius: f64) -> Baked {
    let text = before.to_owned()
        + &camera(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, 50.0)
        + &film(32, 32)
        + WHOLE_PATHS
        + "[environment]\ncolor = [1, 1, 1]\n"
        + surface
        + &sphere(DVec3::ZERO, radius, "it");
    scene(&text)
}

#[test]
fn a_white_ball_under_a_white_sky_is_invisible() {
    assert_uniform(&under_white_sky("", &material("it", 1.0, 0.0), 1.5), 1.0, 1e-6);
}

#[test]
fn a_ball_under_a_white_sky_is_as_bright_as_its_albedo() {
    for row in table("flat.csv").iter().filter(|row| row.text("kind") == "furnace_object") {
        let text = camera(DVec3::new(0.0, 0.0, 6.0), DVec3::ZERO, 5.0)
            + &film(8, 8)
            + WHOLE_PATHS
            + "[environment]\ncolor = [1, 1, 1]\n"
            + &material("it", row.number("param1"), 0.0)
            + &sphere(DVec3::ZERO, 1.0, "it");
        assert_uniform(&scene(&text), row.number("value"), 1e-6);
    }
}

#[test]
fn a_clear_glass_ball_under_a_white_sky_is_invisible() {
    let glass = "[[material]]\nname = \"it\"\nkind = \"dielectric\"\nalbedo = 1\nior = 1.5\n";
    assert_uniform(&under_white_sky("", glass, 1.5), 1.0, 1e-6);
}

#[test]
fn a_perfect_mirror_under_a_white_sky_is_invisible() {
    let mirror = "[[material]]\nname = \"it\"\nkind = \"mirror\"\nalbedo = 1\n";
    assert_uniform(&under_white_sky("", mirror, 1.5), 1.0, 1e-6);
}

#[test]
fn a_white_ball_around_a_hole_under_a_white_sky_is_invisible() {
    // The smallest one lies within the photon sphere: its light comes out after many bounces only.
    for radius in [0.45, 0.93, 1.3] {
        let scene = under_white_sky(&hole(DVec3::ZERO, 1.0), &material("it", 1.0, 0.0), radius);
        assert_uniform(&scene, 1.0, 1e-6);
    }
}
