//! Irradiance of small patches: under a white sky with a hole in it, from spheres, rectangles, triangles and disks in
//! flat space, found by chance and aimed at, and from all of them around a hole, aimed at and found by chance to a
//! permille.

use crate::support::chi_square::Verdict;
use crate::support::{
    Random, Row, camera, film, hole, material, mean_red, mesh, obj, rectangle, render, scene_with, sphere,
    table, vector,
};
use glam::{DMat3, DVec3, Vec3};
use std::f64::consts::{PI, SQRT_2};
use warpfront::shade::fresnel;
use warpfront::shade::{Environment, LatLong};
use warpfront::trace::Run;

/// Samples of a patch's hemisphere: a whole Sobol' sequence.
const SAMPLES: u32 = 1 << 16;

/// A patch of albedo 1 that faces along `normal`, and a camera close above it that sees nothing else: the radiance is
/// the irradiance over π, in paths of one bounce.
struct Patch {
    place: DVec3,
    normal: DVec3,
    size: f64,
}

impl Patch {
    /// Its irradiance in what `around` describes, by `sampling`: `off`, what its rays run into; `straight`, in flat
    /// space, what light samples find alone; `geodesic`, both.
    fn irradiance(&self, sampling: &str, around: &str, files: &[(&str, &str)]) -> f64 {
        let Patch { place, normal, size } = *self;
        let u = normal.any_orthonormal_vector();
        let patch = rectangle(DVec3::ZERO, 0.5 * size * u, 0.5 * size * normal.cross(u));
        let text = around.to_owned()
            + &camera(place + 0.2 * size * normal, place, 1.0)
            + &film(1, 1)
            + &format!("[render]\nspp = {SAMPLES}\nmax_depth = 2\nroulette_depth = 2\n")
            + &format!("light_sampling = \"{sampling}\"\n")
            + &material("white", 1.0, 0.0)
            + &material("light", 0.0, 1.0)
            + &mesh("patch.obj", place, "white");
        let files = [files, &[("patch.obj", patch.as_str())]].concat();
        PI * mean_red(&render(&scene_with(&text, &files), &Run::default()))
    }
}

/// 0.3 %, one sample, and the noise of a fraction `value`/π of all samples, two standard deviations of random ones.
fn allowed(value: f64) -> f64 {
    let fraction = (value / PI).min(1.0);
    let noise = (fraction * (1.0 - fraction) / f64::from(SAMPLES)).sqrt();
    3e-3 * value + PI / f64::from(SAMPLES) + 2.0 * PI * noise
}

/// Largest error relative to what is allowed; complains about all rows beyond.
fn judge(errors: &[(String, f64, f64, f64)], least: usize) {
    let worst =
        errors.iter().map(|(_, got, exact, allowed)| (got - exact).abs() / allowed).fold(0.0, f64::max);
    let of_value = |(_, got, exact, _): &(String, f64, f64, f64)| (got - exact).abs() / exact;
    let bright = errors.iter().filter(|(_, _, exact, _)| *exact > 0.1);
    println!(
        "worst {worst:.3} of what is allowed; {:.2e} of irradiances above 0.1",
        bright.map(of_value).fold(0.0, f64::max)
    );
    let faults: Vec<_> =
        errors.iter().filter(|(_, got, exact, allowed)| (got - exact).abs() > *allowed).collect();
    assert!(faults.is_empty(), "name, irradiance, exact, allowed: {faults:#?}");
    assert!(errors.len() >= least, "{} rows", errors.len());
}

fn beside_a_hole(row: &Row, column: &str, normal: DVec3) -> (String, f64, f64, f64) {
    let rho = row.number("rho");
    let patch = Patch { place: DVec3::new(0.0, 0.0, rho), normal, size: 1e-4 * rho };
    let around = hole(DVec3::ZERO, 1.0) + "[environment]\ncolor = [1, 1, 1]\n";
    let exact = row.number(column);
    // The shadow's edge is a circle around the normal, so that samples are stratified across it.
    let allowed = 3e-3 * exact + 4.0 * PI / f64::from(SAMPLES);
    (format!("{column} at rho = {rho}"), patch.irradiance("off", &around, &[]), exact, allowed)
}

#[test]
fn a_patch_that_faces_away_from_the_hole_is_lit_by_what_the_shadow_leaves_of_the_sky() {
    let rows = table("schwarzschild_shadow.csv");
    judge(&rows.iter().map(|row| beside_a_hole(row, "E_away", DVec3::Z)).collect::<Vec<_>>(), 40);
}

#[test]
fn a_patch_that_faces_the_hole_is_lit_by_what_the_shadow_leaves_of_the_sky() {
    let rows = table("schwarzschild_shadow.csv");
    judge(&rows.iter().map(|row| beside_a_hole(row, "E_towards", DVec3::NEG_Z)).collect::<Vec<_>>(), 40);
}

fn receiver(row: &Row) -> Patch {
    let normal = row.vector(["nx", "ny", "nz"]).normalize();
    Patch { place: row.vector(["px", "py", "pz"]), normal, size: 1e-3 }
}

/// Irradiances by all ways to find light, each with what is allowed for it.
fn by_all_ways(
    name: &str,
    patch: &Patch,
    around: &str,
    files: &[(&str, &str)],
    exact: f64,
) -> Vec<(String, f64, f64, f64)> {
    let by = |sampling: &str| {
        // What is aimed finds small lights as well as large ones; of a light that hardly rises above the horizon the
        // patch's own size changes what is seen.
        let allowed = if sampling == "off" { allowed(exact) } else { 3e-3 * exact + 1e-7 };
        (format!("{name} {sampling}"), patch.irradiance(sampling, around, files), exact, allowed)
    };
    ["off", "straight", "geodesic"].map(by).to_vec()
}

#[test]
fn spheres_light_a_patch_as_the_closed_form_says() {
    let rows = table("flat.csv");
    let errors: Vec<_> = rows
        .iter()
        .filter(|row| row.text("kind") == "sphere")
        .flat_map(|row| {
            let light = sphere(row.vector(["cx", "cy", "cz"]), row.number("radius"), "light");
            by_all_ways(row.text("id"), &receiver(row), &light, &[], row.number("value"))
        })
        .collect();
    judge(&errors, 90);
}

#[test]
fn rectangles_light_a_patch_as_lamberts_formula_says() {
    let rows = table("flat.csv");
    let errors: Vec<_> = rows
        .iter()
        .filter(|row| row.text("kind") == "rectangle")
        .flat_map(|row| {
            let (u, v) = (row.vector(["ux", "uy", "uz"]), row.vector(["vx", "vy", "vz"]));
            let light = rectangle(row.vector(["cx", "cy", "cz"]), 0.5 * u, 0.5 * v);
            let around = "[[entity]]\nmesh = \"light.obj\"\nmaterial = \"light\"\n";
            by_all_ways(row.text("id"), &receiver(row), around, &[("light.obj", &light)], row.number("value"))
        })
        .collect();
    judge(&errors, 81);
}

#[test]
fn triangles_light_a_patch_as_lamberts_formula_says() {
    let mut random = Random::new(1);
    let mut errors = Vec::new();
    let patch = Patch { place: DVec3::ZERO, normal: DVec3::Z, size: 1e-3 };
    for number in 0..12 {
        let size = random.log_between(0.05, 1.0);
        let middle = DVec3::new(0.0, 0.0, 0.2 + 2.0 * size) + random.in_cube() * DVec3::new(1.0, 1.0, 0.1);
        let corners = [0; 3].map(|_| middle + size * random.in_cube());
        let edge = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            0.5 * a.angle_between(b) * a.cross(b).normalize().z
        };
        let exact = (edge(0) + edge(1) + edge(2)).abs();
        let light = obj(&corners, &[[0, 1, 2]]);
        let around = "[[entity]]\nmesh = \"light.obj\"\nmaterial = \"light\"\n";
        errors.extend(by_all_ways(
            &format!("triangle {number}"),
            &patch,
            around,
            &[("light.obj", &light)],
            exact,
        ));
    }
    judge(&errors, 36);
}

#[test]
fn disks_light_a_parallel_patch_as_the_closed_form_says() {
    // Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-13.
    let exact = |h: f64, a: f64, r: f64| {
        let (h, r) = (h / a, r / a);
        let z = 1.0 + h * h + r * r;
        0.5 * PI * (1.0 - (1.0 + h * h - r * r) / (z * z - 4.0 * r * r).sqrt())
    };
    let mut random = Random::new(2);
    let mut errors = Vec::new();
    let patch = Patch { place: DVec3::ZERO, normal: DVec3::Z, size: 1e-3 };
    for number in 0..12 {
        let (h, a) = (random.log_between(0.3, 3.0), random.log_between(0.01, 3.0));
        let outer = random.log_between(0.05, 2.0);
        let inner = if number % 2 == 0 { 0.0 } else { 0.7 * outer };
        let center = DVec3::new(a, 0.0, h);
        let light = format!(
            "[[entity]]\ndisk = {{ center = {}, normal = [0, 0, {}], inner = {inner:?}, outer = {outer:?} }}\n\
             material = \"light\"\n",
            vector(center),
            if number % 3 == 0 { 1 } else { -1 }
        );
        let exact = exact(h, a, outer) - if inner > 0.0 { exact(h, a, inner) } else { 0.0 };
        errors.extend(by_all_ways(&format!("disk {number}"), &patch, &light, &[], exact));
    }
    judge(&errors, 36);
}

/// Side of the picture of a patch: pixels are independent estimates of the same number.
const SIDE: usize = 8;

/// The mean over the pixels of a patch, and its standard error.
fn estimate(around: &str, render_settings: &str, files: &[(&str, &str)], sky: &Environment) -> (f64, f64) {
    let patch = rectangle(DVec3::ZERO, 5e-5 * DVec3::X, 5e-5 * DVec3::NEG_Z);
    let text = around.to_owned()
        + &camera(DVec3::new(0.0, 2e-5, 0.0), DVec3::ZERO, 1.0)
        + &film(SIDE, SIDE)
        + &format!("[render]\nmax_depth = 2\nroulette_depth = 2\n{render_settings}\n")
        + &material("white", 1.0, 0.0)
        + &material("light", 0.0, 1.0)
        + &mesh("patch.obj", DVec3::ZERO, "white");
    let mut scene = scene_with(&text, &[files, &[("patch.obj", patch.as_str())]].concat());
    scene.environment = sky.clone();
    let rendered = render(&scene, &Run::default());
    let pixels = rendered.image.channel("R").unwrap().iter().map(|&value| f64::from(value));
    let (n, mean) = ((SIDE * SIDE) as f64, mean_red(&rendered));
    let square = pixels.map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (square / n).sqrt())
}

/// A sky with bright and dark parts, as broad as what chance finds.
fn cloudy() -> Environment {
    let (width, height) = (8, 4);
    let bright = |i: usize| if (i * 7) % 5 < 2 { 2.0 } else { 0.6 };
    let pixels = (0..width * height).map(|i| Vec3::splat(bright(i))).collect();
    Environment::Image(LatLong { width, height, pixels, from_world: DMat3::IDENTITY })
}

#[test]
fn lights_around_a_hole_light_a_patch_as_much_aimed_at_as_found_by_chance_to_a_permille() {
    let entity = |shape: &str| format!("[[entity]]\n{shape}\nmaterial = \"light\"\n");
    let disk = |place: &str, normal: &str, inner: f64, outer: f64| {
        entity(&format!("disk = {{ center = {place}, normal = {normal}, inner = {inner}, outer = {outer} }}"))
    };
    let panel = rectangle(DVec3::new(0.0, 3.0, 0.0), 3.0 * DVec3::X, 2.0 * DVec3::Z);
    let beside = hole(DVec3::new(0.8, 1.5, 0.0), 1.0);
    let above = hole(DVec3::new(0.0, 2.0, 0.0), 1.0);
    let black = Environment::Black;
    let cases = [
        ("sphere beside", &beside, sphere(DVec3::new(-1.0, 2.0, 0.5), 1.0, "light"), &black),
        ("sphere behind", &above, sphere(DVec3::new(0.0, 4.5, 0.2), 1.5, "light"), &black),
        ("sphere around the hole", &above, sphere(DVec3::new(0.1, 2.0, 0.0), 1.0, "light"), &black),
        ("sphere around everything", &beside, sphere(DVec3::new(0.0, 1.0, 0.0), 4.0, "light"), &black),
        ("sphere that holds the patch", &above, sphere(DVec3::new(0.0, 0.3, 0.0), 0.9, "light"), &black),
        ("disk around", &above, disk("[0, 2, 0]", "[0.5, 1, 0]", 1.0, 3.0), &black),
        ("disk behind", &above, disk("[0, 4, 0]", "[0, -1, 0]", 0.0, 2.0), &black),
        ("panel behind", &above, entity("mesh = \"panel.obj\""), &black),
        ("sky", &beside, String::new(), &cloudy()),
    ];
    let mut verdict = Verdict::default();
    for (name, hole, light, sky) in cases {
        let around = format!("{hole}{light}");
        let files = [("panel.obj", panel.as_str())];
        let found = estimate(&around, "spp = 4096\nlight_sampling = \"off\"", &files, sky);
        for mis in ["balance", "power"] {
            let aimed = format!("spp = 2048\nseed = 1\nmis = \"{mis}\"");
            let aimed = estimate(&around, &aimed, &files, sky);
            let error = (found.1 * found.1 + aimed.1 * aimed.1).sqrt();
            let z = (aimed.0 - found.0) / error;
            println!(
                "{name}, {mis}: {:.5}, off by {:+.2e} ± {:.1e}",
                found.0,
                aimed.0 / found.0 - 1.0,
                error / found.0
            );
            // So much noise would hide a bias of a percent.
            assert!(error < 2e-3 * found.0, "{name}: {found:?} {aimed:?}");
            verdict.add(format!("{name}, {mis}: {found:?} {aimed:?}"), libm::erfc(z.abs() / SQRT_2));
        }
    }
    verdict.check();
}

#[test]
fn fresnel_reflectance_is_exact_to_rounding() {
    let rows = table("flat.csv");
    let mut worst = 0.0f64;
    for row in rows.iter().filter(|row| row.text("kind") == "fresnel") {
        let (eta, cosine, exact) = (row.number("param1"), row.number("param2"), row.number("value"));
        let error = (fresnel(eta, cosine) - exact).abs();
        worst = worst.max(error);
        assert!(error < 1e-14, "row {}: {} is not {exact}", row.text("id"), fresnel(eta, cosine));
    }
    println!("worst {worst:e}");
}
