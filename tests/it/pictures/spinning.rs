//! Pictures around spinning holes: furnaces, shadows, both schedules, and without spin Schwarzschild's.

use std::path::Path;

use crate::support::{
    camera, closed_box, film, material, mean_red, red_range, render, scene, scene_file, scene_path,
    scene_with, sphere,
};
use glam::DVec3;
use warpfront::geometry::PrimitiveId;
use warpfront::scene::Baked;
use warpfront::trace::transport::Outcome;
use warpfront::trace::{Ray, Run, shoot};

/// `[spacetime]` of a hole of mass ½ whose axis is tilted.
fn spinning(spin: f64, charge: f64) -> String {
    format!(
        "[spacetime]\nkind = \"kerr-newman\"\nschwarzschild_radius = 1\nspin = {spin:?}\ncharge = {charge:?}\naxis = [1, 2, -2]\n"
    )
}

const WHOLE_PATHS: &str =
    "[render]\nspp = 4\nmax_depth = 400\nroulette_depth = 400\nlight_sampling = \"off\"\n";

/// A box and a sphere around hole and ergosphere, both of albedo and emission ½.
fn furnace(spacetime: &str, render: &str, radius: f64) -> Baked {
    let text = spacetime.to_owned()
        + &camera(DVec3::new(1.2, 0.3, -1.7), DVec3::ZERO, 100.0)
        + &film(16, 16)
        + render
        + &material("wall", 0.5, 0.5)
        + &sphere(DVec3::ZERO, radius, "wall")
        + "[[entity]]\nmesh = \"box.obj\"\nmaterial = \"wall\"\n";
    let room = closed_box(DVec3::new(-2.0, -2.5, -3.0), DVec3::new(2.0, 1.5, 2.5));
    scene_with(&text, &[("box.obj", &room)])
}

#[test]
fn a_furnace_around_a_spinning_hole_is_exactly_one() {
    for (spin, charge, radius) in
        [(0.9, 0.0, 1.15), (-0.998, 0.0, 1.4), (1.0, 0.0, 1.2), (0.6, 0.7, 1.15), (0.0, 0.0, 1.05)]
    {
        let rendered = render(&furnace(&spinning(spin, charge), WHOLE_PATHS, radius), &Run::default());
        let (low, high) = red_range(&rendered);
        println!("spin {spin}, charge {charge}: between {low} and {high}");
        assert!((f64::from(low) - 1.0).abs() < 1e-6 && (f64::from(high) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn no_bounce_between_surfaces_around_a_spinning_hole_passes_them() {
    let settings = "[render]\nspp = 100\narc_tolerance = 4e-3\nmax_depth = 20\nroulette_depth = 20\nlight_sampling = \"off\"\n";
    for (spin, radius) in [(0.9, 1.15), (0.0, 1.05)] {
        let counters =
            render(&furnace(&spinning(spin, 0.0), settings, radius), &Run::default()).stats.counters;
        let fates = counters.fates;
        assert!(fates.hit > 400_000 && fates.hit == counters.rays, "spin {spin}: {fates:?}");
    }
}

#[test]
fn a_furnace_around_a_spinning_hole_keeps_its_mean_with_light_sampling() {
    let settings = "[render]\nspp = 64\nmax_depth = 400\nroulette_depth = 5\n";
    let mean = mean_red(&render(&furnace(&spinning(0.9, 0.0), settings, 1.15), &Run::default()));
    assert!((mean - 1.0).abs() < 3e-3, "{mean}");
}

#[test]
fn a_white_ball_around_a_spinning_hole_under_a_white_sky_is_invisible() {
    let text = spinning(0.95, 0.0)
        + &camera(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, 50.0)
        + &film(24, 24)
        + WHOLE_PATHS
        + "[environment]\ncolor = [1, 1, 1]\n"
        + &material("it", 1.0, 0.0)
        + &sphere(DVec3::ZERO, 1.2, "it");
    let (low, high) = red_range(&render(&scene(&text), &Run::default()));
    assert!((low - 1.0).abs() < 1e-6 && (high - 1.0).abs() < 1e-6, "between {low} and {high}");
}

fn values(path: &Path, overrides: &[&str]) -> Vec<u32> {
    let rendered = render(&scene_file(path, overrides), &Run::default());
    let channels = rendered.image.channels.iter();
    channels.flat_map(|channel| channel.values.iter().map(|value| value.to_bits())).collect()
}

#[test]
fn spinning_holes_have_the_same_bits_by_both_schedules() {
    let path = scene_path("kerr_cornell.toml");
    for tolerance in ["1e-3", "1e-5", "1e-8"] {
        let tolerance = format!("render.tolerance={tolerance}");
        let common = ["film.width=24", "film.height=18", "render.spp=4", &tolerance];
        let with = |schedule: &str| values(&path, &[&common[..], &[schedule]].concat());
        assert_eq!(
            with("render.schedule=\"wavefront\""),
            with("render.schedule=\"per-pixel\""),
            "{tolerance}"
        );
    }
}

/// Spheroidal radius, which without spin is the areal one, of an isotropic radius around a hole of mass 1.
fn areal(rho: f64) -> f64 {
    rho * (1.0 + 0.5 / rho).powi(2)
}

#[test]
fn without_spin_the_picture_is_schwarzschilds_at_the_areal_radius() {
    let picture = |kind: &str, radius: fn(f64) -> f64| {
        let text = format!("[spacetime]\nkind = \"{kind}\"\nschwarzschild_radius = 2\n")
            + (if kind == "kerr" { "spin = 0\n" } else { "" })
            + &camera(DVec3::Z * radius(6.0), DVec3::Y * (0.05 * radius(6.0)), 80.0)
            + &film(48, 48)
            + "[render]\nspp = 1\nmax_depth = 1\ntolerance = 1e-9\narc_tolerance = 1e-6\n"
            + "[environment]\nkind = \"sky\"\n"
            + &material("ball", 0.0, 0.25)
            + &sphere(DVec3::ZERO, radius(2.5), "ball");
        render(&scene(&text), &Run::default()).image
    };
    let (kerr, schwarzschild) = (picture("kerr", areal), picture("schwarzschild", |rho| rho));
    for channel in ["R", "G", "B"] {
        let (kerr, exact) = (kerr.channel(channel).unwrap(), schwarzschild.channel(channel).unwrap());
        let far = kerr.iter().zip(exact).filter(|(a, b)| (*a - *b).abs() > 1e-5).count();
        assert!(far <= 2, "{channel}: {far} pixels differ");
    }
}

/// Directions from the equator of a hole of mass 1 that spins about +Y, in the plane of the equator, by their angle from
/// the direction to the hole, to the left where it is positive.
fn edge(scene: &Baked, r: f64, side: f64) -> f64 {
    // At the spheroidal radius r on the equator N is along −Z, turned about the axis.
    let position = DVec3::new(0.0, 0.0, r);
    let falls = |angle: f64| {
        let direction = DVec3::new(-angle.sin(), 0.0, -angle.cos());
        let ray = Ray { position, direction, origin_prim: PrimitiveId::NONE };
        shoot(scene, &[ray])[0].end == Outcome::Captured
    };
    let (mut inside, mut outside) = (0.0, side);
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if falls(middle) { inside = middle } else { outside = middle }
    }
    inside
}

#[test]
fn the_shadow_is_as_wide_as_its_circular_rays_say_and_flat_where_the_hole_turns_towards_the_camera() {
    let a = 0.9;
    let distance = 10.0_f64;
    // Prograde and retrograde critical impact parameters.
    let b = |sign: f64| sign * 6.0 * ((-sign * a).acos() / 3.0).cos() - a;
    let (prograde, retrograde) = (b(1.0), b(-1.0));
    assert!((prograde - 2.844_421_403_476).abs() < 1e-9 && (retrograde + 6.832_319_230_447).abs() < 1e-9);
    let text = format!("[spacetime]\nkind = \"kerr\"\nschwarzschild_radius = 2\nspin = {a}\n")
        + &camera(DVec3::new(0.0, 0.0, distance), DVec3::ZERO, 60.0)
        + "[environment]\ncolor = [1, 1, 1]\n";
    let scene = scene(&text);
    // The observer at rest: spheroidal radius r, s² = 1 − 2/r, and the sine of the angle from the radius of a ray of
    // impact parameter b is (s² b + 2a/r)/√Δ.
    let r = (distance * distance - a * a).sqrt();
    let (s2, delta) = (1.0 - 2.0 / r, r * r - 2.0 * r + a * a);
    let angle = |b: f64| ((s2 * b + 2.0 * a / r) / delta.sqrt()).asin();
    let width = angle(prograde) - angle(retrograde);
    let (left, right) = (edge(&scene, distance, 1.0), -edge(&scene, distance, -1.0));
    println!("left {left}, right {right}: {} wide, exactly {width}", left + right);
    assert!((left + right - width).abs() < 1e-8, "{} wide, exactly {width}", left + right);
    assert!(left < 0.6 * right, "left {left}, right {right}");
}

#[test]
fn the_shadow_seen_from_the_axis_is_round() {
    let (a, distance) = (0.9_f64, 12.0);
    let text = format!("[spacetime]\nkind = \"kerr\"\nschwarzschild_radius = 2\nspin = {a}\n")
        + &camera(DVec3::new(0.0, distance, 0.0), DVec3::X, 60.0)
        + "[environment]\ncolor = [1, 1, 1]\n";
    let scene = scene(&text);
    // Of the spherical rays through the axis: √(Q + a²) = 4.916063380228.
    let delta = distance * distance - 2.0 * distance + a * a;
    let edge = (4.916_063_380_228 * delta.sqrt() / (distance * distance + a * a)).asin();
    for azimuth in 0..12 {
        let azimuth = f64::from(azimuth) * 0.5;
        let falls = |angle: f64| {
            let across = DVec3::new(azimuth.cos(), 0.0, azimuth.sin());
            let direction = angle.sin() * across - angle.cos() * DVec3::Y;
            let position = DVec3::Y * distance;
            let ray = Ray { position, direction, origin_prim: PrimitiveId::NONE };
            shoot(&scene, &[ray])[0].end == Outcome::Captured
        };
        assert!(falls(edge * (1.0 - 1e-9)) && !falls(edge * (1.0 + 1e-9)), "azimuth {azimuth}");
    }
}
