//! Rays that join two places of a field: those of one hole, back and forth, in flat space, and how many of all are found.

use crate::support::Random;
use warpfront::geodesic::{FieldConnection, FieldControl, FieldTarget, JoinLimits, Lens, join_in_field};
use warpfront::light::{FieldAim, FieldWay};
use warpfront::spacetime::{Hole, IndexField, ReissnerNordstrom, SeveralHoles};

/// Control of rays whose directions are off by about `tolerance`.
fn control(field: &impl IndexField, farthest: f64, tolerance: f64) -> FieldControl {
    FieldControl::new(field, farthest, tolerance, f64::INFINITY)
}

/// A true connection that misses by `enough` at most.
fn limits(enough: f64) -> JoinLimits {
    JoinLimits { enough, linear: 0.0, corrections: 10 }
}

/// Holes at random places, with random masses.
fn random_holes(random: &mut Random) -> SeveralHoles {
    let count = random.between(2.0, 4.99) as u32;
    let hole = |_| Hole { center: 8.0 * random.in_cube(), mass: random.log_between(0.1, 1.0) };
    SeveralHoles::new(&(0..count).map(hole).collect::<Vec<_>>())
}

#[test]
fn rays_past_one_hole_are_those_of_a_hole_of_extremal_charge() {
    let mut random = Random::new(1);
    let (mut worst, mut lost) = ([0.0f64; 2], 0);
    for number in 0..300 {
        let (center, mass) = (random.in_cube(), random.log_between(0.1, 2.0));
        let field = SeveralHoles::new(&[Hole { center, mass }]);
        let metric = ReissnerNordstrom::new(2.0 * mass, 1.0);
        let lens = Lens::new(&metric, 1e-11).unwrap();
        let aim = FieldAim::new(field.clone(), if number % 3 == 0 { 2 } else { 1 });
        let [x, y] = [(); 2].map(|()| random.log_between(0.3, 100.0) * mass * random.direction());
        let (target, site, enough) = if number % 3 == 0 {
            (FieldTarget::Infinity(y.normalize()), lens.infinity(y.normalize()), 1e-9)
        } else {
            (FieldTarget::Place(center + y), lens.site(&metric, y), 2e-9 * x.distance(y))
        };
        let control = control(&field, 100.0 * mass, 1e-10);
        for (way, _) in aim.ways(center + x, target) {
            let winding = match way {
                FieldWay::Near => 0,
                FieldWay::Around(_, winding) => winding,
                FieldWay::Beside(_) => panic!("there are no others"),
            };
            let exact = lens.connect(&lens.site(&metric, x), &site, winding).unwrap();
            let found = aim.image(&control, (center + x, target), way, enough);
            let Some(found) = found else {
                // Where a ray hardly tells where it started, rounding hides it.
                let straight = if number % 3 == 0 { 1.0 } else { x.distance_squared(y) };
                let is_weak = exact.geometry_factor * straight < 1e-2;
                assert!(is_weak && winding > 0, "{number}: {x} to {y} {way:?}");
                lost += 1;
                continue;
            };
            let off = found.direction.distance(exact.direction).max(found.arrival.distance(exact.arrival));
            let ratio = (found.geometry_factor() / exact.geometry_factor - 1.0).abs();
            assert!(off < 1e-4 && ratio < 1e-4, "{number}: {x} to {y} {way:?}: {off:e} {ratio:e}");
            worst = [worst[0].max(off), worst[1].max(ratio)];
        }
    }
    assert!(lost < 10, "{lost}");
    println!("{lost} lost, directions to {:e}, geometry factors to {:e}", worst[0], worst[1]);
}

#[test]
fn rays_among_several_holes_and_their_geometry_factors_are_the_same_back_and_forth() {
    let mut random = Random::new(3);
    let mut count = 0;
    for _ in 0..100 {
        let field = random_holes(&mut random);
        let [x, y] = [(); 2].map(|()| 15.0 * random.in_cube());
        let (aim, control) = (FieldAim::new(field.clone(), 1), control(&field, 30.0, 1e-10));
        let enough = 1e-9 * x.distance(y);
        for (way, _) in aim.ways(x, FieldTarget::Place(y)) {
            let Some(there) = aim.image(&control, (x, FieldTarget::Place(y)), way, enough) else { continue };
            // Where a ray hardly tells where it started, rounding leads to another one.
            if there.geometry_factor() * x.distance_squared(y) < 1e-2 {
                continue;
            }
            let back = (y, -there.arrival);
            let back = join_in_field(&field, &control, back, FieldTarget::Place(x), limits(enough)).unwrap();
            assert!(back.arrival.distance(-there.direction) < 1e-4, "{x} to {y} {way:?}");
            // Areas of the optical metric, n² times those of the chart.
            let [there, back] = [(there, y), (back, x)]
                .map(|(link, end)| link.geometry_factor() / field.potential(end).powi(4));
            assert!((there / back - 1.0).abs() < 1e-3, "{x} to {y} {way:?}: {there:e} {back:e}");
            count += 1;
        }
    }
    assert!(count > 150, "{count}");
}

#[test]
fn rays_far_from_holes_are_straight() {
    let mut random = Random::new(4);
    for _ in 0..50 {
        let field = random_holes(&mut random);
        let x = 1e4 * random.direction();
        let y = x + random.log_between(1.0, 100.0) * random.direction();
        let (aim, control) = (FieldAim::new(field.clone(), 0), control(&field, 2e4, 1e-8));
        let ends = (x, FieldTarget::Place(y));
        let found = aim.image(&control, ends, FieldWay::Near, 1e-8 * x.distance(y)).unwrap();
        assert!(found.direction.distance((y - x).normalize()) < 1e-5);
        assert!((found.geometry_factor() * x.distance_squared(y) - 1.0).abs() < 1e-4, "{found:?}");
    }
}

#[test]
fn few_of_the_rays_that_join_two_places_among_several_holes_are_missed() {
    let mut random = Random::new(2);
    let (mut missing, count) = (0.0, 60);
    for _ in 0..count {
        let field = random_holes(&mut random);
        let [x, y] = [(); 2].map(|()| 20.0 * random.in_cube());
        let (aim, control) = (FieldAim::new(field.clone(), 2), control(&field, 40.0, 1e-6));
        let (target, enough) = (FieldTarget::Place(y), 1e-6 * x.distance(y));
        let ways = aim.ways(x, target);
        let mut all: Vec<FieldConnection> =
            ways.filter_map(|(way, _)| aim.image(&control, (x, target), way, enough)).collect();
        let light =
            |links: &[FieldConnection]| -> f64 { links.iter().map(FieldConnection::geometry_factor).sum() };
        let found = light(&all);
        for _ in 0..400 {
            let chance = join_in_field(&field, &control, (x, random.direction()), target, limits(enough));
            let is_new = |link: &FieldConnection| {
                all.iter().all(|other| other.direction.distance(link.direction) > 1e-3)
            };
            all.extend(chance.filter(is_new));
        }
        missing += (1.0 - found / light(&all)) / f64::from(count);
    }
    println!("{:.2} % of the light is missed", 100.0 * missing);
    assert!(missing < 0.02, "{missing}");
}
