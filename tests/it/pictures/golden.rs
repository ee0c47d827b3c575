//! Pictures of curved scenes are those of `tests/data/golden`, but for noise: references that no light sampling has
//! made.
//!
//! `tests/data/CREDITS.md` says how they are made again.

use std::f64::consts::SQRT_2;
use std::path::Path;

use crate::support::chi_square::Verdict;
use crate::support::lit::{Agreement, picture};
use crate::support::{scene_file, scene_path};
use warpfront::film::{Image, read_exr};
use warpfront::scene::LightSampling;

/// Side of a block, in pixels: its mean is nearly normal.
const BLOCK: usize = 8;

/// The differences of the colours of all blocks, in standard errors, as tests.
fn blocks(a: &Image, b: &Image) -> Verdict {
    let (width, height) = a.size;
    let mut verdict = Verdict::default();
    for name in ["R", "G", "B"] {
        let planes = |image: &Image| {
            [name.to_owned(), format!("variance.{name}")].map(|name| image.channel(&name).unwrap().to_vec())
        };
        let ([a, variance_a], [b, variance_b]) = (planes(a), planes(b));
        for (x0, y0) in
            (0..height / BLOCK).flat_map(|y| (0..width / BLOCK).map(move |x| (x * BLOCK, y * BLOCK)))
        {
            let inside = (0..BLOCK * BLOCK).map(|i| (y0 + i / BLOCK) * width + x0 + i % BLOCK);
            let (mut difference, mut variance) = (0.0, 0.0);
            for i in inside {
                difference += f64::from(a[i]) - f64::from(b[i]);
                variance += f64::from(variance_a[i]) + f64::from(variance_b[i]);
            }
            let z = difference / variance.sqrt();
            // A block without light in either picture has no noise.
            let probability = if difference == 0.0 { 1.0 } else { libm::erfc(z.abs() / SQRT_2) };
            verdict.add(format!("{name} of the block at {x0}, {y0}: z {z:+.2}"), probability);
        }
    }
    verdict
}

/// Renders the scene of the same name as the reference, and compares.
fn check(name: &str, overrides: &[&str], spp: u32) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/golden");
    let reference = read_exr(&folder.join(name).with_extension("exr")).unwrap();
    let size = [format!("film.width={}", reference.width), format!("film.height={}", reference.height)];
    let all = [&size[0], &size[1], "film.filter=box", "render.max_depth=8"];
    let mut scene = scene_file(&scene_path(name).with_extension("toml"), &[&all[..], overrides].concat());
    let image = picture(&mut scene, LightSampling::Geodesic, spp, 1);
    let agreement = Agreement::of(&image, &reference);
    agreement.check(name);
    blocks(&image, &reference).check();
    assert!(agreement.error < 0.01, "{name}: too much noise for a test: {agreement:?}");
}

#[test]
fn a_cornell_box_with_a_hole_is_that_of_the_reference() {
    check("cornell_black_hole", &[], 256);
}

#[test]
fn an_einstein_ring_is_that_of_the_reference() {
    check("einstein_ring", &[], 256);
}

#[test]
fn a_hole_in_a_glass_ball_is_that_of_the_reference() {
    check("hole_in_glass", &[], 256);
}

#[test]
fn a_room_with_a_hole_is_that_of_the_reference() {
    // Nothing runs into punctual lights: the reference has none.
    check("room_black_hole", &["entity.room.light_scale=0"], 256);
}
