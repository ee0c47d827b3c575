//! One primitive beside each segment, so near that boxes would not have told them apart. One core.

mod common;

use std::hint::black_box;

use common::{BUMPS, direction, random};
use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;
use rand::rngs::Xoshiro256PlusPlus;
use warpfront::geodesic::Arc;
use warpfront::geometry::{Segment, Sphere, Triangle};

fn main() {
    divan::main();
}

fn near(segment: &impl Segment, random: &mut Xoshiro256PlusPlus, size: f64) -> DVec3 {
    segment.point(0.5) + size * direction(random)
}

#[divan::bench]
fn arc_sphere(bencher: Bencher) {
    let mut random = random();
    let pairs: Vec<(Arc, Sphere)> = BUMPS
        .arcs
        .iter()
        .map(|arc| (*arc, Sphere { center: near(arc, &mut random, 0.02), radius: 0.02 }))
        .collect();
    bencher.counter(ItemsCount::new(pairs.len())).bench_local(|| {
        for (arc, sphere) in &pairs {
            black_box(arc.cross_sphere(black_box(sphere), false));
        }
    });
}

fn with_triangles<S: Segment>(bencher: Bencher, segments: &[S]) {
    let mut random = random();
    let mut triangle = |segment: &S| {
        let [a, b, c] = std::array::from_fn(|_| near(segment, &mut random, 0.02).as_vec3());
        (*segment, Triangle { a, b, c })
    };
    let pairs: Vec<(S, Triangle)> = segments.iter().map(&mut triangle).collect();
    bencher.counter(ItemsCount::new(pairs.len())).bench_local(|| {
        for (segment, triangle) in &pairs {
            black_box(segment.cross_triangle(black_box(triangle), false));
        }
    });
}

#[divan::bench]
fn arc_triangle(bencher: Bencher) {
    with_triangles(bencher, &BUMPS.arcs);
}

#[divan::bench]
fn line_triangle(bencher: Bencher) {
    with_triangles(bencher, &BUMPS.lines);
}
