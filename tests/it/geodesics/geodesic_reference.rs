//! The march alone, without scenes and arcs, against every row of the exact tables.

use crate::support::orbits::{
    aimed, exact_sweep, fly, fly_with_derivative, sensitivity, sensitivity_at_infinity, swept,
    with_every_stepper,
};
use crate::support::table;
use glam::DVec3;
use warpfront::geodesic::{ArealSeries, Dop853, Launch, OrbitEnd, OrbitStepper, Rkn6};
use warpfront::math::dual::Dual;
use warpfront::spacetime::{ConformallyFlat, Fate, Schwarzschild};

/// Rounding of the start and of the steps, relative to the sensitivity: their number is in the hundreds.
const ROUNDING: f64 = 2e-15;

/// What was found, relative to what is allowed.
#[derive(Default)]
struct Worst {
    /// Position on the sphere, direction there, swept angle.
    end: f64,
    /// Inverse radius of the periastron, relative.
    periastron: f64,
    /// Sensitivity, relative.
    sens: f64,
    steps: u32,
    rays: u32,
}

/// Follows every ray of the table around a hole.
fn follow_table<S: OrbitStepper>(stepper: impl Fn(&Schwarzschild) -> S, tolerance: f64) -> Worst {
    let mut worst = Worst::default();
    // Without a hole rays are straight lines, and are not marched.
    for row in table("schwarzschild_rays.csv").iter().filter(|row| row.number("rs") > 0.0) {
        let name = format!("row {} ({})", row.text("id"), row.text("kind"));
        let medium = Schwarzschild::new(row.number("rs"));
        let (x, d) = (row.vector(["x0", "y0", "z0"]), row.vector(["dx0", "dy0", "dz0"]));
        let launch = Launch::new(&medium, x, d, f64::EPSILON);
        let r_out = row.number("r_out");
        let journey = fly_with_derivative(&medium, &stepper(&medium), tolerance, &launch, 1.0 / r_out);
        worst.steps += journey.steps;
        worst.rays += 1;
        let (phase, angle) = match (row.text("status"), journey.end) {
            ("captured", OrbitEnd::Falls) => continue,
            ("escaped", OrbitEnd::Crosses(phase, angle)) => (phase, angle),
            (status, end) => panic!("{name} is {status} in the table and {end:?} here"),
        };
        let sens = row.number("sens");
        let (w, v, phi) = (phase.w.value, phase.v.value, angle.value);
        let away = launch.position(w, phi).distance(row.vector(["x1", "y1", "z1"])) / r_out;
        let turned = launch.direction(w, v, phi).distance(row.vector(["dx1", "dy1", "dz1"]));
        let off = (phi - row.number("phi")).abs();
        let share = away.max(turned).max(off) / ((tolerance + ROUNDING) * sens);
        assert!(share < 1.0, "{name}: {share} of what is allowed, sensitivity {sens:e}");
        worst.end = worst.end.max(share);
        let derived = sensitivity(Dual { value: launch.b, slope: -launch.v / launch.w }, &phase, angle);
        worst.sens = worst.sens.max((derived / sens - 1.0).abs());
        // Rays that start tangentially are at their periastron.
        let nearest = journey.periastron.map_or(launch.w, |w| w.value);
        if let Some(r_min) = row.maybe("r_min") {
            let off = (nearest * r_min - 1.0).abs();
            worst.periastron = worst.periastron.max(off);
        }
    }
    worst
}

fn check_rays<S: OrbitStepper>(
    name: &str,
    stepper: impl Fn(&Schwarzschild) -> S,
    tolerance: f64,
    periastron: f64,
    sens: f64,
) {
    let worst = follow_table(stepper, tolerance);
    println!(
        "{name:9} {tolerance:5.0e}: worst end {:.3} of what is allowed; periastron off by {:.1e}, sensitivity by {:.1e}; \
         {:.1} steps a ray",
        worst.end,
        worst.periastron,
        worst.sens,
        f64::from(worst.steps) / f64::from(worst.rays)
    );
    assert!(worst.periastron < periastron, "{name}: periastron off by {:e}", worst.periastron);
    assert!(worst.sens < sens, "{name}: sensitivity off by {:e}", worst.sens);
}

#[test]
fn every_ray_of_the_table_ends_where_it_should_as_the_reference_preset_follows_it() {
    check_rays("Dop853", |_| Dop853, 1e-10, 1e-10, 1e-5);
}

#[test]
fn every_ray_of_the_table_ends_where_it_should_as_the_standard_preset_follows_it() {
    check_rays("Rkn6", |_| Rkn6, 1e-5, 1e-9, 1e-2);
}

#[test]
fn every_ray_of_the_table_ends_where_it_should_as_the_draft_preset_follows_it() {
    check_rays("Rkn6", |_| Rkn6, 1e-3, 1e-7, 1e-1);
}

#[test]
fn every_ray_of_the_table_ends_where_it_should_by_series() {
    fn series<const P: usize>(tolerance: f64) -> impl Fn(&Schwarzschild) -> ArealSeries<P> {
        move |medium| ArealSeries::new(&medium.as_hole().expect("it is one"), tolerance)
    }
    check_rays("series 8", series::<8>(1e-3), 1e-3, 1e-7, 1e-1);
    check_rays("series 10", series::<10>(1e-5), 1e-5, 1e-9, 1e-2);
    check_rays("series 14", series::<14>(1e-8), 1e-8, 1e-9, 1e-4);
    check_rays("series 14", series::<14>(1e-10), 1e-10, 1e-10, 1e-5);
}

#[test]
fn every_ray_of_the_table_ends_where_it_should_with_every_stepper() {
    with_every_stepper!(|name, stepper| check_rays(name, |_| stepper, 1e-5, 1e-9, 2e-2));
}

#[test]
fn every_ray_of_the_table_ends_where_it_should_with_every_stepper_at_loose_tolerances() {
    with_every_stepper!(|name, stepper| check_rays(name, |_| stepper, 1e-2, 1e-6, 0.5));
}

/// The settings of the presets, and whether they are the reference's.
const PRESETS: [(f64, bool); 3] = [(1e-10, true), (1e-5, false), (1e-3, false)];

/// The angle to infinity, with the stepper of the preset.
fn angle_to_infinity(medium: &Schwarzschild, launch: &Launch, (tolerance, reference): (f64, bool)) -> f64 {
    let journey = if reference {
        fly::<_, _, f64>(medium, &Dop853, tolerance, launch, 0.0, |_| ())
    } else {
        fly::<_, _, f64>(medium, &Rkn6, tolerance, launch, 0.0, |_| ())
    };
    swept(&journey).unwrap_or_else(|| panic!("{launch:?}: {:?}", journey.end))
}

#[test]
fn every_deflection_of_the_table_comes_out_from_far_away() {
    let medium = Schwarzschild::new(1.0);
    for preset in PRESETS {
        let mut worst = 0.0f64;
        for row in table("schwarzschild_deflection.csv") {
            let (b, exact) = (row.number("b"), row.number("deflection"));
            let slope = row.number("d_deflection_d_lnb").abs();
            for distance in [1e8, 1e12] {
                let inwards = aimed(&medium, distance, b, false);
                let launch = Launch::new(&medium, DVec3::X * distance, inwards, f64::EPSILON);
                let angle = angle_to_infinity(&medium, &launch, preset);
                // From the initial direction to the final one, which is radial.
                let got = angle + inwards.y.atan2(-inwards.x) - std::f64::consts::PI;
                // The way from infinity to the start bends by r_s b/2D². The direction holds b to some last digits
                // only, each of which moves the deflection by the slope times as much: by 1e-5 in the nearest row.
                let allowed = (preset.0 + 8.0 * f64::EPSILON) * (1.0 + slope) + b / (distance * distance);
                let share = (got - exact).abs() / allowed;
                worst = worst.max(share);
                assert!(share < 1.0, "b = {b} from {distance:e} at {:e}: {got} for {exact}", preset.0);
            }
        }
        println!("deflection at {:e}: worst {worst:.3} of what is allowed", preset.0);
    }
}

#[test]
fn every_deflection_of_the_table_is_twice_what_is_swept_from_the_periastron() {
    let medium = Schwarzschild::new(1.0);
    for preset in PRESETS {
        let mut worst = 0.0f64;
        for row in table("schwarzschild_deflection.csv") {
            let exact = 0.5 * (row.number("deflection") + std::f64::consts::PI);
            let launch = Launch::new(&medium, DVec3::X * row.number("r0_iso"), DVec3::Y, f64::EPSILON);
            let angle = angle_to_infinity(&medium, &launch, preset);
            let sens = sensitivity_at_infinity(&medium, &Dop853, &launch).expect("it escapes");
            // b, which follows from the start, is rounded.
            let slope = row.number("d_deflection_d_lnb").abs();
            let share = (angle - exact).abs() / (preset.0 * sens + 4.0 * f64::EPSILON * (1.0 + slope));
            worst = worst.max(share);
            assert!(share < 1.0, "b = {} at {:e}: {angle} for {exact}", launch.b, preset.0);
        }
        println!("from the periastron at {:e}: worst {worst:.3} of what is allowed", preset.0);
    }
}

#[test]
fn rays_on_either_side_of_the_edge_of_every_shadow_of_the_table_fall_and_escape() {
    with_every_stepper!(|name, stepper| {
        for row in table("schwarzschild_shadow.csv") {
            let (rho, edge) = (row.number("rho"), row.number("half_angle"));
            let medium = Schwarzschild::new(1.0);
            for (factor, fate) in [(1.0 - 1e-12, Fate::Falls), (1.0 + 1e-12, Fate::Escapes)] {
                let (sin, cos) = (edge * factor).sin_cos();
                let launch = Launch::new(&medium, DVec3::X * rho, DVec3::new(-cos, sin, 0.0), f64::EPSILON);
                assert_eq!(launch.fate, fate, "rho = {rho}");
                for tolerance in [1e-3, 1e-5] {
                    let journey = fly::<_, _, f64>(&medium, &stepper, tolerance, &launch, 0.0, |_| ());
                    let ended = match journey.end {
                        OrbitEnd::Crosses(..) => Fate::Escapes,
                        OrbitEnd::Falls => Fate::Falls,
                        end => panic!("{name} at {tolerance:e}, rho = {rho}: {end:?}"),
                    };
                    assert_eq!(ended, fate, "{name} at {tolerance:e}, rho = {rho}");
                }
            }
        }
    });
}

#[test]
fn the_elliptic_integral_that_other_tests_rely_on_gives_the_table() {
    // From a periastron, where the factors of its cubic vanish, and from the far end of the way.
    let medium = Schwarzschild::new(1.0);
    for row in table("schwarzschild_deflection.csv") {
        let exact = row.number("deflection") + std::f64::consts::PI;
        let slope = row.number("d_deflection_d_lnb").abs();
        let from_nearest = Launch::new(&medium, DVec3::X * row.number("r0_iso"), DVec3::Y, f64::EPSILON);
        let half = exact_sweep(&medium, &from_nearest).expect("it escapes");
        assert!(
            (2.0 * half - exact).abs() < 8.0 * f64::EPSILON * (exact + slope),
            "{half} for half of {exact}"
        );
        let b = row.number("b");
        let far = 1e12;
        let inwards = aimed(&medium, far, b, false);
        let launch = Launch::new(&medium, DVec3::X * far, inwards, f64::EPSILON);
        let whole = exact_sweep(&medium, &launch).expect("it escapes") + (b / far).asin();
        assert!((whole - exact).abs() < 8.0 * f64::EPSILON * (exact + slope), "{whole} for {exact}");
    }
}
