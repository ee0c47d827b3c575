//! What it costs to keep the lanes of a wavefront dense. One core.

mod common;

use std::hint::black_box;

use common::{ITEMS, random};
use divan::Bencher;
use divan::counter::ItemsCount;
use glam::{DVec3, Vec3};
use rand::RngExt;
use warpfront::math::columns::{Columns, Field, LANES, Row};

fn main() {
    divan::main();
}

/// As many bytes as a path and its ray.
#[derive(Clone, Copy, Default)]
struct Lane {
    vectors: [DVec3; 3],
    numbers: [f64; 6],
    colors: [Vec3; 2],
    counts: [u32; 6],
}

/// Blocks of the fields of a [`Lane`].
#[derive(Clone, Copy, Default)]
struct Block {
    vectors: [<DVec3 as Field>::Block<LANES>; 3],
    numbers: [<f64 as Field>::Block<LANES>; 6],
    colors: [<Vec3 as Field>::Block<LANES>; 2],
    counts: [<u32 as Field>::Block<LANES>; 6],
}

fn set<F: Field, const N: usize>(blocks: &mut [F::Block<LANES>; N], lane: usize, values: [F; N]) {
    blocks.iter_mut().zip(values).for_each(|(block, value)| F::set::<LANES>(block, lane, value));
}

impl Row for Lane {
    type Block = Block;

    #[inline(always)]
    fn get(block: &Block, lane: usize) -> Self {
        Self {
            vectors: std::array::from_fn(|i| <DVec3 as Field>::get(&block.vectors[i], lane)),
            numbers: std::array::from_fn(|i| <f64 as Field>::get(&block.numbers[i], lane)),
            colors: std::array::from_fn(|i| <Vec3 as Field>::get(&block.colors[i], lane)),
            counts: std::array::from_fn(|i| <u32 as Field>::get(&block.counts[i], lane)),
        }
    }

    #[inline(always)]
    fn set(block: &mut Block, lane: usize, row: Self) {
        set::<DVec3, _>(&mut block.vectors, lane, row.vectors);
        set::<f64, _>(&mut block.numbers, lane, row.numbers);
        set::<Vec3, _>(&mut block.colors, lane, row.colors);
        set::<u32, _>(&mut block.counts, lane, row.counts);
    }
}

fn columns() -> Columns<Lane> {
    let mut columns = Columns::default();
    columns.resize(ITEMS);
    columns
}

/// One lane in so many is finished; items are those.
#[divan::bench(args = [2, 8, 32])]
fn compaction(bencher: Bencher, one_in: u32) {
    let (mut columns, mut random) = (columns(), random());
    let finished: Vec<usize> = (0..ITEMS).filter(|_| random.random_range(0..one_in) == 0).collect();
    bencher.counter(ItemsCount::new(finished.len())).bench_local(|| {
        // From the back, so that no finished lane is moved, as the wavefront does.
        for (&lane, last) in black_box(&finished).iter().rev().zip((0..ITEMS).rev()) {
            columns.set(lane, columns.get(last));
        }
        black_box(&mut columns);
    });
}

/// A row read and written where it is, as stages do; items are lanes.
#[divan::bench]
fn rows(bencher: Bencher) {
    let mut columns = columns();
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for lane in 0..ITEMS {
            let mut row = columns.get(black_box(lane));
            row.counts[0] += 1;
            columns.set(lane, row);
        }
        black_box(&mut columns);
    });
}
