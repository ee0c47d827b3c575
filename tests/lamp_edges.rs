//! Edges of lamps as the camera sees them: smooth from few samples, and right in the mean.

mod common;

use common::{camera, film, hole, material, render, scene, sphere};
use glam::DVec3;
use warpfront::trace::Run;

/// Samples per pixel without short paths to the edges of lamps, and with them.
const WITHOUT: u32 = 3;
const WITH: u32 = 16;

/// A lamp seen past a hole, in a mirror and through a ball of glass, with nothing else to see; its red plane.
fn lamps(spp: u32, seed: u32) -> Vec<f64> {
    let ball =
        |name: &str, kind: &str| format!("[[material]]\nname = \"{name}\"\nkind = \"{kind}\"\nalbedo = 1\n");
    let text = hole(DVec3::new(0.0, 0.0, 0.0), 0.4)
        + &camera(DVec3::new(0.0, 0.0, -12.0), DVec3::ZERO, 40.0)
        + &film(40, 30)
        + &format!("[render]\nspp = {spp}\nseed = {seed}\nsampler = \"independent\"\nmax_depth = 8\n")
        + &material("lamp", 0.0, 100.0)
        + &ball("mirror", "mirror")
        + &(ball("glass", "dielectric") + "ior = 1.5\n")
        + &sphere(DVec3::new(0.5, 1.0, 4.0), 0.7, "lamp")
        + &sphere(DVec3::new(-3.0, 0.0, 0.0), 1.2, "mirror")
        + &sphere(DVec3::new(2.7, 0.5, -1.0), 1.1, "glass");
    let rendered = render(&scene(&text), &Run::default());
    rendered.image.plane("R").expect("R").iter().map(|&value| f64::from(value)).collect()
}

/// Means over pictures with different seeds, and their variances.
fn statistics(spp: u32, pictures: u32) -> Vec<(f64, f64)> {
    let shots: Vec<Vec<f64>> = (0..pictures).map(|seed| lamps(spp, seed)).collect();
    let count = f64::from(pictures);
    (0..shots[0].len())
        .map(|pixel| {
            let mean = shots.iter().map(|shot| shot[pixel]).sum::<f64>() / count;
            let square = shots.iter().map(|shot| (shot[pixel] - mean).powi(2)).sum::<f64>();
            (mean, square / (count - 1.0) / count)
        })
        .collect()
}

#[test]
fn short_paths_to_the_edges_of_lamps_take_away_most_of_their_noise_and_none_of_their_light() {
    const PICTURES: u32 = 48;
    // About as many samples of both.
    let (without, with) = (statistics(WITHOUT, 5 * PICTURES), statistics(WITH, PICTURES));
    let variance = |pixels: &[(f64, f64)]| pixels.iter().map(|(_, variance)| variance).sum::<f64>();
    let ratio = variance(&without) / variance(&with);
    let mean = |pixels: &[(f64, f64)]| pixels.iter().map(|(mean, _)| mean).sum::<f64>();
    let z = (mean(&with) - mean(&without)) / (variance(&without) + variance(&with)).sqrt();
    println!("variance falls by {ratio:.1}; means {:.3} and {:.3}, z = {z:.2}", mean(&with), mean(&without));
    // Independent samples, 16 for 1: the whole of it, but for images of lamps that no probe met.
    assert!(ratio > 6.0, "{ratio}");
    assert!(z.abs() < 3.5, "{z}");
    // Pixel by pixel, where the noise is known: about one in 370 beyond 3 deviations.
    let deviations: Vec<f64> = without
        .iter()
        .zip(&with)
        .filter(|((mean, variance), (_, other))| *mean > 5.0 && *variance > 0.0 && *other > 0.0)
        .map(|((a, va), (b, vb))| (a - b) / (va + vb).sqrt())
        .collect();
    let square = deviations.iter().map(|z| z * z).sum::<f64>() / deviations.len() as f64;
    println!("{} pixels, mean square deviation {square:.2}", deviations.len());
    assert!(deviations.len() > 30 && square < 1.0 + 5.0 * (2.0 / deviations.len() as f64).sqrt(), "{square}");
}

#[test]
fn a_lamp_that_fills_the_picture_has_no_edges() {
    let text = camera(DVec3::ZERO, DVec3::Z, 40.0)
        + &film(8, 8)
        + "[render]\nspp = 16\n"
        + &material("lamp", 0.0, 3.0)
        + &sphere(DVec3::ZERO, 2.0, "lamp");
    let rendered = render(&scene(&text), &Run::default());
    assert!(rendered.image.plane("R").expect("R").iter().all(|&value| value == 3.0));
    // A ray for each sample and each probe, those of the pixels around included.
    assert_eq!(rendered.stats.counters.paths, 16 * 64);
    assert_eq!(rendered.stats.counters.rays, (16 + 4) * 64);
}
