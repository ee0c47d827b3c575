//! Rays that join two places of a field: against one hole's exact ones, reciprocal, and no more than found by chance.

use crate::support::Random;
use warpfront::geodesic::{FieldConnection, FieldControl, FieldTarget, Lens, Site, join_in_field};
use warpfront::light::{FieldAim, FieldWay};
use warpfront::spacetime::{Hole, IndexField, ReissnerNordstrom, SeveralHoles};

/// Control of connections that are off by about `tolerance`.
fn control(field: &impl IndexField, farthest: f64, tolerance: f64) -> FieldControl {
    FieldControl::new(field, farthest, tolerance, f64::INFINITY)
}

#[test]
fn rays_past_one_hole_are_those_of_a_hole_of_extremal_charge() {
    let mut random = Random::new(1);
    let mut worst = [0.0f64; 2];
    for number in 0..300 {
        let (center, mass) = (random.in_cube(), random.log_between(0.1, 2.0));
        let field = SeveralHoles::new(&[Hole { center, mass }]);
        let metric = ReissnerNordstrom::new(2.0 * mass, 1.0);
        let lens = Lens::new(&metric, 1e-11).unwrap();
        let aim = FieldAim::new(field.clone(), 3);
        let place = |random: &mut Random| random.log_between(0.3, 100.0) * mass * random.direction();
        let (x, y) = (place(&mut random), place(&mut random));
        let (target, site) = if number % 3 == 0 {
            (FieldTarget::Infinity(y.normalize()), Site::infinity(y.normalize()))
        } else {
            (FieldTarget::Place(center + y), lens.site(&metric, y))
        };
        let control = control(&field, 100.0 * mass, 1e-10);
        for (way, _) in aim.ways(center + x, target) {
            let winding = match way {
                FieldWay::Near => 0,
                FieldWay::Around(_, winding) => winding,
            };
            let exact = lens.connect(&lens.site(&metric, x), &site, winding).unwrap();
            let enough = if number % 3 == 0 { 1e-9 } else { 1e-9 * x.distance(y) };
            let found = aim.image(&control, (center + x, target), way, enough);
            let Some(found) = found else { panic!("{number}: {x} {y} {way:?}") };
            let off = found.direction.distance(exact.direction).max(found.arrival.distance(exact.arrival));
            let ratio = found.geometry_factor() / exact.geometry_factor - 1.0;
            println!("{number} {way:?} {off:e} {ratio:e}");
            worst = [worst[0].max(off), worst[1].max(ratio.abs())];
        }
    }
    println!("{worst:?}");
}

/// Holes at random places, with random masses.
fn random_holes(random: &mut Random) -> SeveralHoles {
    let count = random.between(2.0, 4.99) as u32;
    let hole = |_| Hole { center: 8.0 * random.in_cube(), mass: random.log_between(0.1, 1.0) };
    SeveralHoles::new(&(0..count).map(hole).collect::<Vec<_>>())
}

#[test]
fn most_light_is_found() {
    let mut random = Random::new(2);
    let (mut all, mut missing, mut by_ways) = (0.0, 0.0, 0);
    let mut worst = Vec::new();
    for number in 0..40 {
        let field = random_holes(&mut random);
        let (x, y) = (20.0 * random.in_cube(), 20.0 * random.in_cube());
        let (aim, control) = (FieldAim::new(field.clone(), 3), control(&field, 40.0, 1e-6));
        let (target, enough) = (FieldTarget::Place(y), 1e-6 * x.distance(y));
        let start = std::time::Instant::now();
        let found: Vec<(FieldWay, FieldConnection)> = aim
            .ways(x, target)
            .filter_map(|(way, _)| Some((way, aim.image(&control, (x, target), way, enough)?)))
            .collect();
        let time = start.elapsed();
        let mut extra: Vec<FieldConnection> = Vec::new();
        for _ in 0..1500 {
            let Some(chance) = join_in_field(&field, &control, (x, random.direction()), target, enough)
            else {
                continue;
            };
            let known = found.iter().map(|(_, found)| found).chain(&extra);
            if !known.into_iter().any(|other| other.direction.distance(chance.direction) < 1e-3) {
                extra.push(chance);
            }
        }
        let sum = |links: &mut dyn Iterator<Item = f64>| links.sum::<f64>();
        let seen = sum(&mut found.iter().map(|(_, link)| link.geometry_factor()));
        let missed = sum(&mut extra.iter().map(FieldConnection::geometry_factor));
        by_ways += found.len();
        println!(
            "{number}: {} holes, {} found {:?}, {} missed {:e} of {:e}, {time:?}",
            field.holes().len(),
            found.len(),
            found.iter().map(|(way, link)| (*way, link.geometry_factor() / seen)).collect::<Vec<_>>(),
            extra.len(),
            missed / (seen + missed),
            seen
        );
        worst.push(missed / (seen + missed));
        (all, missing) = (all + 1.0, missing + missed / (seen + missed));
    }
    println!("missing {} of {all}, {by_ways}; {worst:?}", missing / all);
}
