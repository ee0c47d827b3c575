//! Punctual lights that are nearer to the hole than anything else.

use crate::support::{camera, film, hole, material, mean_red, render, scene, sphere, vector};
use glam::DVec3;
use warpfront::scene::{Baked, Precision, Schedule, StepperKind};
use warpfront::trace::Run;

const HOLE: DVec3 = DVec3::new(0.0, 3.0, 0.0);

/// A floor, lit by `light` under a hole of radius 1 above its middle; `more` is added.
fn floor(light: &str, more: &str) -> Baked {
    scene(
        &(hole(HOLE, 1.0)
            + &camera(DVec3::new(0.0, 0.5, 0.01), DVec3::ZERO, 1.0)
            + &film(4, 4)
            + "[render]\nspp = 64\nmax_depth = 2\n"
            + "[[entity]]\ndisk = { center = [0, 0, 0], normal = [0, 1, 0], outer = 5 }\n"
            + &format!("[[entity]]\nname = \"l\"\nlight = {light}\n")
            + more),
    )
}

fn point(rho: f64) -> String {
    format!("{{ kind = \"point\", position = {}, intensity = 1 }}", vector(HOLE - rho * DVec3::Y))
}

/// A black ball that covers the horizon and shadows nothing.
fn covered() -> String {
    material("black", 0.0, 0.0) + &sphere(HOLE, 0.2501, "black")
}

fn brightness(scene: &Baked) -> f64 {
    mean_red(&render(scene, &Run::default()))
}

#[test]
fn lights_nearer_to_the_hole_than_any_surface_shine() {
    let spot = |rho: f64| {
        format!(
            "{{ kind = \"spot\", position = {}, direction = [0, -1, 0], intensity = 1, outer_angle = 60 }}",
            vector(HOLE - rho * DVec3::Y)
        )
    };
    for rho in [0.26, 0.3, 0.5, 0.7, 0.93, 0.95, 1.0, 2.0] {
        for light in [point(rho), spot(rho)] {
            let (alone, beside) = (brightness(&floor(&light, "")), brightness(&floor(&light, &covered())));
            let error = (alone / beside - 1.0).abs();
            assert!(alone > 0.0 && error < 0.01, "{light}: {alone} for {beside}");
        }
    }
}

#[test]
fn they_shine_for_every_stepper_precision_and_schedule() {
    let expected = brightness(&floor(&point(0.7), &covered()));
    for stepper in [StepperKind::Rkn6, StepperKind::Series, StepperKind::Dop853] {
        for precision in [Precision::F32, Precision::F64] {
            for schedule in [Schedule::Wavefront, Schedule::PerPixel] {
                let mut scene = floor(&point(0.7), "");
                let settings = &mut scene.settings;
                (settings.stepper, settings.precision, settings.schedule) = (stepper, precision, schedule);
                let error = (brightness(&scene) / expected - 1.0).abs();
                assert!(error < 0.01, "{stepper:?} {precision:?} {schedule:?}: {error}");
            }
        }
    }
}

#[test]
fn a_light_beyond_all_surfaces_shines() {
    let far = "{ kind = \"point\", position = [300, 400, 0], intensity = 250000 }";
    let behind = material("black", 0.0, 0.0) + &sphere(DVec3::new(600.0, 800.0, 0.0), 1.0, "black");
    let (alone, before) = (brightness(&floor(far, "")), brightness(&floor(far, &behind)));
    assert!(alone > 0.0 && (alone / before - 1.0).abs() < 1e-3, "{alone} for {before}");
}

#[test]
fn lights_in_the_hole_are_named_and_shine_for_nobody() {
    for light in [point(0.0), point(0.2), point(0.25)] {
        let scene = floor(&light, "");
        let said = scene.warnings.iter().any(|line| line.contains("`l`") && line.contains("horizon"));
        assert!(said && scene.punctual.is_empty(), "{light}: {:?}", scene.warnings);
        assert_eq!(brightness(&scene), 0.0);
    }
    let distant = "{ kind = \"distant\", direction = [0, -1, 0.1], irradiance = 1 }";
    assert_eq!(floor(distant, "").punctual.len(), 1);
}
