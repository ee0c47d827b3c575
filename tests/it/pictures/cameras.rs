//! Projections: what cameras other than pinholes see, in flat space and around holes.

use crate::support::{Random, film, hole, material, mean_red, render, scene, sphere};
use glam::{DMat3, DVec3, Vec3};
use warpfront::film::{Aov, Image};
use warpfront::scene::{Baked, Schedule};
use warpfront::shade::{Environment, LatLong};
use warpfront::trace::Run;

/// `[camera]` at a place that looks along −Z, with the keys of its projection.
fn view(position: &str, keys: &str) -> String {
    format!("[camera]\nposition = {position}\ndirection = [0, 0, -1]\n{keys}\n")
}

/// A lamp of radiance 1.
fn lamp(center: DVec3, radius: f64) -> String {
    material("lamp", 0.0, 1.0) + &sphere(center, radius, "lamp")
}

fn red(scene: &Baked) -> Image {
    render(scene, &Run::default()).image
}

#[test]
fn an_all_around_picture_of_a_sky_is_the_sky() {
    const SIZE: (usize, usize) = (64, 32);
    let text = film(SIZE.0, SIZE.1) + "[environment]\ncolor = 1\n[render]\nspp = 4\n";
    let mut random = Random::new(5);
    let blocks: Vec<Vec3> = (0..16 * 8).map(|_| (0.5 * (random.in_cube() + 1.1)).as_vec3()).collect();
    let pixels: Vec<Vec3> =
        (0..SIZE.0 * SIZE.1).map(|i| blocks[16 * (i / SIZE.0 / 4) + i % SIZE.0 / 4]).collect();
    for projection in ["equirectangular", "fisheye"] {
        let mut scene =
            scene(&(view("[7, 8, 9]", &format!("projection = \"{projection}\"\nfov = 360")) + &text));
        let sky =
            LatLong { width: SIZE.0, height: SIZE.1, pixels: pixels.clone(), from_world: DMat3::IDENTITY };
        scene.environment = Environment::Image(sky);
        let image = red(&scene);
        let seen = |name: &str, pixel: usize| image.channel(name).expect(name)[pixel];
        if projection == "fisheye" {
            // The middle is ahead, as that of the sky is; the corners are beside the disk.
            let middle = (SIZE.1 / 2 - 1) * SIZE.0 + SIZE.0 / 2 - 1;
            assert!(seen("A", middle) == 1.0 && seen("A", 0) == 0.0 && seen("R", 0) == 0.0);
            continue;
        }
        // Between blocks the sky is interpolated.
        for (pixel, sky) in pixels.iter().enumerate() {
            if [pixel % SIZE.0 % 4, pixel / SIZE.0 % 4].iter().all(|place| matches!(place, 1 | 2)) {
                let found = Vec3::from(["R", "G", "B"].map(|name| seen(name, pixel)));
                assert!(found.abs_diff_eq(*sky, 1e-5), "{pixel}: {found} for {sky}");
            }
        }
    }
}

#[test]
fn an_orthographic_picture_shows_a_ball_as_large_as_it_is() {
    for distance in [3.0, 1000.0] {
        let text = view("[0, 0, 0]", "projection = \"orthographic\"\nheight = 4")
            + &film(96, 48)
            + "[render]\nspp = 64\n"
            + &lamp(DVec3::new(1.5, -0.5, -distance), 1.0);
        let shown = mean_red(&render(&scene(&text), &Run::default()));
        let expected = std::f64::consts::PI / (4.0 * 8.0);
        assert!((shown / expected - 1.0).abs() < 2e-3, "{distance}: {shown} for {expected}");
    }
}

/// The mean of a picture whose half height is 1, and the mean square distance of its light from the middle.
fn spot(text: &str) -> (f64, f64) {
    const SIDE: usize = 48;
    let text = text.to_owned() + &film(SIDE, SIDE) + "[render]\nspp = 256\n";
    let image = red(&scene(&text));
    let values = image.channel("R").expect("R");
    let (mut sum, mut moment) = (0.0, 0.0);
    for (pixel, &value) in values.iter().enumerate() {
        let place = |at: usize| 2.0 * (at as f64 + 0.5) / SIDE as f64 - 1.0;
        sum += f64::from(value);
        moment += f64::from(value) * (place(pixel % SIDE).powi(2) + place(pixel / SIDE).powi(2));
    }
    (sum / (SIDE * SIDE) as f64, moment / sum)
}

#[test]
fn a_lamp_out_of_focus_is_a_disk_of_the_size_that_the_lens_makes_of_it() {
    // At the lamp's depth d the picture is 0.4 high and wide each way, and the lens blurs by R |d − f| / f.
    let tan: f64 = 0.05;
    let fov = 2.0 * tan.atan().to_degrees();
    for (focus, blades, blur) in [(4.0, 0, 0.2), (16.0, 0, 0.1), (8.0, 0, 0.0), (4.0, 6, 0.2)] {
        let keys = format!(
            "vertical_fov = {fov:?}\naperture = 0.2\nfocus_distance = {focus:?}\nblades = {blades}\nblade_rotation = 20"
        );
        let text = view("[0, 0, 0]", &keys) + &lamp(DVec3::new(0.0, 0.0, -8.0), 0.05);
        let (mean, moment) = spot(&text);
        let expected = std::f64::consts::PI * 0.05 * 0.05 / (0.8 * 0.8);
        assert!((mean / expected - 1.0).abs() < 0.03, "{focus}: {mean} for {expected}");
        // ∫ r² dA / A of a disk is R²/2, of a polygon R² (2 + cos(2π/n)) / 6.
        let of_lens = if blades == 0 { 0.5 } else { (2.0 + (std::f64::consts::TAU / 6.0).cos()) / 6.0 };
        // Pixels, of a side of 1/24, spread it as they do what is rounded: by side²/12 each way.
        let expected = (blur * blur * of_lens + 0.05 * 0.05 * 0.5) / 0.16 + 1.0 / (6.0 * 24.0 * 24.0);
        assert!((moment / expected - 1.0).abs() < 0.04, "{focus} {blades}: {moment} for {expected}");
    }
}

/// Sine of the angle of a shadow's rim for a camera at rest at an isotropic distance from a hole of r_s = 1.
fn shadow(distance: f64) -> f64 {
    let areal = distance * (1.0 + 0.25 / distance).powi(2);
    (6.75 * (1.0 - 1.0 / areal)).sqrt() / areal
}

#[test]
fn a_shadow_takes_its_part_of_all_directions() {
    let around = |center: &str, size: (usize, usize)| {
        film(size.0, size.1)
            + "[environment]\ncolor = 1\n[render]\nspp = 64\n[spacetime]\nkind = \"schwarzschild\"\n"
            + &format!("schwarzschild_radius = 1\ncenter = {center}\n")
    };
    let angle = shadow(4.0).asin();
    // Behind the camera, in two halves at the sides of the picture, and above it, along the upper edge.
    for center in ["[0, 0, 4]", "[0, 4, 0]"] {
        const SIZE: (usize, usize) = (96, 48);
        let text = view("[0, 0, 0]", "projection = \"equirectangular\"") + &around(center, SIZE);
        let image = red(&scene(&text));
        let (mut dark, mut all) = (0.0, 0.0);
        for (pixel, &value) in image.channel("R").expect("R").iter().enumerate() {
            let height = (pixel / SIZE.0) as f64 + 0.5;
            let weight = (std::f64::consts::PI * height / SIZE.1 as f64).sin();
            (dark, all) = (dark + weight * f64::from(1.0 - value), all + weight);
        }
        let expected = 0.5 * (1.0 - angle.cos());
        assert!((dark / all / expected - 1.0).abs() < 4e-3, "{center}: {} for {expected}", dark / all);
    }
    let text = view("[0, 0, 0]", "projection = \"fisheye\"\nfov = 200") + &around("[0, 0, -4]", (64, 64));
    let disk = std::f64::consts::FRAC_PI_4;
    let lit = mean_red(&render(&scene(&text), &Run::default()));
    let expected = disk * (1.0 - (angle / 100f64.to_radians()).powi(2));
    assert!((lit / expected - 1.0).abs() < 2e-3, "{lit} for {expected}");
}

/// Cameras of every projection.
const CAMERAS: [&str; 4] = [
    "vertical_fov = 50\naperture = 0.3\nfocus_distance = 5\nblades = 7",
    "projection = \"orthographic\"\nheight = 7",
    "projection = \"equirectangular\"",
    "projection = \"fisheye\"\nfov = 220\nnear = 0.5",
];

#[test]
fn every_schedule_and_batch_gives_the_same_bits_through_every_projection() {
    let kerr = "[spacetime]\nkind = \"kerr\"\nschwarzschild_radius = 1\nspin = 0.9\n".to_owned();
    for (spacetime, keys) in [hole(DVec3::ZERO, 1.0), kerr, String::new()]
        .iter()
        .flat_map(|spacetime| CAMERAS.map(|keys| (spacetime, keys)))
    {
        let text = spacetime.clone()
            + &view("[0, 0.5, 6]", keys)
            + "[film]\nwidth = 21\nheight = 17\n[environment]\ncolor = 0.5\n[render]\nspp = 4\n"
            + &material("grey", 0.5, 0.0)
            + &sphere(DVec3::new(2.5, 0.0, 0.0), 1.0, "grey")
            + &lamp(DVec3::new(-2.5, 0.5, 0.0), 0.5);
        let mut scene = scene(&text);
        let mut image = |schedule, batch| {
            scene.settings.schedule = schedule;
            render(&scene, &Run { batch, threads: 2, aovs: Aov::ALL.to_vec(), ..Run::default() }).image
        };
        let first = image(Schedule::Wavefront, 1024);
        for other in [image(Schedule::Wavefront, 3), image(Schedule::PerPixel, 1)] {
            for (one, other) in first.channels.iter().zip(&other.channels) {
                let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
                assert!(bits(&one.values) == bits(&other.values), "{keys} {spacetime}: {}", one.name);
            }
        }
        let red = first.channel("R").expect("R");
        assert!(red.iter().all(|value| value.is_finite()) && red.iter().any(|&value| value > 0.0), "{keys}");
    }
}
