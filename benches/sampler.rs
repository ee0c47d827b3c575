//! Random numbers: four for each of many vertices, one vertex after the other and side by side. One core.

mod common;

use std::hint::black_box;

use common::ITEMS;
use divan::Bencher;
use divan::counter::ItemsCount;
use warpfront::shade::{Key, Sampler};

fn main() {
    divan::main();
}

fn keys() -> Vec<Key> {
    let key = |i: u32| Key { pixel: i / 4, sample: i % 4, set: 1 + i % 7 };
    (0..ITEMS as u32).map(key).collect()
}

#[divan::bench]
fn one_by_one(bencher: Bencher) {
    let (sampler, keys) = (Sampler::sobol(1), keys());
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for i in 0..ITEMS {
            black_box(sampler.four(black_box(&keys)[i]));
        }
    });
}

#[divan::bench]
fn side_by_side(bencher: Bencher) {
    let (sampler, keys) = (Sampler::sobol(1), keys());
    let mut numbers = Vec::new();
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        sampler.four_all(black_box(&keys), &mut numbers);
        black_box(&numbers);
    });
}

#[divan::bench]
fn library(bencher: Bencher) {
    let keys = keys();
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for i in 0..ITEMS {
            let Key { pixel, sample, set } = black_box(&keys)[i];
            black_box(sobol_burley::sample_4d(sample, set, pixel));
        }
    });
}
