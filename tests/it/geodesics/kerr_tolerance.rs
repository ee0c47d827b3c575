//! `tolerance` is what it says around spinning holes, too; and fates that constants of motion decide are those that rays
//! find by themselves.
//!
//! Random rays by the series against the Hamiltonian at 1e-13, from anywhere in all directions, or aimed at the hole.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::support::Random;
use glam::DVec3;
use rayon::prelude::*;
use warpfront::geodesic::kerr::{KerrLaunch, KerrPhoton, PhotonEnd, UnitHole, follow_photon};
use warpfront::scene::{Precision, StepperKind};
use warpfront::spacetime::{Entry, Fate};
use warpfront::study::free::{Accuracy, Cells, FreeRayEnd, TableForm};

/// Radius of the spheroid on which rays end.
const R_OUT: f64 = 1200.0;

/// Start and direction of momentum of a random ray: all directions, or towards within 12 M of the hole.
fn random_ray(random: &mut Random, hole: &UnitHole) -> (DVec3, DVec3) {
    let nearest = 1.05 / hole.horizon;
    let n = random.direction();
    let x = hole.position(1.0 / random.log_between(nearest.max(2.0), 1000.0), n);
    let aimed = random.between(0.0, 1.0) < 0.5;
    let direction = if aimed { 12.0 * random.in_cube() - x } else { random.direction() };
    (x, direction.normalize())
}

/// Rays of a spin whose errors exceed what is allowed, the worst of them, and how many were compared.
fn honesty(spin: f64, tolerance: f64, rays: usize) -> (usize, f64, usize) {
    let entry = Entry::named("kerr").unwrap();
    let spacetime = entry.with(DVec3::ZERO, &[2.0, spin]);
    let (form, hole) = (TableForm::of(entry), UnitHole::new(spin, 0.0));
    let accuracy = |stepper, tolerance| Accuracy { stepper, tolerance, precision: Precision::F64 };
    let ratios: Vec<f64> = (0..rays)
        .into_par_iter()
        .filter_map(|seed| {
            let (x, p) = random_ray(&mut Random::new(seed as u64), &hole);
            let cells = Cells { needed: vec![x.x, x.y, x.z, p.x, p.y, p.z, R_OUT], optional: Vec::new() };
            let found = (form.trace)(&spacetime, &cells, &accuracy(StepperKind::Series, tolerance)).unwrap();
            let exact = (form.arrive)(&spacetime, &cells, &accuracy(StepperKind::Dop853, 1e-13)).unwrap();
            assert_eq!(found.status, exact.status, "a = {spin}, tolerance {tolerance:e}: {cells:?}");
            assert!(!found.status.is_lost());
            let (found, (x, d)) = (found.crossing?, exact.crossing?);
            let off = (found.position.distance(x) / R_OUT).max(found.direction.distance(d));
            // The check has an accuracy of its own.
            Some(off / ((tolerance + 1e-12) * found.sens))
        })
        .collect();
    let above = ratios.iter().filter(|ratio| **ratio > 1.0).count();
    (above, ratios.iter().fold(0.0, |worst, &ratio| worst.max(ratio)), ratios.len())
}

#[test]
fn a_photon_that_stops_at_its_turning_point_exactly_goes_on() {
    let entry = Entry::named("kerr").unwrap();
    let spacetime = entry.with(DVec3::ZERO, &[2.0, 0.5]);
    let x = [0.7250011290310521, -0.2626359921228261, -2.34830615182873];
    let p = [0.1983964136860601, -0.5594098276121492, -0.8047978055433895];
    let cells = Cells { needed: [&x[..], &p, &[R_OUT]].concat(), optional: Vec::new() };
    let accuracy = Accuracy { stepper: StepperKind::Dop853, tolerance: 1e-13, precision: Precision::F64 };
    let end = (TableForm::of(entry).arrive)(&spacetime, &cells, &accuracy).unwrap();
    assert_eq!(end.status, FreeRayEnd::Captured);
}

/// Spins and tolerances, each with so many rays: less than 1 % above what is allowed.
fn check_honesty(rays: usize) {
    for spin in [0.5, 0.9, 0.998] {
        for tolerance in [1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10] {
            let (above, worst, compared) = honesty(spin, tolerance, rays);
            println!("a = {spin}, tolerance {tolerance:e}: {above} of {compared} above, worst {worst:.3}");
            assert!(compared > rays / 4 && above * 100 < compared && worst < 10.0);
        }
    }
}

#[test]
fn errors_around_spinning_holes_keep_within_the_tolerance() {
    check_honesty(400);
}

#[test]
#[ignore = "100 000 rays at each of 18 settings take minutes"]
fn errors_of_many_rays_around_spinning_holes_keep_within_the_tolerance() {
    check_honesty(100_000);
}

/// Rays around holes of random spin and charge whose fate the Hamiltonian finds by itself: none is another than the
/// constants of motion say.
fn check_fates(rays: usize) {
    let escaped = AtomicUsize::new(0);
    (0..rays).into_par_iter().for_each(|seed| {
        let mut random = Random::new(seed as u64);
        let spin = (1.0 - random.log_between(1e-4, 1.0)) * if seed % 2 == 0 { 1.0 } else { -1.0 };
        let charge = if seed % 3 == 0 { 0.99 * (1.0 - spin * spin).sqrt() } else { 0.0 };
        let hole = UnitHole::new(spin, charge);
        let (x, p) = random_ray(&mut random, &hole);
        let Some(photon) = KerrPhoton::new(&hole, x, p) else { return };
        let launch = KerrLaunch::with_momentum(&hole, photon.x, photon.p);
        let fate = launch.fate();
        let end = follow_photon(&hole, photon, None, 1e-11, R_OUT).end;
        let same = match end {
            PhotonEnd::Crosses(_) => fate == Fate::Escapes,
            PhotonEnd::Falls => fate == Fate::Falls,
            PhotonEnd::Misses | PhotonEnd::StepLimit | PhotonEnd::NonFinite => false,
        };
        assert!(same, "ray {seed} around {hole:?} {photon:?}: {fate:?}, but {end:?}");
        escaped.fetch_add(usize::from(fate == Fate::Escapes), Ordering::Relaxed);
    });
    let escaped = escaped.into_inner();
    assert!(escaped > rays / 4 && escaped < rays, "{escaped} of {rays}");
}

#[test]
fn fates_are_those_that_rays_find_by_themselves() {
    check_fates(2000);
}

#[test]
#[ignore = "100 000 rays by their Hamiltonian take minutes"]
fn fates_are_those_that_many_rays_find_by_themselves() {
    check_fates(100_000);
}
