//! The Einstein ring of a small light straight behind a hole, against its exact radius.

use crate::support::{camera, film, hole, material, render, scene, sphere};
use glam::DVec3;
use warpfront::trace::Run;

/// Areal radius of an isotropic one.
fn areal(rho: f64, r_s: f64) -> f64 {
    let u = r_s / (4.0 * rho);
    rho * (1.0 + u) * (1.0 + u)
}

/// Angle swept between the turning point 1/`w0` and the areal radius 1/`w`:
/// ∫ dw / √(1/b² − w² + r_s w³), with w = w0 − t² to take the root out at the turning point; Simpson's rule.
fn swept(w0: f64, w: f64, r_s: f64) -> f64 {
    const INTERVALS: usize = 2000;
    let end = (w0 - w).sqrt();
    let integrand = |t: f64| {
        let w = w0 - t * t;
        2.0 / (-(r_s * w * w + (r_s * w0 - 1.0) * (w + w0))).sqrt()
    };
    let weight = |i: usize| match i {
        0 | INTERVALS => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let h = end / INTERVALS as f64;
    (0..=INTERVALS).map(|i| weight(i) * integrand(i as f64 * h)).sum::<f64>() * h / 3.0
}

/// Angle between the axis and the ring as a static observer sees it: the ray that sweeps π from the observer at the
/// isotropic radius `observer` to the light at `light`.
fn ring_angle(observer: f64, light: f64, r_s: f64) -> f64 {
    let (r_observer, r_light) = (areal(observer, r_s), areal(light, r_s));
    let excess =
        |w0: f64| swept(w0, 1.0 / r_observer, r_s) + swept(w0, 1.0 / r_light, r_s) - std::f64::consts::PI;
    // From a ray that hardly bends to one near the photon sphere, at 3/2 r_s.
    let (mut low, mut high) = (1.0 / r_observer.min(r_light), (1.0 - 1e-9) / (1.5 * r_s));
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 { low = middle } else { high = middle }
    }
    let b = 1.0 / (low * low * (1.0 - r_s * low)).sqrt();
    (b * (1.0 - r_s / r_observer).sqrt() / r_observer).asin()
}

/// Mean distance from the image's centre, in pixels, of what is bright, weighted by brightness; the secondary ring,
/// within `inner`, is left out.
fn bright_radius(red: &[f32], size: usize, inner: f64) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for (index, &value) in red.iter().enumerate() {
        let middle = |i: usize| i as f64 + 0.5 - 0.5 * size as f64;
        let radius = middle(index % size).hypot(middle(index / size));
        if radius > inner {
            sum += radius * f64::from(value);
            weight += f64::from(value);
        }
    }
    assert!(weight > 50.0, "the ring is hardly there: {weight}");
    sum / weight
}

fn compare(center: DVec3, axis: DVec3, observer: f64, light: f64, size: f64) {
    const PIXELS: usize = 256;
    let r_s = 1.0;
    let angle = ring_angle(observer, light, r_s);
    // The ring takes four fifths of the picture's height.
    let tan_half_fov = angle.tan() / 0.8;
    let text = hole(center, r_s)
        + &camera(center - observer * axis, center, 2.0 * tan_half_fov.atan().to_degrees())
        + &film(PIXELS, PIXELS)
        + "[render]\nspp = 4\nmax_depth = 1\n"
        + &material("light", 0.0, 1.0)
        + &sphere(center + light * axis, size, "light");
    let exact = 0.8 * 0.5 * PIXELS as f64;
    let rendered = render(&scene(&text), &Run::default());
    let measured = bright_radius(rendered.image.channel("R").expect("R"), PIXELS, 0.85 * exact);
    println!("ring of {angle:.6} rad: {measured:.4} pixels, exactly {exact:.4}");
    assert!((measured - exact).abs() < 0.1, "{measured} pixels, exactly {exact}");
}

#[test]
fn the_ring_of_a_light_behind_the_hole_has_the_exact_radius() {
    compare(DVec3::ZERO, DVec3::X, 60.0, 40.0, 0.2);
}

#[test]
fn the_ring_of_a_light_close_behind_the_hole_has_the_exact_radius() {
    compare(DVec3::ZERO, DVec3::NEG_Z, 60.0, 6.0, 0.1);
}

#[test]
fn the_ring_around_a_hole_elsewhere_in_an_oblique_direction_has_the_exact_radius() {
    compare(DVec3::new(70.0, -31.0, 12.0), DVec3::new(1.0, -2.0, 0.5).normalize(), 80.0, 55.0, 0.3);
}
