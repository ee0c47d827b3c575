//! Random numbers: those of the next ray and of a light ray for each of many vertices, one vertex after the other and
//! side by side. One core.

mod common;

use std::hint::black_box;

use common::ITEMS;
use divan::Bencher;
use divan::counter::ItemsCount;
use warpfront::shade::{Key, SamplePoint, Sampler};

fn main() {
    divan::main();
}

fn keys() -> Vec<Key> {
    let key = |i: u32| Key { pixel: i / 4, sample: i % 4, set: 1 + i % 7 };
    (0..ITEMS as u32).map(key).collect()
}

#[divan::bench(types = [[f32; 4], [f64; 2]])]
fn one_by_one<P: SamplePoint>(bencher: Bencher) {
    let (sampler, keys) = (Sampler::sobol(1), keys());
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for i in 0..ITEMS {
            black_box(sampler.point::<P>(black_box(&keys)[i]));
        }
    });
}

#[divan::bench(types = [[f32; 4], [f64; 2]])]
fn side_by_side<P: SamplePoint>(bencher: Bencher) {
    let (sampler, keys) = (Sampler::sobol(1), keys());
    let mut points: Vec<P> = Vec::new();
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        sampler.points(black_box(&keys), &mut points);
        black_box(&points);
    });
}
