//! Absorption inside of glass goes by the length that observers at rest measure.

use crate::support::{camera, film, hole, mean_red, render, scene_with, sphere};
use glam::DVec3;
use warpfront::trace::Run;

/// A lamp of radiance 1 behind a ball of index 1 that leaves a tenth after `distance`, seen along their axis.
fn radiance_through_ball(before: &str, more: &str, distance: f64) -> f64 {
    let glass = "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\nior = 1\nattenuation_color = 0.1\n"
        .to_owned()
        + &format!("attenuation_distance = {distance:?}\n");
    let lamp = "[[material]]\nname = \"lamp\"\nalbedo = 0\nemission = 1\n";
    let text = before.to_owned()
        + &camera(DVec3::new(12.0, 0.0, 0.0), DVec3::ZERO, 0.01)
        + &film(2, 2)
        + "[render]\nspp = 4\n"
        + more
        + &glass
        + lamp
        + &sphere(DVec3::new(6.0, 0.0, 0.0), 1.0, "glass")
        + &sphere(DVec3::new(3.0, 0.0, 0.0), 0.5, "lamp");
    mean_red(&render(&scene_with(&text, &[]), &Run::default()))
}

#[test]
fn a_ball_dims_what_is_behind_by_the_length_of_the_way_through_it() {
    for schedule in ["wavefront", "per-pixel"] {
        let more = format!("schedule = \"{schedule}\"\n");
        let radiance = radiance_through_ball("", &more, 1.6);
        let expected = libm::pow(0.1, 2.0 / 1.6);
        assert!((radiance / expected - 1.0).abs() < 1e-5, "{schedule}: {radiance}, exactly {expected}");
    }
}

#[test]
fn beside_a_hole_the_way_through_glass_is_longer() {
    // From ρ = 7 to 5 on the axis: areal r = ρ(1 + M/2ρ)², dl = dr/√(1 − 2M/r).
    let from_horizon = |rho: f64| {
        let r = rho * (1.0 + 0.5 / rho).powi(2);
        let (inner, outer) = ((r - 2.0).sqrt(), r.sqrt());
        outer * inner + 2.0 * libm::log((outer + inner) / 2f64.sqrt())
    };
    let length = from_horizon(7.0) - from_horizon(5.0);
    assert!(length > 2.3);
    let radiance = radiance_through_ball(&hole(DVec3::ZERO, 2.0), "", 1.6);
    let expected = libm::pow(0.1, length / 1.6);
    assert!((radiance / expected - 1.0).abs() < 1e-4, "{radiance}, exactly {expected}");
}

#[test]
fn on_the_axis_of_a_spinning_hole_the_way_through_glass_is_stretched_by_the_potential() {
    // From r = 7 to 5: dl = dr/√(1 − F) with F = 2Mr/(r² + a²).
    let (mass, spin, steps) = (0.5, 0.45, 20_000);
    let middles = (0..steps).map(|i| 5.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(steps));
    let stretched = |r: f64| 1.0 / (1.0 - 2.0 * mass * r / (r * r + spin * spin)).sqrt();
    let length = middles.map(stretched).sum::<f64>() * 2.0 / f64::from(steps);
    let kerr = "[spacetime]\nkind = \"kerr\"\nschwarzschild_radius = 1\nspin = 0.9\naxis = [1, 0, 0]\n";
    let radiance = radiance_through_ball(kerr, "", 1.6);
    let expected = libm::pow(0.1, length / 1.6);
    assert!((radiance / expected - 1.0).abs() < 1e-4, "{radiance}, exactly {expected}");
}
