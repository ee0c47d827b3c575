//! Edges of lamps as the camera sees them; that they are smooth from few samples, and right in the mean, is tested
//! beside the code.

use crate::support::{camera, film, material, render, scene, sphere};
use glam::DVec3;
use warpfront::trace::Run;

#[test]
fn a_lamp_that_fills_the_picture_has_no_edges() {
    let text = camera(DVec3::ZERO, DVec3::Z, 40.0)
        + &film(8, 8)
        + "[render]\nspp = 16\n"
        + &material("lamp", 0.0, 3.0)
        + &sphere(DVec3::ZERO, 2.0, "lamp");
    let rendered = render(&scene(&text), &Run::default());
    assert!(rendered.image.channel("R").expect("R").iter().all(|&value| value == 3.0));
    // A ray for each sample and each probe, those of the pixels around included.
    assert_eq!(rendered.stats.counters.paths, 16 * 64);
    assert_eq!(rendered.stats.counters.rays, (16 + 8) * 64);
}
