//! Steppers by themselves, on scalar equations with known solutions: orders, estimates, dense output, reversibility.

use crate::support::orbits::with_every_stepper;
use glam::DVec3;
use warpfront::geodesic::{Dop853, Launch, Leapfrog4, Phase, Rk4, Step, Stepper, Trial};
use warpfront::math::dual::Dual;
use warpfront::math::real::Real;
use warpfront::spacetime::Schwarzschild;

/// An equation W″ = G(ξ, W) and its solution.
struct Equation {
    name: &'static str,
    force: fn(f64, f64) -> f64,
    /// W and dW/dξ.
    exact: fn(f64) -> [f64; 2],
    length: f64,
}

/// Non-linear and autonomous: W = 1/(1 + ξ) obeys W″ = 2 W³. Non-linear with ξ: W = eˢ, s = sin ξ, obeys
/// W″ = W (cos² ξ − ln W), written with one of the two from ξ. Without W: W = cos 2ξ, a quadrature.
const EQUATIONS: [Equation; 3] = [
    Equation {
        name: "W″ = 2 W³",
        force: |_, w| 2.0 * w * w * w,
        exact: |xi| [1.0 / (1.0 + xi), -1.0 / (1.0 + xi).powi(2)],
        length: 0.6,
    },
    Equation {
        name: "W″ = W (cos² ξ − ln W)",
        force: |xi, w| w * (xi.cos().powi(2) - w.ln()),
        exact: |xi| [xi.sin().exp(), xi.cos() * xi.sin().exp()],
        length: 2.0,
    },
    Equation {
        name: "W″ = −4 cos 2ξ",
        force: |xi, _| -4.0 * (2.0 * xi).cos(),
        exact: |xi| [(2.0 * xi).cos(), -2.0 * (2.0 * xi).sin()],
        length: 2.0,
    },
];

impl Equation {
    /// One step of length `h` from `xi`.
    fn step<S: Stepper>(&self, stepper: &S, xi: f64, [w, v]: [f64; 2], h: f64) -> (Trial<f64>, [f64; 2]) {
        let force = |offset, [w]: [f64; 1]| [(self.force)(xi + offset, w)];
        let trial = stepper.step(force, [[w], [v], force(0.0, [w])], h);
        (trial, [w + trial.gain[0], trial.velocity[0]])
    }

    /// The error at the end after `count` steps.
    fn error<S: Stepper>(&self, stepper: &S, count: usize) -> f64 {
        let h = self.length / count as f64;
        let mut state = (self.exact)(0.0);
        for i in 0..count {
            (_, state) = self.step(stepper, i as f64 * h, state, h);
        }
        let exact = (self.exact)(self.length);
        (state[0] - exact[0]).hypot(state[1] - exact[1])
    }
}

/// Slope of log y over log x by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = logs.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    covariance / logs.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>()
}

/// Numbers of steps for which errors lie between what is not yet asymptotic and rounding.
fn steps_of_order(order: u32) -> &'static [usize] {
    match order {
        ..=4 => &[32, 48, 64, 96, 128, 192, 256],
        5 => &[24, 32, 48, 64, 96, 128],
        6 => &[16, 24, 32, 48, 64],
        _ => &[8, 10, 12, 16, 20, 24],
    }
}

#[test]
fn every_stepper_converges_with_its_order() {
    with_every_stepper!(|name, stepper| {
        for equation in &EQUATIONS {
            let order = order_of(&stepper, |count| equation.error(&stepper, count));
            println!("{name:9} {:24} order {order:.2}", equation.name);
            check_order(name, &stepper, order);
        }
    });
}

/// Slope of the error over the length of a step.
fn order_of<S: Stepper>(_: &S, error: impl Fn(usize) -> f64) -> f64 {
    let points: Vec<(f64, f64)> =
        steps_of_order(S::ORDER).iter().map(|&count| (1.0 / count as f64, error(count))).collect();
    slope(&points)
}

fn check_order<S: Stepper>(name: &str, _: &S, order: f64) {
    let exact = f64::from(S::ORDER);
    assert!((order - exact).abs() < 0.3, "{name}: {order} for {exact}");
}

#[test]
fn steps_along_an_orbit_converge_with_the_order_of_their_stepper() {
    // Past the hole at several impact parameters, by equal angles: the errors of one ray alone may cancel.
    let medium = Schwarzschild::new(1.0);
    let start = |tilt: f64| Launch::new(&medium, 8.0 * DVec3::X, DVec3::new(-1.0, tilt, 0.0), f64::EPSILON);
    let launches = [0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2].map(start);
    let end = |launch: &Launch, step: &dyn Fn(f64, Phase<f64>, f64) -> Phase<f64>, count: usize| {
        let h = (1.8 / count as f64).tan() / launch.b;
        (0..count).fold(Phase::new(&medium, launch.w, launch.v), |phase, _| step(launch.b, phase, h))
    };
    let exact =
        launches.map(|launch| end(&launch, &|b, phase, h| Step::new(&medium, &Dop853, b, phase, h).end, 200));
    with_every_stepper!(|name, stepper| {
        let step = |b, phase, h| Step::new(&medium, &stepper, b, phase, h).end;
        let order = order_of(&stepper, |count| {
            let off = |(launch, exact): (&Launch, &Phase<f64>)| {
                let phase = end(launch, &step, count);
                ((phase.w - exact.w) / exact.w).hypot(phase.v - exact.v)
            };
            launches.iter().zip(&exact).map(off).sum()
        });
        println!("{name:9} order {order:.2} along an orbit");
        check_order(name, &stepper, order);
    });
}

/// A step's error and its estimate, of position and velocity together.
fn local<S: Stepper>(equation: &Equation, stepper: &S, h: f64) -> (f64, f64) {
    let (trial, end) = equation.step(stepper, START, (equation.exact)(START), h);
    let exact = (equation.exact)(START + h);
    let error = (end[0] - exact[0]).abs() + (end[1] - exact[1]).abs();
    (error, trial.position_error[0].abs() + trial.velocity_error[0].abs())
}

/// Where single steps start.
const START: f64 = 0.3;

#[test]
fn every_estimate_falls_with_the_order_that_is_claimed_for_it() {
    with_every_stepper!(|name, stepper| {
        let claimed = estimate_order(&stepper);
        // Without W in the force there is nothing that some estimates could see.
        for equation in &EQUATIONS[..2] {
            let points: Vec<(f64, f64)> =
                LENGTHS.iter().map(|&h| (h, local(equation, &stepper, h).1)).collect();
            let order = slope(&points);
            println!("{name:9} {:24} estimate of order {order:.2}, claimed {claimed}", equation.name);
            assert!((order - claimed).abs() < 0.4, "{name}: {order} for {claimed}");
        }
    });
}

/// The order of the estimate itself: it counts times the length of the step.
fn estimate_order<S: Stepper>(_: &S) -> f64 {
    f64::from(S::ESTIMATE.order - 1)
}

/// Lengths of single steps whose errors are above rounding.
const LENGTHS: [f64; 5] = [0.08, 0.1, 0.12, 0.16, 0.2];

#[test]
fn a_shorter_step_is_as_accurate_as_the_whole() {
    with_every_stepper!(|name, stepper| {
        for equation in &EQUATIONS[..2] {
            for h in [0.2, 0.4] {
                let (whole, _) = local(equation, &stepper, h);
                for i in 1..20 {
                    let part = f64::from(i) / 20.0;
                    let (error, _) = local(equation, &stepper, part * h);
                    assert!(error < 1.2 * whole + 1e-14, "{name}: {error:e} at {part}, {whole:e} at the end");
                }
            }
            let points: Vec<(f64, f64)> = [0.15, 0.2, 0.25, 0.3, 0.4]
                .map(|h| {
                    (h, [0.25, 0.5, 0.75].map(|part| local(equation, &stepper, part * h).0).iter().sum())
                })
                .to_vec();
            let order = slope(&points);
            println!("{name:9} {:24} parts of a step: order {order:.2}", equation.name);
            check_order_at_least(name, &stepper, order);
        }
    });
}

/// A single step is off by one order more than many are.
fn check_order_at_least<S: Stepper>(name: &str, _: &S, order: f64) {
    assert!(order > f64::from(S::ORDER) + 0.5, "{name}: {order}");
}

#[test]
fn a_step_in_three_dimensions_is_one_in_each_where_they_are_independent() {
    let force = |i: usize, xi: f64, w: f64| (2.0 + i as f64) * w * (xi.cos() - w);
    let (w, v, h) = ([0.3, -0.4, 0.5], [0.1, 0.2, -0.7], 0.3);
    with_every_stepper!(|name, stepper| {
        let together = |xi, w: [f64; 3]| [force(0, xi, w[0]), force(1, xi, w[1]), force(2, xi, w[2])];
        let three = stepper.step(together, [w, v, together(0.0, w)], h);
        for i in 0..3 {
            let alone = |xi, [w]: [f64; 1]| [force(i, xi, w)];
            let one = stepper.step(alone, [[w[i]], [v[i]], alone(0.0, [w[i]])], h);
            let Trial { gain, velocity, position_error, velocity_error } = three;
            let of = |vector: [f64; 3]| [vector[i]];
            let component = Trial {
                gain: of(gain),
                velocity: of(velocity),
                position_error: of(position_error),
                velocity_error: of(velocity_error),
            };
            assert_eq!(component, one, "{name}, dimension {i}");
        }
    });
}

#[test]
fn the_composed_leapfrog_takes_back_its_steps() {
    let equation = &EQUATIONS[1];
    let there_and_back = |step: &dyn Fn(f64, [f64; 2], f64) -> [f64; 2]| {
        let start = (equation.exact)(0.3);
        let back = step(0.8, step(0.3, start, 0.5), -0.5);
        (back[0] - start[0]).hypot(back[1] - start[1])
    };
    let off = there_and_back(&|xi, state, h| equation.step(&Leapfrog4, xi, state, h).1);
    assert!(off < 4e-15, "{off:e}");
    // Others do not.
    let off = there_and_back(&|xi, state, h| equation.step(&Rk4, xi, state, h).1);
    assert!(off > 1e-8, "{off:e}");
}

/// Determinant of the derivative of a step by where it starts.
fn area<S: Stepper>(stepper: &S, h: f64) -> f64 {
    let column = |along: [f64; 2]| {
        let dual = |value, slope| Dual { value, slope };
        let force = |_, [w]: [Dual<f64>; 1]| [Dual::of(2.0) * w * w * w];
        let (w, v) = (dual(0.7, along[0]), dual(-0.4, along[1]));
        let end = stepper.step(force, [[w], [v], force(w, [w])], dual(h, 0.0));
        [(w + end.gain[0]).slope, end.velocity[0].slope]
    };
    let (a, b) = (column([1.0, 0.0]), column([0.0, 1.0]));
    a[0] * b[1] - a[1] * b[0]
}

#[test]
fn the_composed_leapfrog_preserves_areas() {
    for h in [0.1, 0.5, 1.0] {
        let off = area(&Leapfrog4, h) - 1.0;
        assert!(off.abs() < 1e-14, "{off:e} at {h}");
    }
    let off = area(&Rk4, 0.5) - 1.0;
    assert!(off.abs() > 1e-8, "{off:e}");
}
