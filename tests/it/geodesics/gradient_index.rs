//! Lenses without a horizon, in which every ray from a point meets again exactly: Maxwell's fish-eye and Luneburg's
//! lens.
//!
//! References: Born, Wolf, "Principles of Optics", 7th ed., 4.2.2 (fish-eye). Luneburg, "Mathematical Theory of
//! Optics", 1964, 27–29.

use std::f64::consts::PI;

use crate::support::Random;
use crate::support::orbits::{start, with_every_stepper};
use glam::DVec3;
use warpfront::geodesic::{Control, Launch, Phase, Step, Stepper};
use warpfront::math::real::Real;
use warpfront::spacetime::ConformallyFlat;

/// n = 2/(1 + ρ²): all rays from x meet again at −x/x².
///
/// n vanishes at infinity, and rays are circles.
#[derive(Clone, Copy)]
struct FishEye;

impl ConformallyFlat for FishEye {
    /// 4 w⁴/(1 + w²)².
    fn index_squared<R: Real>(&self, w: R) -> R {
        let n = (w * w + w * w) / (R::of(1.0) + w * w);
        n * n
    }

    /// 8 w³/(1 + w²)³.
    fn pull<R: Real>(&self, w: R) -> R {
        let (w2, sum) = (w * w, R::of(1.0) + w * w);
        R::of(8.0) * (w2 * w) / (sum * sum * sum)
    }

    fn horizon(&self) -> f64 {
        0.0
    }

    fn photon_sphere(&self) -> f64 {
        0.0
    }

    fn critical_impact_parameter(&self) -> f64 {
        0.0
    }
}

/// n² = 2 − ρ² within the unit sphere: parallel rays meet in a point of its surface.
#[derive(Clone, Copy)]
struct Luneburg;

impl ConformallyFlat for Luneburg {
    fn index_squared<R: Real>(&self, w: R) -> R {
        R::of(2.0) - R::of(1.0) / (w * w)
    }

    /// ½ d(−w⁻²)/dw = w⁻³.
    fn pull<R: Real>(&self, w: R) -> R {
        R::of(1.0) / (w * w * w)
    }

    fn horizon(&self) -> f64 {
        0.0
    }

    fn photon_sphere(&self) -> f64 {
        0.0
    }

    fn critical_impact_parameter(&self) -> f64 {
        0.0
    }
}

/// A ray followed until a step is `past` some point, and exactly to that point: its phase there, the angle swept and
/// the steps tried. `past` sees the step and the angle swept before it.
fn follow_until<M: ConformallyFlat, S: Stepper>(
    (medium, stepper): (&M, &S),
    tolerance: f64,
    launch: &Launch,
    past: impl Fn(&Step<f64>, f64) -> bool,
) -> (Phase<f64>, f64, u32) {
    let control = Control::new(medium, tolerance, f64::INFINITY);
    let (b, mut phase, _) = start::<_, f64>(medium, launch);
    let mut h = control.first_step(medium, S::ESTIMATE.order, b, &phase);
    let (mut swept, mut previous) = (0.0, 1.0);
    for steps in 1..100_000 {
        let step = Step::new(medium, stepper, b, phase, h);
        let verdict = control.judge::<S>(&step, 0.0, previous);
        if !verdict.accepted {
            h = verdict.next_h;
            continue;
        }
        if past(&step, swept) {
            let (mut low, mut high) = (0.0, h);
            while high - low > f64::EPSILON * h {
                let middle = 0.5 * (low + high);
                let beyond = past(&Step::new(medium, stepper, b, phase, middle), swept);
                (low, high) = if beyond { (low, middle) } else { (middle, high) };
            }
            let last = Step::new(medium, stepper, b, phase, low);
            return (last.end, swept + (b * low).atan(), steps);
        }
        (phase, previous) = (step.end, verdict.error);
        swept += (b * h).atan();
        h = control.within(verdict.next_h, b, &phase);
    }
    panic!("{launch:?} does not end");
}

#[test]
fn all_rays_from_a_point_of_the_fish_eye_meet_at_its_image() {
    with_every_stepper!(|name, stepper| {
        for tolerance in [1e-2, 1e-3, 1e-5, 1e-8] {
            let mut random = Random::new(5);
            let (mut worst, mut total) = (0.0f64, 0);
            for _ in 0..200 {
                let x = random.log_between(0.2, 5.0) * random.direction();
                let launch = Launch::new(&FishEye, x, random.direction(), f64::EPSILON);
                // The image is half a turn away in every direction; what can be off is the radius.
                let half_turn = |step: &Step<f64>, swept: f64| swept + (step.b * step.h).atan() >= PI;
                let (Phase { w, v, .. }, _, steps) =
                    follow_until((&FishEye, &stepper), tolerance, &launch, half_turn);
                total += steps;
                // A ray has the same angle to the radius at the image: v/n is the same, with the sign turned.
                let n = FishEye.index(w);
                let n0 = FishEye.index(launch.w);
                let position = launch.position(w, PI).distance(-x / x.length_squared()) / launch.w;
                // An error of the angle moves the place along the ray, by cot of the angle to the radius.
                let cot = launch.v.abs() / (launch.b * launch.w);
                let share = position / ((tolerance + 1e-14) * cot.max(1.0));
                let turned = (v / n + launch.v / n0).abs() / (tolerance + 1e-14);
                worst = worst.max(share).max(turned);
                assert!(
                    share < 1.0 && turned < 1.0,
                    "{name} at {tolerance:e}: off by {share}, turned by {turned} of what is allowed, {launch:?}"
                );
            }
            println!(
                "{name:9} {tolerance:5.0e}: worst {worst:.3} of what is allowed, {:.1} steps",
                f64::from(total) / 200.0
            );
        }
    });
}

/// A ray that enters Luneburg's lens in the direction +x at the height `b`: where it leaves it.
fn through_luneburg<S: Stepper>(stepper: &S, tolerance: f64, b: f64) -> (DVec3, DVec3, u32) {
    let x = DVec3::new(-((1.0 - b) * (1.0 + b)).sqrt(), b, 0.0);
    let launch = Launch::new(&Luneburg, x, DVec3::X, f64::EPSILON);
    // Beyond the rim the formula for the index would turn the ray back in.
    let left = |step: &Step<f64>, _: f64| step.start.v <= 0.0 && (step.end.w < 1.0 || step.end.v > 0.0);
    let (Phase { w, v, .. }, swept, steps) = follow_until((&Luneburg, stepper), tolerance, &launch, left);
    (launch.position(w, swept), launch.direction(w, v, swept), steps)
}

#[test]
fn luneburgs_lens_gathers_parallel_rays_in_a_point_of_its_rim() {
    with_every_stepper!(|name, stepper| {
        for tolerance in [1e-2, 1e-3, 1e-5, 1e-8] {
            let (mut worst, mut total) = (0.0f64, 0);
            for i in 0..100 {
                let b = 0.0099 * f64::from(i) + 0.001;
                let (place, direction, steps) = through_luneburg(&stepper, tolerance, b);
                total += steps;
                // At the focus a ray has turned by asin b.
                let exact = DVec3::new(((1.0 - b) * (1.0 + b)).sqrt(), -b, 0.0);
                let off = place.distance(DVec3::X).max(direction.distance(exact));
                let share = off / (tolerance + 1e-14);
                worst = worst.max(share);
                assert!(share < 1.0, "{name} at {tolerance:e}: {share} at b = {b}");
            }
            println!(
                "{name:9} {tolerance:5.0e}: worst {worst:.3} of what is allowed, {:.1} steps",
                f64::from(total) / 100.0
            );
        }
    });
}

#[test]
fn a_ray_through_the_centre_of_a_lens_goes_straight_on() {
    with_every_stepper!(|name, stepper| {
        for tolerance in [1e-2, 1e-5, 1e-8] {
            for b in [0.0, 1e-300, 1e-100, 1e-30, 1e-16, 1e-8, 1e-4] {
                let (place, direction, steps) = through_luneburg(&stepper, tolerance, b);
                let off = place.distance(DVec3::X).max(direction.distance(DVec3::new(1.0, -b, 0.0)));
                assert!(off < tolerance + 1e-14, "{name} at {tolerance:e}: off by {off:e} at b = {b:e}");
                println!("{name:9} {tolerance:5.0e} b = {b:e}: off by {off:.1e}, {steps} steps");
            }
        }
    });
}
