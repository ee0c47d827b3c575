//! Rays between points around spinning holes, at random: they join the points by another method, and are the same
//! followed back.

use glam::DVec3;
use warpfront::geodesic::kerr::{
    KerrConnection, KerrConnector, KerrPhoton, KerrPlace, PhotonEnd, UnitHole, follow_photon,
};

use crate::support::Random;

/// Spin and charge.
const HOLES: [[f64; 2]; 5] = [[0.5, 0.0], [-0.9, 0.0], [0.998, 0.0], [0.6, 0.7], [0.0, 0.0]];

fn place(hole: &UnitHole, random: &mut Random) -> KerrPlace {
    KerrPlace::new(hole, random.log_between(3.0, 30.0) * random.direction())
}

/// The ray of a winding number, if it is found.
fn found(hole: &UnitHole, from: &KerrPlace, to: &KerrPlace, winding: u32) -> Option<KerrConnection> {
    KerrConnector { hole, from, to, tolerance: 1e-13 }.by_aim(&from.aim(hole, to, winding)?)
}

/// Asks `check` of the random connections of all holes; complains if too few are found.
fn of_all(mut check: impl FnMut(&UnitHole, [&KerrPlace; 2], &KerrConnection, &str)) {
    let mut random = Random::new(7);
    for [a, e] in HOLES {
        let hole = UnitHole::new(a, e);
        let mut count = [0; 2];
        for number in 0..100 {
            let (from, to) = (place(&hole, &mut random), place(&hole, &mut random));
            for winding in 0..2 {
                if let Some(ray) = found(&hole, &from, &to, winding) {
                    count[winding as usize] += 1;
                    check(&hole, [&from, &to], &ray, &format!("a = {a}, e = {e}, {number}, {winding}"));
                }
            }
        }
        assert!(count[0] == 100 && count[1] >= 90, "a = {a}, e = {e}: {count:?} of 100 are found");
    }
}

#[test]
fn the_hamiltonian_leads_from_one_point_to_the_other() {
    let (mut worst, mut followed) = (0.0_f64, 0);
    of_all(|hole, [from, to], ray, name| {
        let [x, y] = [from, to].map(|place| hole.position(1.0 / place.r, place.n));
        // The spheroid is crossed outwards once at most.
        let (p, drag) = (ray.momenta[1], hole.potential(to.r, to.n.z) * (1.0 + to.n.dot(ray.momenta[1])));
        let outwards = DVec3::new(to.r * y.x, to.r * y.y, (to.r * to.r + hole.a * hole.a) * to.n.z);
        if (p - drag * to.n).dot(outwards) < 0.1 * outwards.length() {
            return;
        }
        let photon = KerrPhoton { x, p: ray.momenta[0], t: 0.0 };
        let journey = follow_photon(hole, photon, None, 1e-12, to.r);
        let PhotonEnd::Crosses(end) = journey.end else { panic!("{name}: {journey:?}") };
        let off = end.x.distance(y) / y.length() / ray.swing.max(1.0);
        let (time, _) = ray.time_and_swept(hole, from);
        assert!(off < 1e-9, "{name}: off by {off:e} of what is sensitive");
        assert!((end.t - time).abs() < 1e-8 * ray.swing.max(1.0) * time, "{name}: {} for {time}", end.t);
        (worst, followed) = (worst.max(off), followed + 1);
    });
    println!("{followed} followed, worst {worst:.1e} of the sensitivity");
    assert!(followed > 300, "{followed}");
}

#[test]
fn a_ray_followed_back_is_as_long_and_has_etheringtons_factor() {
    let (mut worst, mut lost) = ([0.0_f64; 2], 0);
    of_all(|hole, places, ray, name| {
        // With time reversed, the outgoing chart is the ingoing one of a hole that spins the other way; between both
        // charts the azimuth differs by 2 a ∫ dr/Δ.
        let back = UnitHole::new(-hole.a, hole.e2.sqrt());
        let root = (1.0 - hole.a * hole.a - hole.e2).sqrt();
        let [from, to] = places.map(|&KerrPlace { r, n }| {
            let integral = ((r - 1.0 - root) / (r - 1.0 + root)).ln() / (2.0 * root);
            let (sin, cos) = (-2.0 * hole.a * integral).sin_cos();
            KerrPlace { r, n: DVec3::new(cos * n.x - sin * n.y, sin * n.x + cos * n.y, n.z) }
        });
        // Mino time does not depend on the chart.
        let longer = |back: &KerrConnection| (back.lambda / ray.lambda - 1.0).abs();
        let mut reversed = (0..2).filter_map(|winding| found(&back, &to, &from, winding));
        let Some(reversed) = reversed.find(|back| longer(back) < 1e-6) else {
            // Of those that go around.
            assert!(name.ends_with('1'), "{name} is not found back");
            lost += 1;
            return;
        };
        let lapse = |place: &KerrPlace| (1.0 - hole.potential(place.r, place.n.z)).sqrt();
        let ratio = (lapse(places[1]) / lapse(places[0])).powi(2);
        let factor = (reversed.geometry_factor / (ray.geometry_factor * ratio) - 1.0).abs();
        let sensitivity = ray.swing.max(1.0) * reversed.swing.max(1.0);
        let errors = [longer(&reversed) / sensitivity, factor / sensitivity];
        assert!(errors[0] < 1e-11 && errors[1] < 1e-9, "{name}: {errors:?}");
        worst = [worst[0].max(errors[0]), worst[1].max(errors[1])];
    });
    println!("worst length in λ and factor, over the sensitivity: {worst:?}; {lost} are not found back");
    assert!(lost < 20, "{lost}");
}

#[test]
fn a_light_at_infinity_is_one_very_far_away() {
    let mut random = Random::new(3);
    for [a, e] in HOLES {
        let hole = UnitHole::new(a, e);
        for number in 0..40 {
            let from = place(&hole, &mut random);
            let sky = KerrPlace { r: f64::INFINITY, n: random.direction() };
            let far = KerrPlace { r: 1e7, ..sky };
            let [at_infinity, near] = [sky, far].map(|to| found(&hole, &from, &to, 0).expect("a ray"));
            let name = format!("a = {a}, e = {e}, {number}");
            assert!(at_infinity.direction.distance(near.direction) < 1e-5, "{name}");
            let ratio = near.geometry_factor * far.r * far.r / at_infinity.geometry_factor;
            assert!((ratio - 1.0).abs() < 1e-4, "{name}: {ratio}");
            // The direction at infinity, and far away the frame at rest of flat space.
            let start = KerrPlace { r: 1e9, n: -from.n };
            let Some(straight) = found(&hole, &start, &sky, 0) else { continue };
            if sky.n.dot(start.n) > -0.9 {
                assert!(straight.direction.distance(sky.n) < 1e-7, "{name}");
                assert!((straight.geometry_factor - 1.0).abs() < 1e-6, "{name}");
            }
        }
    }
}
