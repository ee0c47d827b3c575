//! Constants of motion: energy and angular momentum, recomputed in Cartesian coordinates where a ray ends.

use crate::support::Random;
use crate::support::orbits::{fly, with_every_stepper};
use glam::DVec3;
use warpfront::geodesic::{Launch, OrbitEnd};
use warpfront::math::cross_exact;
use warpfront::spacetime::{ConformallyFlat, Fate, Schwarzschild};

/// Random rays that cross the sphere of radius 30 r_s outwards.
fn launches(medium: &Schwarzschild) -> Vec<(DVec3, DVec3, Launch)> {
    let mut random = Random::new(7);
    let mut launches = Vec::new();
    while launches.len() < 500 {
        let (x, direction) = (random.log_between(0.3, 30.0) * random.direction(), random.direction());
        let launch = Launch::new(medium, x, direction, f64::EPSILON);
        if launch.fate == Fate::Escapes {
            launches.push((x, direction, launch));
        }
    }
    launches
}

/// Inverse radius of the sphere.
const OUT: f64 = 1.0 / 30.0;

#[test]
fn energy_and_angular_momentum_at_the_end_are_those_of_the_start() {
    let medium = Schwarzschild::new(1.0);
    let launches = launches(&medium);
    with_every_stepper!(|name, stepper| {
        for tolerance in [1e-2, 1e-3, 1e-5, 1e-8, 1e-11] {
            let (mut energy, mut momentum) = (0.0f64, 0.0f64);
            for (x, direction, launch) in &launches {
                let journey = fly::<_, _, f64>(&medium, &stepper, tolerance, launch, OUT, |_| ());
                let OrbitEnd::Crosses(phase, swept) = journey.end else {
                    panic!("{name}: {:?}", journey.end)
                };
                let n_of = |x: DVec3| medium.index(1.0 / x.length());
                let end = launch.position(phase.w, swept);
                // The radial momentum, and b/ρ across: |p| is n only as far as the constraint holds.
                let p = (phase.v * phase.v + (launch.b * phase.w).powi(2)).sqrt();
                energy = energy.max((p * p / n_of(end).powi(2) - 1.0).abs());
                let l0 = cross_exact::cross(*x, n_of(*x) * *direction);
                let l1 = cross_exact::cross(end, n_of(end) * launch.direction(phase.w, phase.v, swept));
                let scale = n_of(*x) * x.length() + n_of(end) * end.length();
                momentum = momentum.max(l1.distance(l0) / scale);
            }
            println!("{name:9} {tolerance:5.0e}: |p|²/n² − 1 {energy:.1e}, L {momentum:.1e}");
            // One step of Newton's method leaves the square of what it undoes.
            let allowed = 1e-13 + tolerance * tolerance;
            assert!(energy < allowed, "{name} at {tolerance:e}: |p|²/n² − 1 is {energy:e}");
            assert!(momentum < allowed, "{name} at {tolerance:e}: L changes by {momentum:e}");
        }
    });
}

#[test]
fn what_a_step_drifts_before_it_is_put_back_is_of_the_order_of_the_tolerance() {
    let medium = Schwarzschild::new(1.0);
    let launches = launches(&medium);
    with_every_stepper!(|name, stepper| {
        for tolerance in [1e-2, 1e-3, 1e-5, 1e-8] {
            let (mut drift, mut left) = (0.0f64, 0.0f64);
            for (_, _, launch) in &launches {
                fly::<_, _, f64>(&medium, &stepper, tolerance, launch, OUT, |step| {
                    drift = drift.max(step.drift);
                    let n2 = medium.index_squared(step.end.w);
                    let p2 = step.end.v * step.end.v + (step.b * step.end.w).powi(2);
                    left = left.max((p2 / n2 - 1.0).abs());
                });
            }
            println!("{name:9} {tolerance:5.0e}: drift {drift:.1e}, left {left:.1e}");
            assert!(drift < 10.0 * tolerance, "{name} at {tolerance:e}: drift {drift:e}");
            assert!(left < 1e-13 + drift * drift, "{name} at {tolerance:e}: {left:e} is left of {drift:e}");
        }
    });
}
