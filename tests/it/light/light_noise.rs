//! Light sampling leaves little noise, and none that sticks out.

use crate::support::lit::{Agreement, disk, picture, variance};
use crate::support::{
    Random, camera, closed_box, film, hole, material, mesh, obj, rectangle, scene_with, sphere,
};
use glam::{DMat3, DVec3, Vec3};
use warpfront::film::Image;
use warpfront::light::Heuristic;
use warpfront::scene::LightSampling::{self, Geodesic, Off, Straight};
use warpfront::scene::{Baked, SamplerKind};
use warpfront::shade::{Environment, LatLong};
use warpfront::trace::Run;

const ALBEDO: f64 = 0.6;
const DEPTH: u32 = 4;

/// A closed diffuse room with lights in all corners where light sampling alone would make fireflies: on a wall, around
/// the hole, close to a ball.
fn corners(r_s: f64, size: (usize, usize)) -> Baked {
    let text = if r_s > 0.0 { hole(DVec3::new(0.5, 0.0, -1.0), r_s) } else { String::new() }
        + &camera(DVec3::new(3.5, 2.0, 3.6), DVec3::new(0.0, -0.5, -1.0), 80.0)
        + &film(size.0, size.1)
        // Roulette raises throughput to 1 again: without it the bound is that of the albedo.
        + &format!("[render]\nmax_depth = {DEPTH}\nroulette_depth = {DEPTH}\n")
        + &material("wall", ALBEDO, 0.0)
        + &material("light", ALBEDO, 1.0)
        + &mesh("room.obj", DVec3::ZERO, "wall")
        + &mesh("lamp.obj", DVec3::ZERO, "light")
        + &sphere(DVec3::new(-2.5, -3.2, -2.0), 0.8, "light")
        + &sphere(DVec3::new(-1.2, -3.4, -2.0), 0.5, "wall")
        + &disk(DVec3::new(1.0, -3.99, 1.0), DVec3::Y, 0.2, 1.0, "light")
        + &sphere(DVec3::new(1.0, -3.5, 1.0), 0.49, "wall");
    let room = closed_box(DVec3::splat(-4.0), DVec3::splat(4.0));
    // Meets the wall at a right angle.
    let lamp = rectangle(DVec3::new(-3.0, 0.0, 1.0), 1.0 * DVec3::X, 1.0 * DVec3::Z);
    scene_with(&text, &[("room.obj", &room), ("lamp.obj", &lamp)])
}

fn single_samples(scene: &mut Baked, sampling: LightSampling, seed: u64) -> Image {
    let settings = &mut scene.settings;
    (settings.light_sampling, settings.spp, settings.seed) = (sampling, 1, seed);
    settings.sampler = SamplerKind::Independent;
    crate::support::render(scene, &Run::default()).image
}

fn brightest(scene: &mut Baked, sampling: LightSampling) -> f32 {
    let pictures = (0..4).map(|seed| single_samples(scene, sampling, seed));
    pictures.flat_map(|image| image.channel("R").unwrap().to_vec()).fold(0.0, f32::max)
}

#[test]
fn no_sample_is_brighter_than_both_ways_to_find_light_allow() {
    // At every vertex but the last, a light sample adds at most L times the throughput T before and the albedo a after
    // it: it adds T f L w/p, f = a q with q the density of the bounce; w/p is 1/(p + q) with the balance heuristic and
    // p/(p² + q²) with the power heuristic, so that q w/p is at most 1. The bounce adds at most T a L where it lands. T
    // = a^k after k bounces without roulette: together L (1 + 2 (a + a² + …)), up to the last bounce.
    let sum: f64 = (1..DEPTH as i32).map(|k| ALBEDO.powi(k)).sum();
    let bound = 1.0 + 2.0 * sum;
    for r_s in [0.0, 1.0] {
        let mut scene = corners(r_s, (192, 144));
        for heuristic in [Heuristic::Balance, Heuristic::Power] {
            scene.settings.heuristic = heuristic;
            let most = brightest(&mut scene, Geodesic);
            println!("r_s {r_s}, {heuristic:?}: {most}, at most {bound}");
            assert!(f64::from(most) < bound * (1.0 + 1e-6), "{most}, not {bound}");
            assert!(f64::from(most) > 0.4 * bound, "{most}: no test of {bound}");
        }
        if r_s == 0.0 {
            let most = brightest(&mut scene, Straight);
            println!("without sharing {most}");
            // The lamp on the wall is sampled by solid angle, the balls and the disk that touch each other are not.
            assert!(f64::from(most) > 1.5 * bound, "{most}: the scene is no test");
        }
    }
}

/// Pictures at each number of samples: a quantile of one picture's errors would be that of its worst few pixels.
const SEEDS: u64 = 6;

/// The quantile of pixels' relative errors at `counts` samples, against `reference` samples, and its slope.
fn quantiles(size: (usize, usize), counts: &[u32], reference: u32, share: f64, r_s: f64) -> f64 {
    let mut scene = corners(r_s, size);
    let converged = picture(&mut scene, Geodesic, reference, 1000);
    let points: Vec<(f64, f64)> = counts
        .iter()
        .map(|&spp| {
            let mut errors = Vec::new();
            for seed in 0..SEEDS {
                let image = picture(&mut scene, Geodesic, spp, SEEDS * u64::from(spp) + seed);
                let pairs = image.channel("R").unwrap().iter().zip(converged.channel("R").unwrap());
                errors.extend(pairs.map(|(a, b)| (a - b).abs() / (b + 1e-3)));
            }
            errors.sort_by(f32::total_cmp);
            let quantile = errors[((errors.len() as f64 * share) as usize).min(errors.len() - 1)];
            println!("r_s {r_s}: {share} of all pixels within {quantile:.4} at {spp} samples");
            (f64::from(spp).ln(), f64::from(quantile).ln())
        })
        .collect();
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
        / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
    println!("slope {slope:.3}");
    slope
}

fn check_slope(slope: f64) {
    assert!((-0.65..-0.4).contains(&slope), "{slope}");
}

#[test]
fn the_worst_pixels_errors_fall_as_the_root_of_the_number_of_samples() {
    check_slope(quantiles((64, 48), &[8, 16, 32, 64], 512, 0.999, 1.0));
}

#[test]
#[ignore = "converging takes minutes: cargo test --release --test it light_noise -- --ignored --nocapture"]
fn the_worst_pixel_of_ten_thousand_has_an_error_that_falls_as_the_root_of_the_number_of_samples() {
    for r_s in [0.0, 1.0] {
        let counts = [16, 32, 64, 128, 256, 512, 1024];
        check_slope(quantiles((128, 96), &counts, 16384, 0.9999, r_s));
    }
}

/// Compares with and without light sampling: the same picture, and how much more noise there is without.
fn gain(scene: &mut Baked, spp: u32, what: &str) -> f64 {
    let with = picture(scene, Geodesic, spp / 4, 1);
    let without = picture(scene, Off, spp, 2);
    Agreement::of(&with, &without).check(what);
    let gain = variance(&without, spp) / variance(&with, spp / 4);
    println!("{what}: {gain:.1} times less noise");
    gain
}

#[test]
fn ten_thousand_small_bumpy_lights_are_sampled_without_bias_and_with_little_noise() {
    const CELLS: usize = 71;
    let mut random = Random::new(1);
    let place = |i: usize| 2.0 * (i as f64 / CELLS as f64) - 1.0;
    let points: Vec<DVec3> = (0..(CELLS + 1) * (CELLS + 1))
        .map(|i| DVec3::new(place(i % (CELLS + 1)), 0.03 * random.between(-1.0, 1.0), place(i / (CELLS + 1))))
        .collect();
    let triangles: Vec<[usize; 3]> = (0..CELLS * CELLS)
        .flat_map(|i| {
            let corner = |x: usize, z: usize| (i / CELLS + z) * (CELLS + 1) + i % CELLS + x;
            [[corner(0, 0), corner(1, 0), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(0, 1)]]
        })
        .collect();
    assert!(triangles.len() > 10_000);
    for r_s in [0.0, 0.6] {
        let text = if r_s > 0.0 { hole(DVec3::new(0.3, 1.0, -0.5), r_s) } else { String::new() }
            + &camera(DVec3::new(3.5, -0.5, 3.6), DVec3::new(0.0, -4.0, 0.0), 40.0)
            + &film(32, 32)
            + "[render]\nmax_depth = 3\n"
            + &material("wall", 0.7, 0.0)
            + &material("light", 0.0, 1.0).replace("emission", "emits = \"front\"\nemission")
            + &mesh("room.obj", DVec3::ZERO, "wall")
            + &mesh("lights.obj", DVec3::new(0.0, 3.0, 0.0), "light");
        let room = closed_box(DVec3::splat(-4.0), DVec3::splat(4.0));
        let files = [("room.obj", room.as_str()), ("lights.obj", &obj(&points, &triangles))];
        let gain =
            gain(&mut scene_with(&text, &files), 128, &format!("{} lights, r_s {r_s}", triangles.len()));
        assert!(gain > 5.0, "{gain}");
    }
}

#[test]
fn a_bright_spot_in_the_sky_is_sampled_without_bias_and_with_little_noise() {
    let place = DVec3::new(0.0, 3.0, -2.0);
    let spinning =
        hole(place, 1.0).replace("\"schwarzschild\"", "\"kerr\"\nspin = 0.9\naxis = [0.3, 1, 0.2]");
    for (name, spacetime) in [("flat", String::new()), ("hole", hole(place, 1.0)), ("spinning", spinning)] {
        let text = spacetime
            // The hole and the sky around it are out of sight: noise of what the camera sees is the same with both.
            + &camera(DVec3::new(0.0, 2.5, 5.0), DVec3::new(0.0, -0.5, 2.5), 35.0)
            + &film(32, 32)
            + "[render]\nmax_depth = 3\n"
            + &material("floor", 0.7, 0.0)
            + &disk(DVec3::ZERO, DVec3::Y, 0.0, 9.0, "floor")
            + &sphere(DVec3::new(1.5, 0.6, 1.0), 0.6, "floor");
        let mut scene = scene_with(&text, &[]);
        let (width, height) = (64, 32);
        let mut pixels = vec![Vec3::new(0.05, 0.06, 0.08); width * height];
        for (x, y) in [(40, 9), (41, 9), (40, 10)] {
            pixels[y * width + x] = Vec3::new(40.0, 36.0, 30.0);
        }
        let from_world = DMat3::from_rotation_x(0.3);
        scene.environment = Environment::Image(LatLong { width, height, pixels, from_world });
        let gain = gain(&mut scene, 256, &format!("sky, {name}"));
        assert!(gain > 5.0, "{gain}");
    }
}
