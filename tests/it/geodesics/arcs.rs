//! Arcs against the curve that they stand in for: the estimate that steps are held to, and the distance.

use crate::support::Random;
use crate::support::orbits::start;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use warpfront::geodesic::{
    Arc, ArealSeries, Control, Dop853, Launch, OrbitStepper, Phase, PlaneArc, Rkn6, Step, fit_arc,
};
use warpfront::spacetime::{Chart, ConformallyFlat, Fate, Schwarzschild};

/// Half the edge of the box that rays move in, and the size of the hole at its centre.
const HALF_EDGE: f64 = 50.0;
const HOLE: f64 = 5.0;

/// Places at which a step is compared with its arc.
const SAMPLES: usize = 24;

/// The curve along a step, in many short ones: its points, its unit tangents there, and its end.
///
/// What the step itself is off by at its end is for `tolerance` to bound.
fn curve(medium: &Schwarzschild, step: &Step<f64>) -> (Vec<DVec2>, Vec<DVec2>, Phase<f64>) {
    let b = step.b;
    let part = (b * step.h).atan() / SAMPLES as f64;
    let h = if part > 1e-6 { part.tan() / b } else { step.h / SAMPLES as f64 };
    let mut phase = step.start;
    let (mut points, mut tangents) = (Vec::new(), Vec::new());
    for i in 1..=SAMPLES {
        phase = Step::new(medium, &Dop853, b, phase, h).end;
        let (sin, cos) = (i as f64 * part).sin_cos();
        points.push(DVec2::new(cos / phase.w - 1.0 / step.start.w, sin / phase.w));
        tangents.push(DVec2::new(cos, sin).rotate(phase.momentum(b).into()).normalize());
    }
    (points, tangents, phase)
}

/// A step's arc in its plane.
fn in_plane(arc: &PlaneArc<f64>) -> Arc {
    arc.placed(DVec3::ZERO, DVec3::X, DVec3::Y)
}

/// Parameter of the point of the arc next to `point`.
fn foot(point: DVec3, arc: &Arc) -> f64 {
    // Newton's method for the foot of the perpendicular, from beside the point.
    let mut s = arc.parameter_beside(point);
    for _ in 0..3 {
        let d = 1e-5;
        let velocity = (arc.point(s + d) - arc.point(s - d)) / (2.0 * d);
        s += (point - arc.point(s)).dot(velocity) / velocity.length_squared();
    }
    s
}

/// Largest distance of points from the arc.
fn distance(points: &[DVec2], arc: &Arc) -> f64 {
    let from_arc = |p: DVec3| p.distance(arc.point(foot(p, arc)));
    points.iter().map(|p| from_arc(p.extend(0.0))).fold(0.0, f64::max)
}

/// A random step of a random ray through the box: a march from a random start, of whose accepted steps one is drawn.
fn random_step<S: OrbitStepper>(
    medium: &Schwarzschild,
    stepper: &S,
    random: &mut Random,
    tolerances: (f64, f64),
) -> Option<(Step<f64>, PlaneArc<f64>)> {
    let control = stepper.control(&Control::new(medium, tolerances.0, tolerances.1));
    let chart = Chart::new(medium, 0.0, HALF_EDGE * 3f64.sqrt());
    let x = loop {
        let x = HALF_EDGE * random.in_cube();
        if x.length() > 1.01 * medium.horizon() {
            break x;
        }
    };
    // Half of the rays pass the hole.
    let direction = if random.between(0.0, 1.0) < 0.5 {
        random.direction()
    } else {
        (4.0 * HOLE * random.in_cube() - x).normalize()
    };
    let launch = Launch::new(medium, x, direction, f64::EPSILON);
    let (b, mut phase, fate): (f64, Phase<f64>, Fate) = start(medium, &launch);
    let (mut h, mut previous) = (control.first_step(medium, S::ORDER, b, &phase), 1.0);
    let (mut chosen, mut taken) = (None, 0.0);
    for _ in 0..2000 {
        if chart.is_left(fate, phase.w, phase.v) {
            break;
        }
        let step = stepper.step(medium, b, phase, h);
        let arc = fit_arc(&step);
        let verdict = stepper.judge(&control, &step, arc.error, previous);
        if !verdict.accepted {
            h = verdict.next_h;
            continue;
        }
        // Each of the steps with the same chance. What lies far outside is never searched.
        taken += 1.0;
        let searched = step.end.w > chart.outer / 10.0;
        if searched && random.between(0.0, 1.0) < 1.0 / taken {
            chosen = Some((step, arc));
        }
        (phase, previous) = (step.end, verdict.error);
        h = control.within(verdict.next_h, b, &phase);
    }
    chosen
}

/// Distances over the arc tolerance of accepted steps, sorted, with steps whose estimate counts for it.
fn shares<S: OrbitStepper>(stepper: &S, tolerance: f64, arc_tolerance: f64, count: u64) -> Vec<(f64, f64)> {
    let medium = Schwarzschild::new(HOLE);
    let share = |seed: u64| {
        let mut random = Random::new(seed);
        let (step, arc) = loop {
            if let Some(found) = random_step(&medium, stepper, &mut random, (tolerance, arc_tolerance)) {
                break found;
            }
        };
        let (points, _, end) = curve(&medium, &step);
        let arc = PlaneArc {
            error: arc.error,
            ..fit_arc(&Step { end, rise: end.w - step.start.w * step.cos, ..step })
        };
        let away = distance(&points, &in_plane(&arc));
        // Rounding of the box.
        (away / (arc_tolerance + 1e-14 * HALF_EDGE), away / (arc.error + 1e-12))
    };
    let mut shares: Vec<(f64, f64)> = (0..count).into_par_iter().map(share).collect();
    shares.sort_by(|a, b| a.0.total_cmp(&b.0));
    shares
}

fn check<S: OrbitStepper>(name: &str, stepper: &S, tolerance: f64) {
    for arc_tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        let shares = shares(stepper, tolerance, arc_tolerance, 10_000);
        let at = |quantile: f64| shares[(quantile * (shares.len() - 1) as f64) as usize].0;
        let mut ratios: Vec<f64> = shares.iter().filter(|s| s.0 > 1e-3).map(|s| s.1).collect();
        ratios.sort_by(f64::total_cmp);
        let ratio =
            |quantile: f64| ratios.get((quantile * (ratios.len().max(1) - 1) as f64) as usize).copied();
        println!(
            "{name:6} {tolerance:5.0e} arc tolerance {arc_tolerance:5.0e}: distance over it: median {:.4}, 99 % {:.3}, largest {:.3}; \
             over its estimate: median {:.3}, 99 % {:.3}, largest {:.3} of {}",
            at(0.5),
            at(0.99),
            at(1.0),
            ratio(0.5).unwrap_or(0.0),
            ratio(0.99).unwrap_or(0.0),
            ratio(1.0).unwrap_or(0.0),
            ratios.len()
        );
        assert!(at(0.99) <= 1.0 && at(1.0) <= 2.0, "99 % {}, largest {} of the tolerance", at(0.99), at(1.0));
    }
}

#[test]
fn arcs_keep_to_the_curve_within_the_arc_tolerance() {
    check("Rkn6", &Rkn6, 1e-2);
}

#[test]
fn arcs_of_the_standard_preset_keep_to_the_curve_within_the_arc_tolerance() {
    check("Rkn6", &Rkn6, 1e-5);
}

/// The series around the hole of these tests.
fn series<const P: usize>(tolerance: f64) -> ArealSeries<P> {
    ArealSeries::new(&Schwarzschild::new(HOLE).as_hole().expect("it is one"), tolerance)
}

#[test]
fn arcs_of_the_series_keep_to_the_curve_within_the_arc_tolerance() {
    check("series", &series::<8>(1e-3), 1e-3);
    check("series", &series::<10>(1e-5), 1e-5);
    check("series", &series::<14>(1e-8), 1e-8);
}

#[test]
fn arcs_of_the_longest_steps_keep_to_the_curve_within_the_arc_tolerance() {
    check("Dop853", &Dop853, 1e-3);
}

#[test]
fn arcs_that_stand_for_their_rays_err_by_less_than_the_tolerance() {
    for tolerance in [1e-3, 1e-5, 1e-7] {
        check_close(&Rkn6, tolerance, 2000, |_| true);
    }
    check_close(&series::<8>(1e-3), 1e-3, 500, is_clear);
    check_close(&series::<10>(1e-5), 1e-5, 500, is_clear);
}

/// True of a step that is not so near the horizon that the rounding of its chart is a part of the step.
fn is_clear(step: &Step<f64>) -> bool {
    step.end.w * Schwarzschild::new(HOLE).horizon() < 1.0 - 1e-4
}

/// Checks arcs that stand for their rays, at least `least` of 10 000 steps, those that `is_checked` is true of.
fn check_close(
    stepper: &impl OrbitStepper,
    tolerance: f64,
    least: usize,
    is_checked: fn(&Step<f64>) -> bool,
) {
    let medium = Schwarzschild::new(HOLE);
    let control = Control::new(&medium, tolerance, 1e-2);
    let of = |seed: u64| {
        let (step, arc) = random_step(&medium, stepper, &mut Random::new(seed), (tolerance, 1e-2))?;
        let (points, tangents, _) = curve(&medium, &step);
        let plane = in_plane(&arc);
        let turned = |(p, tangent): (&DVec2, &DVec2)| {
            plane.velocity(foot(p.extend(0.0), &plane)).normalize().cross(tangent.extend(0.0)).length()
        };
        let turned = points.iter().zip(&tangents).map(turned).fold(0.0, f64::max);
        let away = distance(&points, &plane) / plane.p0.distance(plane.p2);
        (control.is_close(&arc) & is_checked(&step)).then_some((away / tolerance, turned / tolerance))
    };
    let close: Vec<(f64, f64)> = (0..10_000).into_par_iter().filter_map(of).collect();
    let largest = close.iter().fold((0.0, 0.0), |a: (f64, f64), b| (a.0.max(b.0), a.1.max(b.1)));
    println!("{tolerance:5.0e}: {} of 10 000, off by {:.3} and {:.3}", close.len(), largest.0, largest.1);
    assert!(close.len() > least, "hardly any");
    assert!(largest.0 < 0.5, "places are off by {} of the tolerance", largest.0);
    assert!(largest.1 < 1.0, "directions are off by {} of the tolerance", largest.1);
}
