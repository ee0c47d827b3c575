//! Spacetimes of the table: the suite that every one of them passes, and exact values of those beside Schwarzschild's.

use crate::support::orbits::{fly, swept};
use crate::support::{Row, orbit_steppers, table};
use clap::ValueEnum;
use glam::DVec3;
use warpfront::geodesic::{Dop853, Launch, Lens};
use warpfront::scene::{Precision, StepperKind};
use warpfront::spacetime::{
    Chart, ConformallyFlat, Entry, Metric, ReissnerNordstrom, SPACETIMES, Schwarzschild, SpacetimeKind,
};
use warpfront::study::free::isotropic::{Exit, FreeRay, trace};
use warpfront::study::free::{Accuracy, FreeRayEnd};

/// Every spacetime with its parameters at the ends of their ranges and within.
fn media() -> Vec<(String, Metric)> {
    use warpfront::spacetime::Range;
    let mut media = Vec::new();
    for entry in SPACETIMES {
        let mut values = vec![Vec::new()];
        for parameter in entry.parameters {
            let choices = match parameter.range {
                Range::Length | Range::Extent => vec![1.7],
                Range::Ratio { least, most, .. } => vec![least, 0.3 * least, 0.0, 0.99 * most, most],
            };
            let longer =
                |value: &f64| values.iter().map(|start| [&start[..], &[*value]].concat()).collect::<Vec<_>>();
            values = choices.iter().flat_map(longer).collect();
        }
        for values in values {
            let made = entry.with(DVec3::ZERO, &values).medium();
            media.extend(made.map(|(_, metric)| (format!("{} {values:?}", entry.name), metric)));
        }
    }
    assert!(media.len() >= 6, "{media:?}");
    media
}

/// Inverse radii from far away to just outside the horizon.
fn inverse_radii(metric: &Metric) -> Vec<f64> {
    let nearest = Chart::innermost(metric).max(1e-2 * metric.photon_sphere()) * 1.01;
    (0..60).map(|i| libm::exp(-f64::from(i) * 0.25) / nearest).collect()
}

#[test]
fn the_pull_is_half_the_derivative_of_the_squared_index() {
    for (name, metric) in media() {
        for w in inverse_radii(&metric) {
            let h = 1e-4 * w;
            let n2 = |w: f64| metric.index_squared(w);
            // Richardson: the step is small beside the distance to the horizon, where it matters.
            let slope = |h: f64| (n2(w + h) - n2(w - h)) / (4.0 * h);
            let h = h.min(0.01 * (1.0 / Chart::innermost(&metric) - w).abs());
            let expected = (4.0 * slope(0.5 * h) - slope(h)) / 3.0;
            let scale = n2(w) / h * f64::EPSILON + 1e-7 * expected.abs();
            let pull = metric.pull(w);
            assert!((pull - expected).abs() < 10.0 * scale, "{name}, w = {w}: {pull}, {expected}");
        }
    }
}

#[test]
fn the_projected_pull_is_the_pull_projected() {
    for (name, metric) in media() {
        for (i, w) in inverse_radii(&metric).into_iter().enumerate() {
            let c = 1.0 / (1.0 + 0.1 * (i % 20) as f64);
            let (expected, pull) = (metric.pull(w) * c * c * c, metric.projected_pull(w / c, 1.0 / (c * c)));
            // Near the horizon both magnify the rounding of w.
            let near = 1.0 / (1.0 - w * metric.horizon()).abs();
            let error = (pull / expected - 1.0).abs();
            assert!(
                error < 30.0 * f64::EPSILON * (1.0 + near),
                "{name}, w = {w}, c = {c}: {pull}, {expected}"
            );
        }
    }
}

#[test]
fn the_photon_sphere_is_the_minimum_of_the_index_times_the_radius() {
    for (name, metric) in media() {
        let b = |rho: f64| metric.index(1.0 / rho) * rho;
        let (rho, critical) = (metric.photon_sphere(), metric.critical_impact_parameter());
        assert!((b(rho) / critical - 1.0).abs() < 1e-14, "{name}: {} {critical}", b(rho));
        assert!(b(1.001 * rho) > critical && b(0.999 * rho) > critical, "{name}");
    }
}

#[test]
fn lapse_and_index_make_the_areal_radius() {
    // R = Ψ ρ = n N ρ, and N² = 1 − 2M/R + Q²/R².
    for charge in [0.0, 0.4, -0.9, 1.0] {
        let metric = ReissnerNordstrom::new(2.0, charge);
        for rho in [0.9, 1.0, 3.0, 100.0] {
            let w = 1.0 / rho;
            let (n, lapse) = (metric.index(w), metric.lapse(w));
            let areal = n * lapse * rho;
            let f = 1.0 - 2.0 / areal + charge * charge / (areal * areal);
            assert!((lapse * lapse - f).abs() < 1e-14, "charge {charge}, rho {rho}: {lapse}");
        }
    }
}

#[test]
fn without_charge_reissner_and_nordstrom_have_schwarzschilds_hole() {
    let (charged, plain) = (ReissnerNordstrom::new(1.3, 0.0), Schwarzschild::new(1.3));
    for w in inverse_radii(&plain.into()) {
        let pairs = [
            (charged.index(w), plain.index(w)),
            (charged.pull(w), plain.pull(w)),
            (charged.lapse(w), plain.lapse(w)),
        ];
        assert!(pairs.iter().all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{pairs:?}");
    }
    assert_eq!(charged.horizon(), plain.horizon());
    assert!((charged.photon_sphere() / plain.photon_sphere() - 1.0).abs() < 1e-15);
}

#[test]
fn critical_impact_parameters_of_charged_holes_are_the_known_ones() {
    for (charge, expected) in [(0.5, 4.967914329471), (0.9, 4.319227508396), (1.0, 4.0)] {
        let found = ReissnerNordstrom::new(2.0, charge).critical_impact_parameter();
        assert!((found - expected).abs() < 1e-12, "{charge}: {found}");
    }
}

/// A row of the table of rays, followed.
fn follow(row: &Row, stepper: StepperKind, tolerance: f64) -> Exit {
    let entry = Entry::named("reissner-nordstrom").unwrap();
    let hole = entry.with(DVec3::ZERO, &[2.0, row.number("Q")]);
    let ray = FreeRay {
        start: row.vector(["x0", "y0", "z0"]),
        direction: row.vector(["dx0", "dy0", "dz0"]),
        r_out: row.number("r_out"),
    };
    trace(&hole, &ray, &Accuracy { stepper, tolerance, precision: Precision::F64 }).unwrap()
}

#[test]
fn every_exact_ray_around_a_charged_hole_ends_where_it_should_with_every_stepper() {
    let rows = table("reissner_nordstrom_rays.csv");
    assert_eq!(rows.len(), 60);
    for stepper in orbit_steppers() {
        let stepper = StepperKind::from_str(&stepper, false).unwrap();
        let tolerances: &[f64] = match stepper {
            StepperKind::Quadrature | StepperKind::Rkn6 | StepperKind::Series | StepperKind::Dop853 => {
                &[1e-3, 1e-5, 1e-8, 1e-10]
            }
            _ => &[1e-3, 1e-5],
        };
        for &tolerance in tolerances {
            for row in &rows {
                let name =
                    format!("{stepper:?} {tolerance:e}, row {} ({})", row.text("id"), row.text("kind"));
                let found = follow(row, stepper, tolerance);
                let Some(crossing) = found.crossing else {
                    assert_eq!(
                        (found.status, row.text("status")),
                        (FreeRayEnd::Captured, "captured"),
                        "{name}"
                    );
                    continue;
                };
                assert_eq!(row.text("status"), "escaped", "{name}");
                let away = crossing.position.distance(row.vector(["x1", "y1", "z1"])) / row.number("r_out");
                let turned = crossing.direction.distance(row.vector(["dx1", "dy1", "dz1"]));
                let swept = (crossing.swept - row.number("phi")).abs();
                let share = away.max(turned).max(swept) / ((tolerance + 1e-15) * row.number("sens"));
                assert!(share < 1.0, "{name}: {share} of what is allowed");
            }
        }
    }
}

#[test]
fn every_deflection_by_a_charged_hole_comes_out() {
    let rows = table("reissner_nordstrom_deflection.csv");
    assert!(rows.len() > 70);
    for row in rows {
        let medium = ReissnerNordstrom::new(2.0, row.number("Q"));
        let launch = Launch::new(&medium, DVec3::X * row.number("r0_iso"), DVec3::Y, f64::EPSILON);
        let journey = fly::<_, _, f64>(&medium, &Dop853, 1e-12, &launch, 0.0, |_| ());
        let deflection = 2.0 * swept(&journey).unwrap() - std::f64::consts::PI;
        let exact = row.number("deflection");
        // From the rounded periastron, not from b: what that moves the angle by falls as ε.
        let allowed = 1e-10 * (1.0 + exact) + 1e-14 / row.number("eps");
        assert!(
            (deflection - exact).abs() < allowed,
            "Q {} b {}: {deflection}, {exact}",
            row.text("Q"),
            row.text("b")
        );
    }
}

#[test]
fn every_spacetime_connects_points_both_ways_alike() {
    for (name, metric) in media() {
        let lens = Lens::new(&metric, f64::EPSILON).unwrap_or_else(|| panic!("{name}"));
        let unit = metric.photon_sphere();
        let (x, y) = (unit * DVec3::new(4.0, 1.0, -2.0), unit * DVec3::new(-3.0, 2.0, 5.0));
        let [at_x, at_y] = [x, y].map(|point| lens.site(&metric, point));
        for winding in 0..3 {
            let there = lens.connect(&at_x, &at_y, winding).unwrap_or_else(|| panic!("{name}, {winding}"));
            let back = lens.connect(&at_y, &at_x, winding).unwrap();
            assert!((there.direction + back.arrival).length() < 1e-12, "{name}, {winding}");
            let ray = FreeRay { start: x, direction: there.direction, r_out: y.length() };
            let spacetime = SpacetimeKind::Spherical { center: DVec3::ZERO, metric };
            let accuracy =
                Accuracy { stepper: StepperKind::Dop853, tolerance: 1e-12, precision: Precision::F64 };
            let crossing = trace(&spacetime, &ray, &accuracy).unwrap().crossing.unwrap();
            let off = crossing.position.distance(y) / y.length();
            assert!(
                off < 1e-10 * crossing.sens,
                "{name}, {winding}: {off:e}, sensitivity {:e}",
                crossing.sens
            );
        }
    }
}
