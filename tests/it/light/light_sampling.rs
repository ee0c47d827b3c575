//! Light sampling shows the same picture as rays that nothing aims, and every way of it the same as every other.

use crate::support::lit::{Agreement, TWISTS, Twist, picture, room};
use crate::support::{
    Random, camera, closed_box, film, mesh, rectangle, scene_file, scene_path, scene_with, spacetimes, sphere,
};
use glam::DVec3;
use warpfront::light::Heuristic;
use warpfront::scene::Baked;
use warpfront::scene::LightSampling::{Geodesic, Off};

/// Scenes with something to sample, and to sample it from.
const SCENES: [&str; 8] = [
    "cornell_black_hole.toml",
    "cornell_flat.toml",
    "cornell_series.toml",
    "einstein_ring.toml",
    "hole_in_glass.toml",
    "hole_in_mirror.toml",
    "room_black_hole.toml",
    "teapot_black_hole.toml",
];

/// Compares pictures with and without light sampling of random scenes number `from` on; `spp` is without.
fn random_scenes(numbers: std::ops::Range<u64>, spp: u32) {
    let mut squares = 0.0;
    let count = numbers.end - numbers.start;
    for number in numbers {
        let twist = TWISTS[number as usize % TWISTS.len()];
        let mut scene = room(&mut Random::new(100 + number), twist, 1.5);
        let with = picture(&mut scene, Geodesic, spp / 4, 2 * number + 1);
        let without = picture(&mut scene, Off, spp, 2 * number);
        let agreement = Agreement::of(&with, &without);
        agreement.check(&format!("{number} {twist:?}"));
        squares += agreement.z.powi(2);
    }
    // Each is the worst of three colours, which are nearly the same number.
    let mean = squares / count as f64;
    println!("mean square of z {mean:.2}");
    assert!(mean < 1.5 + 3.0 * (2.0 / count as f64).sqrt(), "{mean}");
}

#[test]
fn rooms_with_holes_and_lights_look_the_same_with_and_without_light_sampling() {
    random_scenes(0..16, 128);
}

#[test]
#[ignore = "so little noise takes half an hour: cargo test --release --test it light_sampling -- --ignored --nocapture"]
fn rooms_look_the_same_with_and_without_light_sampling_to_a_few_permille() {
    random_scenes(1000..1024, 2000);
}

fn scene_files(spp: u32) {
    for name in SCENES {
        let overrides =
            ["film.width=48", "film.height=36", "render.max_depth=5", "spacetime.schwarzschild_radius=5"];
        let overrides = if name == "room_black_hole.toml" { &overrides[..3] } else { &overrides };
        let mut scene = scene_file(&scene_path(name), overrides);
        // Nothing runs into a punctual light.
        scene.punctual.clear();
        let with = picture(&mut scene, Geodesic, spp / 4, 1);
        let without = picture(&mut scene, Off, spp, 2);
        Agreement::of(&with, &without).check(name);
    }
}

#[test]
fn the_scenes_of_this_repository_look_the_same_with_and_without_light_sampling() {
    scene_files(128);
}

#[test]
#[ignore = "so little noise takes half an hour: cargo test --release --test it light_sampling -- --ignored --nocapture"]
fn the_scenes_look_the_same_with_and_without_light_sampling_to_a_few_permille() {
    scene_files(2000);
}

/// A room with two lamps and balls of principled materials, some of them layered, one absorbing, and a pane of rough
/// glass before a lamp.
fn principled_room(spacetime: &str) -> Baked {
    const MATERIALS: [(&str, &str); 7] = [
        ("wall", "albedo = [0.6, 0.5, 0.4]\nroughness = 0.4"),
        ("metal", "albedo = [0.9, 0.7, 0.4]\nmetallic = 1\nroughness = 0.35"),
        ("glass", "transmission = 1\nroughness = 0.4\nattenuation_color = [0.9, 0.5, 0.3]"),
        ("lacquer", "albedo = [0.6, 0.1, 0.1]\nroughness = 0.7\nclearcoat = 1"),
        ("cloth", "albedo = 0.3\nroughness = 0.8\nsheen_color = [0.4, 0.4, 0.9]\nsheen_roughness = 0.4"),
        ("pane", "albedo = [0.5, 0.9, 0.7]\ntransmission = 0.7\nroughness = 0.5\nthin = true"),
        ("varnish", "metallic = 0.5\nroughness = 0.3\nclearcoat = 1\nclearcoat_roughness = 0.2"),
    ];
    let mut text = spacetime.to_owned();
    text += &camera(DVec3::new(0.0, 0.0, 4.5), DVec3::ZERO, 70.0);
    text += &film(32, 32);
    text += "[render]\nmax_depth = 6\nroulette_depth = 3\n";
    for (name, keys) in MATERIALS {
        text += &format!("[[material]]\nname = \"{name}\"\nkind = \"principled\"\n{keys}\n");
    }
    text += "[[material]]\nname = \"lamp\"\nalbedo = 0.1\nemission = [3, 2.5, 2]\n";
    text += &mesh("room.obj", DVec3::ZERO, "wall");
    text += &mesh("pane.obj", DVec3::ZERO, "pane");
    text += &sphere(DVec3::new(-2.5, 2.2, -2.0), 1.0, "lamp");
    text += &sphere(DVec3::new(2.8, -1.0, 1.0), 0.8, "lamp");
    for (x, y, name) in [(-2.5, -2.0, "metal"), (0.0, -2.1, "glass"), (-1.2, -0.2, "lacquer")] {
        text += &sphere(DVec3::new(x, y, -0.5), 0.8, name);
    }
    for (x, y, name) in [(2.5, 2.0, "cloth"), (2.2, -2.3, "varnish")] {
        text += &sphere(DVec3::new(x, y, -1.5), 0.8, name);
    }
    let room = closed_box(DVec3::splat(-3.6), DVec3::new(3.6, 3.6, 5.0));
    let pane = rectangle(DVec3::new(-2.2, 1.5, 0.0), 1.2 * DVec3::X, 1.2 * DVec3::Y);
    scene_with(&text, &[("room.obj", &room), ("pane.obj", &pane)])
}

#[test]
fn principled_materials_look_the_same_with_and_without_light_sampling() {
    for (what, spacetime) in spacetimes(DVec3::new(0.5, 0.5, 0.0), 0.8) {
        let mut scene = principled_room(&spacetime);
        let with = picture(&mut scene, Geodesic, 128, 1);
        let without = picture(&mut scene, Off, 512, 2);
        Agreement::of(&with, &without).check(what);
    }
}

/// Light sampling of one kind against another: they need not wait for rays that nothing aims.
fn ways_agree(twists: &[Twist], spp: u32) {
    for (number, &twist) in twists.iter().enumerate() {
        let mut scene = room(&mut Random::new(400 + number as u64), twist, 1.0);
        let reference = picture(&mut scene, Geodesic, 2 * spp, 1);
        for (winding, heuristic) in
            [(0, Heuristic::Balance), (2, Heuristic::Balance), (1, Heuristic::Power), (3, Heuristic::Power)]
        {
            (scene.settings.max_winding, scene.settings.heuristic) = (winding, heuristic);
            let other = picture(&mut scene, Geodesic, spp, 2 + u64::from(winding));
            let what = format!("{twist:?}, winding numbers up to {winding}, {heuristic:?}");
            Agreement::of(&other, &reference).check(&what);
        }
    }
}

#[test]
fn the_picture_depends_neither_on_the_largest_winding_number_nor_on_the_heuristic() {
    ways_agree(&[Twist::Behind, Twist::Disk, Twist::Close], 48);
}

#[test]
#[ignore = "so little noise takes half an hour: cargo test --release --test it light_sampling -- --ignored --nocapture"]
fn the_picture_depends_neither_on_winding_number_nor_on_heuristic_to_a_few_permille() {
    ways_agree(&TWISTS, 2000);
}
