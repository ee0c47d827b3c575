//! First steps of rays, each in one loop over the arrays of a wave: (b, phase, h) in, the step out; and arcs fitted to
//! them. One core.

mod common;

use std::hint::black_box;

use common::{HOLE, ITEMS, TOLERANCES, rays};
use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;
use warpfront::geodesic::{
    Control, Dop853, Dopri5, Launch, Leapfrog4, PaperRk4, Phase, Rk4, Rkf45, Rkn4, Rkn6, Step, Stepper,
    fit_arc,
};
use warpfront::math::real::Real;
use warpfront::spacetime::{ConformallyFlat, Schwarzschild};

fn main() {
    divan::main();
}

type Start<R> = (R, Phase<R>, R);

fn starts<R: Real, S: Stepper>() -> Vec<Start<R>> {
    let medium = Schwarzschild::new(HOLE);
    let control = Control::<R>::new(&medium, TOLERANCES.0, TOLERANCES.1);
    let start = |(x, direction): (DVec3, DVec3)| {
        let Launch { b, w, v, .. } = Launch::new(&medium, x, direction, R::EPSILON);
        let (b, phase) = (R::of(b), Phase::new(&medium, R::of(w), R::of(v)));
        (b, phase, control.first_step(&medium, S::ESTIMATE.order, b, &phase))
    };
    rays(ITEMS).into_iter().map(start).collect()
}

fn take<R: Real, S: Stepper>(bencher: Bencher, stepper: S) {
    let (medium, starts) = (Schwarzschild::new(HOLE), starts::<R, S>());
    let mut ends = vec![(Phase::<R>::default(), R::default()); ITEMS];
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for (&(b, phase, h), end) in black_box(&starts).iter().zip(&mut ends) {
            let step = Step::new(&medium, &stepper, b, phase, h);
            *end = (step.end, step.embedded + step.undone);
        }
        black_box(&ends);
    });
}

macro_rules! steppers {
    ($($name:ident: $stepper:ident,)*) => {
        $(mod $name {
            use super::*;

            #[divan::bench]
            fn single(bencher: Bencher) {
                take::<f32, _>(bencher, $stepper);
            }

            #[divan::bench]
            fn double(bencher: Bencher) {
                take::<f64, _>(bencher, $stepper);
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
    let (medium, stepper) = (Schwarzschild::new(HOLE), PaperRk4 { r_s: HOLE });
    let momentum =
        |(x, direction): (DVec3, DVec3)| (x, direction * medium.index_squared(1.0 / x.length()).sqrt(), 0.1);
    let states: Vec<(DVec3, DVec3, f64)> = rays(ITEMS).into_iter().map(momentum).collect();
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for (x, p, dt) in &states {
            black_box(stepper.step(black_box(*x), *p, *dt));
        }
    });
}

fn fit<R: Real>(bencher: Bencher) {
    let medium = Schwarzschild::new(HOLE);
    let step = |(b, phase, h): Start<R>| Step::new(&medium, &Rkn6, b, phase, h);
    let steps: Vec<Step<R>> = starts::<R, Rkn6>().into_iter().map(step).collect();
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
