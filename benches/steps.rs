//! The advance stage: first steps of rays, and arcs fitted to them. One core.

mod common;

use std::hint::black_box;

use common::{HOLE, ITEMS, TOLERANCES, rays};
use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;
use warpfront::geodesic::{Control, Launch, Phase, Rkn6, Step, Stepper, fit_arc, rk4_paper as paper_step};
use warpfront::math::columns::Columns;
use warpfront::scene::StepperKind;
use warpfront::spacetime::{Chart, ConformallyFlat, Schwarzschild};
use warpfront::trace::curved::march::march;
use warpfront::trace::curved::{CurvedFlight, CurvedMove, Lane};

/// Rays of a wavefront.
const WAVE: usize = 1024;

fn main() {
    divan::main();
}

/// Chart without geometry.
const NOWHERE: Chart = Chart { outer: 0.0, inner: f64::INFINITY, widest: f64::INFINITY };

/// Fate and sky do not matter here: rays as the stage gets them, each before its first step.
fn flights<R: Lane>(order: u32) -> Vec<CurvedFlight<R>> {
    let medium = Schwarzschild::new(HOLE);
    let control = Control::<R>::new(&medium, TOLERANCES.0, TOLERANCES.1);
    let start = |(x, direction): (DVec3, DVec3)| {
        let Launch { b, w, v, .. } = Launch::new(&medium, x, direction, R::EPSILON);
        let (b, phase) = (R::of(b), Phase::new(&medium, R::of(w), R::of(v)));
        let h = control.first_step(&medium, order, b, &phase);
        let Phase { w, v, pull } = phase;
        CurvedFlight { b, w, v, pull, h, error: R::of(1.0), ..CurvedFlight::default() }
    };
    rays(ITEMS).into_iter().map(start).collect()
}

/// The stage itself, dispatch, fitted arcs and judgement included, over wavefronts of the usual size.
fn advance<R: Lane>(bencher: Bencher, stepper: StepperKind) {
    let medium = Schwarzschild::new(HOLE);
    let control = Control::<R>::new(&medium, TOLERANCES.0, TOLERANCES.1);
    let march = march(medium, (stepper, TOLERANCES.0), control, NOWHERE).expect("a stepper of orbits");
    let rays = flights::<R>(march.order());
    let waves: Vec<Columns<CurvedFlight<R>>> = (rays.chunks(WAVE))
        .map(|rays| {
            let mut flights = Columns::default();
            flights.gather(WAVE, |i| rays[i]);
            flights
        })
        .collect();
    let mut moves = Columns::<CurvedMove<R>>::default();
    moves.resize(WAVE);
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for flights in &waves {
            march.advance_all(black_box(flights.blocks(WAVE)), moves.blocks_mut(WAVE));
            black_box(&moves);
        }
    });
}

macro_rules! steppers {
    ($($name:ident: $stepper:ident,)*) => {
        $(mod $name {
            use super::*;

            #[divan::bench]
            fn single(bencher: Bencher) {
                advance::<f32>(bencher, StepperKind::$stepper);
            }

            #[divan::bench]
            fn double(bencher: Bencher) {
                advance::<f64>(bencher, StepperKind::$stepper);
            }
        })*
    };
}
steppers! {
    rk4: Rk4,
    rkn4: Rkn4,
    leapfrog4: Leapfrog4,
    rkf45: Rkf45,
    dopri5: Dopri5,
    rkn6: Rkn6,
    dop853: Dop853,
}

#[divan::bench]
fn rk4_paper(bencher: Bencher) {
    let medium = Schwarzschild::new(HOLE);
    let momentum = |(x, direction): (DVec3, DVec3)| (x, direction * medium.index(1.0 / x.length()), 0.1);
    let states: Vec<(DVec3, DVec3, f64)> = rays(ITEMS).into_iter().map(momentum).collect();
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for (x, p, dt) in &states {
            black_box(paper_step(&medium, black_box((*x, *p)), *dt));
        }
    });
}

fn fit<R: Lane>(bencher: Bencher) {
    let medium = Schwarzschild::new(HOLE);
    let step = |flight: CurvedFlight<R>| Step::new(&medium, &Rkn6, flight.b, flight.phase(), flight.h);
    let steps: Vec<Step<R>> = flights(Rkn6::ESTIMATE.order).into_iter().map(step).collect();
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for step in &steps {
            black_box(fit_arc(black_box(step)));
        }
    });
}

#[divan::bench]
fn fit_an_arc_single(bencher: Bencher) {
    fit::<f32>(bencher);
}

#[divan::bench]
fn fit_an_arc_double(bencher: Bencher) {
    fit::<f64>(bencher);
}
