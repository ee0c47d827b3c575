//! Images of a small light behind a hole: each of them as bright as the exact geometry factor says.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::support::{Row, camera, film, hole, material, scene, sphere, table};
use glam::DVec3;
use warpfront::geometry::PrimitiveId;
use warpfront::light::{Incoming, Lensed, LightSampler, Lights, Receiver};
use warpfront::scene::Baked;
use warpfront::shade::{Key, Sampler};
use warpfront::spacetime::Schwarzschild;

const SAMPLES: u32 = 1 << 16;
/// Most of the error that is allowed, by winding number: few samples are of rays that go around more than once.
const ALLOWED: [f64; 4] = [0.01, 0.01, 0.03, 0.03];

/// Solid angles of the images of a sphere of radius `radius` at the far end of `rows`, which are rays between the same
/// points, over the exact ones: as the mean of 1/density over light samples, sorted by where they go.
fn images(rows: &[&Row], radius: f64) -> Vec<f64> {
    let r_s = rows[0].number("rs");
    let (x, y) = (rows[0].vector(["x0", "x1", "x2"]), rows[0].vector(["y0", "y1", "y2"]));
    let text = hole(DVec3::ZERO, r_s)
        + &camera(x, y, 40.0)
        + &film(1, 1)
        + &material("light", 0.0, 1.0)
        + &sphere(y, radius, "light");
    let Baked { geometry, materials, environment, punctual, .. } = scene(&text);
    let aim = Lensed::new(Schwarzschild::new(r_s), DVec3::ZERO, rows.len() as u32 - 1).unwrap();
    let lights = Lights::new(&geometry, (&materials, &[]), &environment, &punctual, 0.1);
    let directions: Vec<DVec3> = rows.iter().map(|row| row.vector(["dx0", "dx1", "dx2"])).collect();
    // Which side of the surface is lit is of no interest: a normal halfway to all images.
    let normal = directions.iter().sum::<DVec3>().normalize_or(DVec3::Z);
    let receiver = Receiver { position: x, normal, grazing: 0.0, both_sides: false, on: PrimitiveId::NONE };
    let sampler = Sampler::sobol(1);
    let mut sums = vec![0.0; rows.len()];
    for sample in 0..SAMPLES {
        let numbers = sampler.point(Key { pixel: 0, sample, set: 1 });
        let Some(found) = aim.sample(&lights, &receiver, numbers) else { continue };
        let Incoming::Radiance(_, density) = found.light else { continue };
        let nearest = (0..rows.len())
            .min_by(|&a, &b| {
                let off = |i: usize| directions[i].distance(found.direction);
                off(a).total_cmp(&off(b))
            })
            .unwrap();
        sums[nearest] += 1.0 / density / f64::from(SAMPLES);
    }
    // The factor is per proper area.
    let scale = (1.0 + r_s / (4.0 * y.length())).powi(4);
    rows.iter()
        .zip(sums)
        .map(|(row, sum)| sum / (PI * radius * radius * scale * row.number("G_xy")))
        .collect()
}

#[test]
fn every_image_of_a_small_sphere_is_as_bright_as_the_exact_factor_says() {
    let rows = table("schwarzschild_connections.csv");
    let mut pairs: BTreeMap<i64, Vec<&Row>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.number("rs") > 0.0) {
        pairs.entry(row.number("pair") as i64).or_default().push(row);
    }
    let (mut worst, mut count) = ([0.0f64; 4], [0; 4]);
    for (pair, rows) in pairs.iter().filter(|(_, rows)| rows.len() == 4) {
        let sin = rows[0].number("Phi").sin().abs();
        let directions: Vec<DVec3> = rows.iter().map(|row| row.vector(["dx0", "dx1", "dx2"])).collect();
        let apart = |i: usize, j: usize| directions[i].distance(directions[j]);
        // Images that can be told from each other, of a light far from where they merge.
        if sin < 0.05 || apart(0, 2).min(apart(1, 3)) < 1e-3 {
            continue;
        }
        let y = rows[0].vector(["y0", "y1", "y2"]).length();
        let radius = 2e-4 * sin * (y - 0.25 * rows[0].number("rs"));
        for (winding, ratio) in images(rows, radius).into_iter().enumerate() {
            worst[winding] = worst[winding].max((ratio - 1.0).abs());
            count[winding] += 1;
            assert!((ratio - 1.0).abs() < ALLOWED[winding], "pair {pair} winding {winding}: {ratio}");
        }
    }
    println!("worst {worst:.4?} of {count:?}");
    assert!(count[0] > 10);
}
