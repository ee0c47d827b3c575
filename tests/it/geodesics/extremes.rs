//! Rays where codes of this kind fail: at the horizon, at the photon sphere, from very far, in very weak fields, along
//! axes, in single precision, and very many of them.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::support::Random;
use crate::support::orbits::{aimed, exact_sweep, fly, sensitivity_at_infinity, swept, with_every_stepper};
use glam::{DVec2, DVec3, Vec3Swizzles};
use rayon::prelude::*;
use warpfront::geodesic::{Dop853, Journey, Launch, OrbitEnd, Rkn6, Stepper};
use warpfront::math::real::Real;
use warpfront::spacetime::{ConformallyFlat, Fate, Schwarzschild};

/// A spacetime without a field.
#[derive(Clone, Copy)]
struct Flat;

impl ConformallyFlat for Flat {
    fn index_squared<R: Real>(&self, _: R) -> R {
        R::of(1.0)
    }

    fn pull<R: Real>(&self, _: R) -> R {
        R::of(0.0)
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

/// The fate that a ray met, if it met one.
fn met<R: Real>(journey: &Journey<R>) -> Option<Fate> {
    match journey.end {
        OrbitEnd::Crosses(..) => Some(Fate::Escapes),
        OrbitEnd::Falls => Some(Fate::Falls),
        _ => None,
    }
}

/// Follows a ray to infinity.
fn to_infinity<R: Real, S: Stepper>(
    medium: &Schwarzschild,
    stepper: &S,
    tolerance: f64,
    launch: &Launch,
) -> Journey<R> {
    fly(medium, stepper, tolerance, launch, 0.0, |_| ())
}

/// A ray that escapes must sweep the exact angle, and any must meet its fate; gives the steps tried.
fn check<R: Real, S: Stepper>(
    medium: &Schwarzschild,
    (name, stepper): (&str, &S),
    tolerance: f64,
    (x, direction): (DVec3, DVec3),
) -> u32 {
    let launch = Launch::new(medium, x, direction, R::EPSILON);
    let journey = to_infinity::<R, _>(medium, stepper, tolerance, &launch);
    assert_eq!(
        met(&journey),
        Some(launch.fate),
        "{name} at {tolerance:e}: {launch:?} ended as {:?}",
        journey.end
    );
    if let Some(angle) = swept(&journey) {
        let launch = Launch::new(medium, x, direction, f64::EPSILON);
        let exact = exact_sweep(medium, &launch).expect("it escapes");
        let sens = sensitivity_at_infinity(medium, &Dop853, &launch).expect("it escapes");
        // Four times, for the few that the tolerance does not bound.
        let allowed = (4.0 * tolerance + 32.0 * R::EPSILON) * sens;
        assert!(
            (angle - exact).abs() < allowed,
            "{name} at {tolerance:e}: {angle} for {exact}, {sens:e}, {launch:?}"
        );
    }
    journey.steps
}

/// A direction at the angle `psi` from the one to the centre, for a start on the x axis.
fn at_angle(psi: f64) -> DVec3 {
    DVec3::new(-psi.cos(), psi.sin(), 0.0)
}

/// Angle between the direction to the centre and the edge of the shadow for an observer at isotropic radius `rho`
/// around a hole of r_s = 1 \[Synge 1966\].
fn half_angle(rho: f64) -> f64 {
    let areal = rho * (1.0 + 0.25 / rho).powi(2);
    // R − 1 = (ρ − ¼)²/ρ.
    let sine = (6.75 * (rho - 0.25).powi(2) / rho / areal.powi(3)).sqrt().min(1.0).asin();
    if areal >= 1.5 { sine } else { PI - sine }
}

#[test]
fn holes_of_a_billionth_to_a_billion_times_the_scene_bend_rays_exactly() {
    with_every_stepper!(|name, stepper| {
        for exponent in -9..=9 {
            let r_s = 10f64.powi(exponent);
            let medium = Schwarzschild::new(r_s);
            for distance in [0.1, 1.0, 10.0] {
                let rho = medium.horizon() + distance;
                let edge = half_angle(rho / r_s);
                for psi in
                    [1e-9, 0.5 * edge, 0.999 * edge, edge + 1e-3 * (PI - edge), 0.5 * (edge + PI), PI - 1e-12]
                {
                    check::<f64, _>(&medium, (name, &stepper), 1e-5, (rho * DVec3::X, at_angle(psi)));
                }
            }
        }
    });
}

#[test]
fn rays_from_just_above_the_horizon_escape_through_a_narrow_cone_only() {
    let medium = Schwarzschild::new(1.0);
    with_every_stepper!(|name, stepper| {
        for above in [1e-4, 1e-8, 1e-12] {
            let rho = medium.horizon() * (1.0 + above);
            let x = rho * DVec3::X;
            assert_eq!(Launch::new(&medium, x, DVec3::Y, f64::EPSILON).fate, Fate::Falls);
            check::<f64, _>(&medium, (name, &stepper), 1e-5, (x, DVec3::Y));
            check::<f64, _>(&medium, (name, &stepper), 1e-5, (x, DVec3::X));
            let cone = PI - half_angle(rho);
            for (part, fate) in
                [(0.1, Fate::Escapes), (0.99, Fate::Escapes), (1.01, Fate::Falls), (10.0, Fate::Falls)]
            {
                let direction = at_angle(PI - part * cone);
                assert_eq!(Launch::new(&medium, x, direction, f64::EPSILON).fate, fate, "{above:e}, {part}");
                check::<f64, _>(&medium, (name, &stepper), 1e-5, (x, direction));
            }
        }
    });
}

#[test]
fn rays_that_start_at_the_photon_sphere_leave_it() {
    let medium = Schwarzschild::new(1.0);
    let mut most = 0;
    with_every_stepper!(|name, stepper| {
        for factor in [1.0 - 1e-9, 1.0 - f64::EPSILON, 1.0, 1.0 + f64::EPSILON, 1.0 + 1e-9] {
            let x = medium.photon_sphere() * factor * DVec3::X;
            for tilt in [0.0, 1e-300, 1e-17, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3] {
                for tolerance in [1e-2, 1e-3, 1e-5] {
                    for direction in [DVec3::new(tilt, 1.0, 0.0), DVec3::new(-tilt, 1.0, 0.0)] {
                        // So close to the circular ray the angle is anything; the fate is not.
                        let launch = Launch::new(&medium, x, direction, f64::EPSILON);
                        let journey = to_infinity::<f64, _>(&medium, &stepper, tolerance, &launch);
                        let fate = met(&journey);
                        assert_eq!(
                            fate,
                            Some(launch.fate),
                            "{name} at {tolerance:e}: {launch:?}, {:?}",
                            journey.end
                        );
                        most = most.max(journey.steps);
                        let launch = Launch::new(&medium, x, direction, f64::from(f32::EPSILON));
                        let journey = to_infinity::<f32, _>(&medium, &stepper, tolerance, &launch);
                        let fate = met(&journey);
                        assert_eq!(
                            fate,
                            Some(launch.fate),
                            "{name} at {tolerance:e}: {launch:?}, {:?}",
                            journey.end
                        );
                    }
                }
            }
        }
    });
    println!("at most {most} steps");
    assert!(most < 3000, "{most} steps");
}

#[test]
fn rays_aimed_beside_the_critical_one_meet_their_fate() {
    let medium = Schwarzschild::new(1.0);
    let critical = medium.critical_impact_parameter();
    let mut most = 0;
    with_every_stepper!(|name, stepper| {
        for power in 1..=15 {
            let off = 10f64.powi(-power);
            for (rho, outwards) in [(20.0, false), (1e3, false), (1.0, false), (0.3, true), (0.9, true)] {
                for b in [critical * (1.0 + off), critical * (1.0 - off)] {
                    let direction = aimed(&medium, rho, b, outwards);
                    for tolerance in [1e-2, 1e-3, 1e-5] {
                        let launch = Launch::new(&medium, rho * DVec3::X, direction, f64::EPSILON);
                        if power <= 12 {
                            assert_eq!(launch.fate == Fate::Escapes, (b > critical) != outwards, "{b}");
                        }
                        let at = (name, &stepper);
                        most = most.max(check::<f64, _>(&medium, at, tolerance, (rho * DVec3::X, direction)));
                    }
                }
            }
        }
    });
    println!("at most {most} steps");
    assert!(most < 3000, "{most} steps");
}

#[test]
fn radial_rays_fall_in_or_leave_without_turning() {
    let medium = Schwarzschild::new(1.0);
    with_every_stepper!(|name, stepper| {
        for rho in [0.2501, 0.3, 0.9, 1.0, 10.0, 1e4, 1e8] {
            for axis in [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::new(1.0, 2.0, -2.0) / 3.0] {
                let inwards = Launch::new(&medium, rho * axis, -axis, f64::EPSILON);
                assert_eq!(met(&to_infinity::<f64, _>(&medium, &stepper, 1e-5, &inwards)), Some(Fate::Falls));
                let outwards = Launch::new(&medium, rho * axis, axis, f64::EPSILON);
                let journey = to_infinity::<f64, _>(&medium, &stepper, 1e-5, &outwards);
                let OrbitEnd::Crosses(phase, swept) = journey.end else {
                    panic!("{name}: {:?}", journey.end)
                };
                assert!(swept.abs() <= f64::EPSILON * (1.0 + outwards.b / rho), "{name}: {swept:e}");
                let direction = outwards.direction(phase.w, phase.v, swept);
                assert!(direction.distance(axis) < 4.0 * f64::EPSILON, "{name}: {direction}");
            }
        }
    });
}

#[test]
fn rays_through_the_centre_of_flat_space_go_straight_on() {
    with_every_stepper!(|name, stepper| {
        for b in [0.0, 1e-300, 1e-30, 1e-16, 1e-8, 1e-3, 0.1, 0.9] {
            for distance in [1e-3, 1.0, 1e8] {
                let (x, direction) = (distance * DVec3::NEG_X, DVec3::new((1.0 - b * b).sqrt(), b, 0.0));
                let launch = Launch::new(&Flat, x, direction, f64::EPSILON);
                let journey = fly::<_, _, f64>(&Flat, &stepper, 1e-5, &launch, 0.5 / distance, |_| ());
                let OrbitEnd::Crosses(phase, swept) = journey.end else {
                    panic!("{name}: {:?}", journey.end)
                };
                let end = launch.direction(phase.w, phase.v, swept);
                let off = end.distance(direction.normalize());
                assert!(off < 1e-13, "{name}: off by {off:e} at b = {b:e}");
                let exact = x + direction
                    * (distance * direction.x
                        + ((distance * direction.x).powi(2) + 3.0 * distance * distance).sqrt());
                let away = launch.position(0.5 / distance, swept).distance(exact) / distance;
                assert!(away < 1e-13, "{name}: {away:e} away at b = {b:e}");
                assert!(journey.steps < 400, "{name}: {} steps at b = {b:e}", journey.steps);
            }
        }
    });
}

#[test]
fn a_ray_from_a_hundred_million_radii_takes_as_many_steps_as_one_from_a_hundred() {
    let medium = Schwarzschild::new(1.0);
    with_every_stepper!(|name, stepper| {
        for b in [0.0, 1.0, 2.59, 2.6, 3.0, 5.0, 50.0] {
            for tolerance in [1e-3, 1e-5] {
                let steps = [1e2, 1e8].map(|rho| {
                    let ray = (rho * DVec3::X, aimed(&medium, rho, b, false));
                    check::<f64, _>(&medium, (name, &stepper), tolerance, ray)
                });
                assert!(steps[1] <= steps[0] + 5, "{name} at {tolerance:e}, b = {b}: {steps:?}");
            }
        }
    });
}

#[test]
fn the_impact_parameter_of_a_ray_aimed_at_the_centre_from_far_is_exact() {
    // Whole numbers, so that the exact cross product is at hand: directions that miss the centre by 10⁻¹⁵ radians.
    let mut random = Random::new(23);
    let medium = Schwarzschild::new(1e-20);
    for _ in 0..1000 {
        let mut whole = |size: f64| [0; 3].map(|_| random.between(-size, size).round() as i128);
        let (x, miss) = (whole(1e6), whole(8.0));
        let d: [i128; 3] = std::array::from_fn(|i| miss[i] - (x[i] << 30));
        let cross = [1, 2, 0].map(|i| (x[i] * d[(i + 1) % 3] - x[(i + 1) % 3] * d[i]) as f64);
        let [x, d] = [x, d].map(|v| DVec3::from(v.map(|i| i as f64)));
        let exact = DVec3::from(cross).length() / d.length();
        let b = Launch::new(&medium, x, d, f64::EPSILON).b;
        assert!((b - exact).abs() <= 8.0 * f64::EPSILON * exact, "{b:e} for {exact:e}");
    }
}

#[test]
fn rays_in_a_vanishing_field_are_straight_to_the_last_digits() {
    with_every_stepper!(|name, stepper| {
        for r_s in [1e-30, 1e-100, 1e-300] {
            let medium = Schwarzschild::new(r_s);
            let mut random = Random::new(3);
            for _ in 0..100 {
                let (x, direction) = (random.log_between(1e-3, 1e6) * random.direction(), random.direction());
                let launch = Launch::new(&medium, x, direction, f64::EPSILON);
                for tolerance in [1e-2, 1e-5, 1e-10] {
                    let journey = to_infinity::<f64, _>(&medium, &stepper, tolerance, &launch);
                    let OrbitEnd::Crosses(phase, swept) = journey.end else {
                        panic!("{name}: {:?}", journey.end)
                    };
                    let off = launch.direction(phase.w, phase.v, swept).distance(direction);
                    assert!(off < 4e-15, "{name} at {tolerance:e}, r_s = {r_s:e}: off by {off:e}");
                }
            }
        }
    });
}

/// Where a ray ends, as bits.
fn bits(
    medium: &Schwarzschild,
    x: DVec3,
    direction: DVec3,
    turn_back: impl Fn(DVec3) -> DVec3,
) -> Option<[u64; 3]> {
    let launch = Launch::new(medium, x, direction, f64::EPSILON);
    let journey = to_infinity::<f64, _>(medium, &Rkn6, 1e-5, &launch);
    let OrbitEnd::Crosses(phase, swept) = journey.end else {
        assert_eq!(met(&journey), Some(Fate::Falls), "{launch:?}");
        return None;
    };
    let end = turn_back(launch.direction(phase.w, phase.v, swept));
    assert!(end.is_finite(), "{launch:?} leads to {end}");
    // −0 is 0.
    Some((end + DVec3::ZERO).to_array().map(f64::to_bits))
}

#[test]
fn mirrored_and_exchanged_axes_give_the_same_bits() {
    let medium = Schwarzschild::new(1.0);
    let mut random = Random::new(17);
    for _ in 0..2000 {
        let (x, direction) = (random.log_between(0.3, 1e3) * random.direction(), random.direction());
        let plain = bits(&medium, x, direction, |v| v);
        for signs in [DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, -1.0), DVec3::NEG_ONE] {
            assert_eq!(
                bits(&medium, x * signs, direction * signs, |v| v * signs),
                plain,
                "{x} {direction} {signs}"
            );
        }
        // In a coordinate plane, with which two axes does not matter.
        let (x, direction) =
            (x.length() * DVec3::new(x.x, x.y, 0.0).normalize(), DVec3::new(direction.x, direction.y, 0.0));
        let plain = bits(&medium, x, direction, |v| v);
        assert_eq!(bits(&medium, x.yzx(), direction.yzx(), |v| v.zxy()), plain, "{x} {direction}");
        assert_eq!(bits(&medium, x.zxy(), direction.zxy(), |v| v.yzx()), plain, "{x} {direction}");
    }
}

#[test]
fn rays_along_axes_and_signed_zeros_are_as_good_as_any() {
    let medium = Schwarzschild::new(1.0);
    let zeros = [0.0, -0.0];
    for rho in [0.5, 1.0, 3.0, 1e6] {
        for (zero0, zero1) in zeros.into_iter().flat_map(|a| zeros.map(|b| (a, b))) {
            let x = DVec3::new(rho, zero0, zero1);
            for direction in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
                for signs in [DVec3::ONE, DVec3::new(1.0, -1.0, -1.0), DVec3::NEG_ONE] {
                    // Turns 0 into −0.
                    let direction = direction * signs;
                    let plain = bits(&medium, DVec3::new(rho, 0.0, 0.0), direction + DVec3::ZERO, |v| v);
                    assert_eq!(bits(&medium, x, direction, |v| v), plain, "{x:?} {direction:?}");
                }
            }
        }
    }
}

#[test]
fn single_precision_keeps_the_shadow_of_a_hole_that_is_very_far() {
    // Areal radii in units of M = r_s/2, and the half-angle that is known at 10⁶ M, in degrees.
    let known = 2.97717305811e-4_f64.to_radians();
    for areal in [1e3, 1e6, 2e8] {
        let rho = 0.5 * (0.5 * areal - 0.5 + (0.25 * areal * areal - 0.5 * areal).sqrt());
        let edge = half_angle(rho);
        if areal == 1e6 {
            assert!((edge / known - 1.0).abs() < 1e-11, "{edge} for {known}");
        }
        let medium = Schwarzschild::new(1.0);
        with_every_stepper!(|name, stepper| {
            for (factor, fate) in [(1.0 - 1e-9, Fate::Falls), (1.0 + 1e-9, Fate::Escapes)] {
                let x = rho * DVec3::X;
                let launch = Launch::new(&medium, x, at_angle(factor * edge), f64::from(f32::EPSILON));
                let journey = to_infinity::<f32, _>(&medium, &stepper, 1e-3, &launch);
                assert_eq!(met(&journey), Some(fate), "{name} at {areal:e} M: {factor}");
            }
            // And what is seen beside it.
            for factor in [0.5, 0.99, 1.01, 1.5, 3.0, 100.0] {
                let ray = (rho * DVec3::X, at_angle(factor * edge));
                for tolerance in [1e-2, 1e-3, 1e-4] {
                    check::<f32, _>(&medium, (name, &stepper), tolerance, ray);
                }
            }
        });
    }
}

/// A random ray of a random kind around a hole of r_s = 1.
fn random_ray(random: &mut Random) -> (DVec3, DVec3) {
    let medium = Schwarzschild::new(1.0);
    let kind = random.between(0.0, 6.0) as u32;
    let rho = match kind {
        0 => 0.25 * (1.0 + random.log_between(1e-10, 1.0)),
        1 => medium.photon_sphere() * (1.0 + random.between(-1e-3, 1e-3)),
        2 => random.log_between(1e3, 1e12),
        _ => random.log_between(0.26, 1e3),
    };
    let radial = random.direction();
    let across = radial.any_orthonormal_vector();
    let local = |d: DVec3| d.x * radial + d.y * across;
    let side = if random.between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
    let direction = match kind {
        0..3 => random.direction(),
        3 => {
            let edge = half_angle(rho);
            local(at_angle(edge * (1.0 + side * random.log_between(1e-13, 0.1))))
        }
        4 => local(at_angle(random.log_between(1e-20, 1.0))),
        _ => local(at_angle(FRAC_PI_2 + side * random.log_between(1e-20, 1.0))),
    };
    (rho * radial, direction)
}

#[test]
fn no_ray_of_any_kind_is_lost_with_any_stepper() {
    const RAYS: usize = 100_000;
    let medium = Schwarzschild::new(1.0);
    let mut random = Random::new(99);
    let rays: Vec<(DVec3, DVec3)> = (0..RAYS).map(|_| random_ray(&mut random)).collect();
    with_every_stepper!(|name, stepper| {
        let most = rays.par_iter().map(|&(x, direction)| {
            let launch = Launch::new(&medium, x, direction, f64::EPSILON);
            let journey = to_infinity::<f64, _>(&medium, &stepper, 1e-3, &launch);
            assert_eq!(met(&journey), Some(launch.fate), "{name}: {launch:?} {:?}", journey.end);
            // Radii just above the horizon differ from it in double precision only.
            if x.length() < 1.0001 * medium.horizon() {
                return (journey.steps, 0);
            }
            let launch = Launch::new(&medium, x, direction, f64::from(f32::EPSILON));
            let single = to_infinity::<f32, _>(&medium, &stepper, 1e-3, &launch);
            assert_eq!(met(&single), Some(launch.fate), "{name} in f32: {launch:?} {:?}", single.end);
            (journey.steps, single.steps)
        });
        let (most, most_single) = most.reduce(|| (0, 0), |a, b| (a.0.max(b.0), a.1.max(b.1)));
        println!("{name:9}: at most {most} steps, {most_single} in single precision");
        assert!(most.max(most_single) < 3000, "{name}");
    });
}

/// Whether a ray falls, by the areal formula of the shadow's edge; nothing within rounding of the edge.
fn falls(x: DVec3, direction: DVec3) -> Option<bool> {
    let rho = x.length();
    let off = DVec2::new(-x.dot(direction), x.cross(direction).length()).to_angle();
    let edge = half_angle(rho);
    // The edge is as sure as ρ − ¼ is, as the arc of a sine near 1 can be, and as the angle from straight outwards is.
    let known = 1e-14
        + 1e-15 * PI / (PI - edge)
        + 1e-15 / (rho - 0.25) * (PI - edge) / edge
        + 2e-15 / edge.cos().abs().max(2e-8);
    ((off / edge - 1.0).abs() > known).then_some(off < edge)
}

#[test]
#[ignore = "a hundred million rays take minutes; WARPFRONT_RAYS sets another number"]
fn a_hundred_million_rays_end_as_the_shadow_says() {
    let count: u64 =
        std::env::var("WARPFRONT_RAYS").map_or(100_000_000, |text| text.parse().expect("a number"));
    const BLOCK: u64 = 10_000;
    let medium = Schwarzschild::new(1.0);
    let tally: [AtomicU64; 4] = Default::default();
    (0..count.div_ceil(BLOCK)).into_par_iter().for_each(|block| {
        let mut random = Random::new(1_000_000 + block);
        let mut local = [0u64; 4];
        for _ in 0..BLOCK.min(count - block * BLOCK) {
            let (x, direction) = random_ray(&mut random);
            let launch = Launch::new(&medium, x, direction, f64::EPSILON);
            let journey = to_infinity::<f64, _>(&medium, &Rkn6, 1e-5, &launch);
            let fate = met(&journey).unwrap_or_else(|| panic!("{launch:?}: {:?}", journey.end));
            local[usize::from(fate == Fate::Falls)] += 1;
            match falls(x, direction) {
                Some(falls) => {
                    assert_eq!(falls, fate == Fate::Falls, "{x:?} {direction:?}: {:?}", journey.end)
                }
                None => local[2] += 1,
            }
            if let OrbitEnd::Crosses(phase, swept) = journey.end {
                let end = launch.direction(phase.w, phase.v, swept);
                assert!((end.length() - 1.0).abs() < 1e-14, "{x:?} {direction:?} leads to {end}");
            }
            local[3] += u64::from(journey.steps);
        }
        for (total, count) in tally.iter().zip(local) {
            total.fetch_add(count, Ordering::Relaxed);
        }
    });
    let [escaped, fallen, undecided, steps] = tally.map(AtomicU64::into_inner);
    println!("{escaped} escaped, {fallen} fell; {undecided} within rounding of the edge; {steps} steps");
    assert_eq!(escaped + fallen, count);
}
