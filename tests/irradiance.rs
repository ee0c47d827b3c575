//! Irradiance of small patches: under a white sky with a hole in it, and from spheres and rectangles in flat space.

mod common;

use common::{
    Row, camera, film, hole, material, mean_red, mesh, rectangle, render, scene_with, sphere, table,
};
use glam::DVec3;
use std::f64::consts::PI;
use warpfront::shade::dielectric::fresnel;
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
    /// Its irradiance in what `around` describes.
    fn irradiance(&self, around: &str, files: &[(&str, &str)]) -> f64 {
        let Patch { place, normal, size } = *self;
        let u = normal.any_orthonormal_vector();
        let patch = rectangle(DVec3::ZERO, 0.5 * size * u, 0.5 * size * normal.cross(u));
        let text = around.to_owned()
            + &camera(place + 0.2 * size * normal, place, 1.0)
            + &film(1, 1)
            + &format!("[render]\nspp = {SAMPLES}\nmax_depth = 2\nroulette_depth = 2\n")
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
    (format!("{column} at rho = {rho}"), patch.irradiance(&around, &[]), exact, allowed)
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

#[test]
fn spheres_light_a_patch_as_the_closed_form_says() {
    let rows = table("flat.csv");
    let errors: Vec<_> = rows
        .iter()
        .filter(|row| row.text("kind") == "sphere")
        .map(|row| {
            let light = sphere(row.vector(["cx", "cy", "cz"]), row.number("radius"), "light");
            let exact = row.number("value");
            (row.text("id").to_owned(), receiver(row).irradiance(&light, &[]), exact, allowed(exact))
        })
        .collect();
    judge(&errors, 30);
}

#[test]
fn rectangles_light_a_patch_as_lamberts_formula_says() {
    let rows = table("flat.csv");
    let errors: Vec<_> = rows
        .iter()
        .filter(|row| row.text("kind") == "rectangle")
        .map(|row| {
            let (u, v) = (row.vector(["ux", "uy", "uz"]), row.vector(["vx", "vy", "vz"]));
            let light = rectangle(row.vector(["cx", "cy", "cz"]), 0.5 * u, 0.5 * v);
            let around = "[[entity]]\nmesh = \"light.obj\"\nmaterial = \"light\"\n";
            let exact = row.number("value");
            let got = receiver(row).irradiance(around, &[("light.obj", &light)]);
            (row.text("id").to_owned(), got, exact, allowed(exact))
        })
        .collect();
    judge(&errors, 27);
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
