//! Steps and arcs against what they promise: orders of convergence, and distances from the curve.

mod common;

use common::Random;
use glam::DVec3;
use warpfront::geodesic::{Arc, Control, Dense, Rkn4, Rkn5, Step, Stepper};
use warpfront::spacetime::{ConformallyFlat, Schwarzschild};

const HOLE: fn() -> Schwarzschild = || Schwarzschild::new(1.0);

/// Position after σ = `length` in `count` equal steps, of a ray that passes the hole at b about 5 r_s.
fn fly<S: Stepper>(stepper: &S, count: usize, length: f64) -> DVec3 {
    let medium = HOLE();
    let x = DVec3::new(-8.0, 4.0, 1.0);
    let p = medium.momentum(x, DVec3::new(1.0, 0.05, -0.1).normalize());
    let mut state = [x, p, medium.force(x)];
    for _ in 0..count {
        state = stepper.step(&medium, state, length / count as f64).end;
    }
    state[0]
}

/// Slope of log error over log step by least squares.
fn order<S: Stepper>(stepper: &S) -> f64 {
    const LENGTH: f64 = 12.0;
    let exact = fly(&Rkn5, 40_000, LENGTH);
    let points: Vec<(f64, f64)> = [48, 64, 96, 128, 192, 256, 384]
        .map(|count| (-(count as f64).ln(), fly(stepper, count, LENGTH).distance(exact).ln()))
        .to_vec();
    let n = points.len() as f64;
    let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    covariance / points.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>()
}

#[test]
fn rkn4_converges_with_order_4() {
    let order = order(&Rkn4);
    println!("{order:.3}");
    assert!((order - 4.0).abs() < 0.3, "{order}");
}

#[test]
fn rkn5_converges_with_order_5() {
    let order = order(&Rkn5);
    println!("{order:.3}");
    assert!((order - 5.0).abs() < 0.3, "{order}");
}

/// Largest distance of the dense output from the arc, both sampled finely; the curves run beside each other.
fn distance(arc: &Arc, step: &Step) -> f64 {
    const SAMPLES: usize = 32;
    const POINTS: usize = 256;
    let dense = Dense::new(step);
    let points: Vec<DVec3> = (0..=POINTS).map(|i| arc.point(i as f64 / POINTS as f64)).collect();
    let from_curve = |p: DVec3| {
        let pieces = points.windows(2).map(|ends| {
            let along = ends[1] - ends[0];
            let t = ((p - ends[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            p.distance(ends[0] + t * along)
        });
        pieces.fold(f64::INFINITY, f64::min)
    };
    (1..SAMPLES).map(|i| from_curve(dense.position(i as f64 / SAMPLES as f64))).fold(0.0, f64::max)
}

/// A random ray's next step under `control`, tried until it is accepted.
fn accepted_step(random: &mut Random, control: &Control) -> Option<(Arc, Step)> {
    let medium = HOLE();
    let x = random.log_between(0.27, 100.0) * random.direction();
    let p = medium.momentum(x, random.direction());
    let start = [x, p, medium.force(x)];
    let mut h = control.first_step(&Rkn5, &medium, x, p);
    for _ in 0..50 {
        let step = Rkn5.step(&medium, start, h);
        let verdict = control.judge(&step);
        if verdict.accepted {
            return Some((verdict.arc, step));
        }
        h = verdict.next_h;
    }
    None
}

#[test]
fn arcs_of_accepted_steps_keep_to_the_curve_within_about_the_arc_tolerance() {
    const STEPS: usize = 10_000;
    let mut random = Random::new(11);
    let mut shares: Vec<f64> = (0..STEPS)
        .map(|i| {
            let arc_tolerance = [1e-2, 1e-3, 1e-4, 1e-5][i % 4];
            let control = Control::new(&Rkn5, 1e-4, arc_tolerance);
            let (arc, step) = accepted_step(&mut random, &control).expect("a step is accepted in the end");
            // Polylines of 256 pieces stay within 2 s/256² of an arc of sagitta s.
            distance(&arc, &step) / (arc_tolerance + 2.0 * arc.sagitta() / 65536.0)
        })
        .collect();
    shares.sort_by(f64::total_cmp);
    let at = |quantile: f64| shares[(quantile * (STEPS - 1) as f64) as usize];
    println!(
        "median {:.3}, 90 % {:.3}, 99 % {:.3}, worst {:.3} of the tolerance",
        at(0.5),
        at(0.9),
        at(0.99),
        at(1.0)
    );
    // The estimate is one, not a bound.
    assert!(
        at(0.9) <= 1.0 && at(0.99) <= 2.0 && at(1.0) <= 4.0,
        "99 % {}, worst {} of the tolerance",
        at(0.99),
        at(1.0)
    );
}
