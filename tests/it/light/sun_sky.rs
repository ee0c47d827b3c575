//! A clear sky and its sun: drawn as they are said to be, found by chance as when aimed at, and lighting what there is.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::support::chi_square::{Space, Verdict};
use crate::support::lit::{Agreement, disk, picture, variance};
use crate::support::{Random, camera, film, hole, material, render, scene_with, sphere};
use warpfront::light::Sky;
use warpfront::scene::LightSampling::{Geodesic, Off};
use warpfront::scene::{Background, load};
use warpfront::shade::Environment;
use warpfront::trace::Run;

/// `[environment]` with a clear sky.
fn clear(keys: &str) -> String {
    format!("[environment]\nkind = \"sun-sky\"\n{keys}\n")
}

fn environment(keys: &str) -> Environment {
    scene_with(&(clear(keys) + &camera(DVec3::ZERO, DVec3::NEG_Z, 40.0)), &[]).environment
}

#[test]
fn directions_of_a_clear_sky_have_the_density_that_is_said_of_them() {
    let (mut random, mut verdict) = (Random::new(1), Verdict::default());
    for keys in [
        "sun_size = 20\nsun_elevation = 35\nsun_azimuth = 50",
        "sun_size = 20\nsun_elevation = 5",
        "sun_disk = false",
        "air = 0\ndust = 0\nground_albedo = 0\nsun_size = 20\nsun_elevation = 70",
    ] {
        let sky = Sky::of(&environment(keys)).expect("a bright sky");
        let samples: Vec<_> = (0..20_000)
            .map(|_| {
                sky.sample(random.between(0.0, 1.0), random.between(0.0, 1.0)).map(|drawn| drawn.direction)
            })
            .collect();
        // By columns and rows of a picture, in which solid angle has sin θ.
        let space = Space {
            place: &|d: DVec3| [0.5 + libm::atan2(d.x, -d.z) / (2.0 * PI), libm::acos(d.y) / PI],
            at: &|[u, v]| {
                let ((sin, cos), longitude) = (libm::sincos(PI * v), 2.0 * PI * (u - 0.5));
                let (across, along) = libm::sincos(longitude);
                DVec3::new(sin * across, cos, -sin * along)
            },
            measure: 2.0 * PI * PI,
        };
        let density = |d: DVec3| sky.density(d) * (d.x * d.x + d.z * d.z).sqrt();
        verdict.add(keys.to_owned(), space.probability(samples, density));
    }
    verdict.check();
}

#[test]
fn the_sun_is_a_tile_of_its_own() {
    let environment = environment("sun_elevation = 40\nsun_azimuth = -30");
    let Environment::SunSky(clear) = &environment else { panic!("{environment:?}") };
    let (sun, sky) = (clear.disk().unwrap(), Sky::of(&environment).unwrap());
    let (index, tile) = sky.tile_of(sun.middle);
    let beside = (sun.middle + 1.5 * sun.radius * sun.middle.any_orthonormal_vector()).normalize();
    assert!(sky.tile_of(beside).0 != index && sky.tile_of(beside).1.half_axes[0].length() > sun.radius);
    assert!(tile.middle == sun.middle && (tile.half_axes[0].length() - sun.radius).abs() < 1e-9);
    let (mut sum, mut seen) = (0.0, std::collections::BTreeMap::new());
    for i in 0..100_000 {
        let (index, tile, _) = sky.choose_tile((f64::from(i) + 0.5) * 1e-5).unwrap();
        sum += if seen.insert(index, tile.pmf).is_none() { tile.pmf } else { 0.0 };
    }
    assert!((sum - 1.0).abs() < 1e-3, "{sum}");
}

#[test]
fn a_sun_is_found_by_chance_as_often_as_it_is_aimed_at() {
    let place = DVec3::new(0.0, 3.0, -2.0);
    let spinning =
        hole(place, 1.0).replace("\"schwarzschild\"", "\"kerr\"\nspin = 0.9\naxis = [0.3, 1, 0.2]");
    for (name, spacetime) in [("flat", String::new()), ("hole", hole(place, 1.0)), ("spinning", spinning)] {
        let text = spacetime
            + &clear("sun_size = 20\nsun_elevation = 35\nsun_azimuth = 20\nground_albedo = 0.2")
            // The hole and the sky around it are out of sight: noise of what the camera sees is the same with both.
            + &camera(DVec3::new(0.0, 2.5, 5.0), DVec3::new(0.0, -0.5, 2.5), 35.0)
            + &film(32, 32)
            + "[render]\nmax_depth = 3\n"
            + &material("floor", 0.7, 0.0)
            + &disk(DVec3::ZERO, DVec3::Y, 0.0, 9.0, "floor")
            + &sphere(DVec3::new(1.5, 0.6, 1.0), 0.6, "floor");
        let mut scene = scene_with(&text, &[]);
        let with = picture(&mut scene, Geodesic, 128, 1);
        let without = picture(&mut scene, Off, 512, 2);
        Agreement::of(&with, &without).check(name);
        let gain = variance(&without, 512) / variance(&with, 128);
        println!("{name}: {gain:.1} times less noise");
        assert!(gain > 2.0, "{name}: {gain}");
    }
}

/// A white plain seen from above.
fn plain(sky: &str) -> String {
    clear(sky)
        + &camera(DVec3::new(0.0, 2.0, 0.0), DVec3::ZERO, 20.0)
        + &film(8, 8)
        + "[render]\nspp = 64\nmax_depth = 2\n"
        + &material("white", 1.0, 0.0)
        + &disk(DVec3::ZERO, DVec3::Y, 0.0, 9.0, "white")
}

#[test]
fn the_sun_without_air_lights_a_plain_as_its_irradiance_says() {
    // Without air there is the sun alone, as small as it is.
    let keys = "air = 0\ndust = 0\nozone = 0\nground_albedo = 0\nsun_elevation = 30";
    let image = render(&scene_with(&plain(keys), &[]), &Run::default()).image;
    for (name, outside) in [("R", 204.233f32), ("G", 179.153), ("B", 166.728)] {
        let plane = image.channel(name).unwrap();
        let mean = plane.iter().sum::<f32>() / plane.len() as f32;
        let expected = 0.5 * outside / std::f32::consts::PI;
        assert!((mean / expected - 1.0).abs() < 2e-3, "{name}: {mean} is not {expected}");
    }
}

#[test]
fn a_sky_that_the_camera_does_not_see_lights_the_scene_all_the_same() {
    let text = clear("sun_elevation = 40")
        + &camera(DVec3::new(0.0, 1.0, 6.0), DVec3::new(0.0, 1.0, 0.0), 50.0)
        + &film(16, 16)
        + &material("white", 0.8, 0.0)
        + &disk(DVec3::ZERO, DVec3::Y, 0.0, 3.0, "white");
    let mut scene = scene_with(&text, &[]);
    let opaque = render(&scene, &Run::default()).image;
    scene.settings.background = Background::Transparent;
    let transparent = render(&scene, &Run::default()).image;
    let (alpha, red) = (transparent.channel("A").unwrap(), transparent.channel("R").unwrap());
    assert!(opaque.channel("A").unwrap().iter().all(|&alpha| alpha == 1.0));
    assert!((alpha[0], red[0]) == (0.0, 0.0) && opaque.channel("R").unwrap()[0] > 0.1);
    let lit = alpha.iter().zip(red).filter(|(alpha, _)| **alpha == 1.0);
    assert!(lit.clone().count() > 20 && lit.into_iter().all(|(_, &red)| red > 10.0));
}

#[test]
fn keys_of_a_clear_sky_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let load = |text: &str| {
        std::fs::write(&path, text).unwrap();
        load(&path, &[]).map_err(|error| error.to_string())
    };
    for (keys, expected) in [
        ("sun_elevation = 91", "sun_elevation must be from -90 to 90"),
        ("sun_elevation = nan", "sun_elevation must be finite"),
        ("sun_azimuth = inf", "sun_azimuth must be finite"),
        ("sun_size = 0", "sun_size must be from 0.01 to 20"),
        ("sun_strength = -1", "sun_strength must not be negative"),
        ("dust = 11", "dust must be from 0 to 10"),
        ("ozone = -1", "ozone must be from 0 to 10"),
        ("ground_albedo = 1.5", "ground_albedo must be at most 1"),
        ("sun_elevaton = 10", "did you mean `sun_elevation`?"),
        ("sun_disk = 1", "sun_disk"),
        ("rotation = 10", "write `sun_azimuth`"),
        ("color = 1", "exclude each other"),
        ("strength = -2", "strength must not be negative"),
        ("sun_strength = 1e9", "`strength` times `sun_strength` is more than 1e8"),
    ] {
        let message = load(&clear(keys)).err().unwrap_or_else(|| panic!("{keys} is accepted"));
        assert!(message.contains(expected) && message.contains("help: "), "{keys}: {message}");
        assert!(message.contains("scene.toml:"), "{keys}: {message}");
    }
    let other = load("[environment]\nkind = \"sky\"\nair = 1\n").err().unwrap();
    assert!(other.contains("`air` is for `kind = \"sun-sky\"`"), "{other}");
    let wormhole = "[spacetime]\nkind = \"ellis-wormhole\"\nthroat_radius = 1\n[camera]\nposition = [0, 0, 9]\n\
                    look_at = [0, 0, 0]\nvertical_fov = 40\n[environment.far]\nkind = \"sun-sky\"\n";
    let Ok(scene) = load(wormhole) else { panic!("a far sky") };
    assert!(matches!(scene.far.environment, Environment::SunSky(_)));
    let lenses = "[spacetime]\nkind = \"several-holes\"\n[[spacetime.hole]]\ncenter = [0, 0, -9]\nmass = 1\n"
        .to_owned()
        + &camera(DVec3::ZERO, DVec3::Z, 40.0);
    for (keys, warnings) in [("", 1), ("sun_disk = false", 0)] {
        let Ok(scene) = load(&(lenses.clone() + &clear(keys))) else { panic!("{keys}") };
        assert_eq!(scene.warnings.len(), warnings, "{:?}", scene.warnings);
    }
    let ball = material("grey", 0.5, 0.0) + &sphere(5.0 * DVec3::Z, 1.0, "grey");
    let night = load(&(clear("sun_elevation = -90") + &camera(DVec3::ZERO, DVec3::Z, 40.0) + &ball)).unwrap();
    assert_eq!(night.environment.radiance(DVec3::Y), Vec3::ZERO);
}
