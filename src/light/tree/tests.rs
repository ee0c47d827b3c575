use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

use super::*;
use crate::math::columns::Columns;

fn build(emissions: &[Emission], floor: f64) -> Tree {
    Tree::build(emissions.len() as u32, |emitter| emissions[emitter as usize], floor)
}

struct Random(Xoshiro256PlusPlus);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    fn unit(&mut self) -> f64 {
        self.0.random()
    }

    /// In the cube [−1, 1]³.
    fn point(&mut self) -> DVec3 {
        2.0 * DVec3::new(self.unit(), self.unit(), self.unit()) - 1.0
    }

    fn direction(&mut self) -> DVec3 {
        std::iter::repeat_with(|| self.point())
            .find(|v| (0.01..1.0).contains(&v.length_squared()))
            .map_or(DVec3::X, DVec3::normalize)
    }

    /// No surface, or one of any normal.
    fn normal(&mut self) -> Option<DVec3> {
        (self.unit() < 0.5).then(|| self.direction())
    }
}

struct TriangleLight {
    corners: [DVec3; 3],
    both_sides: bool,
    radiance: f64,
}

impl TriangleLight {
    /// Corners within `size` of `middle`.
    fn random(random: &mut Random, middle: DVec3, size: f64) -> Self {
        let corners = std::array::from_fn(|_| middle + size * random.point());
        Self { corners, both_sides: random.unit() < 0.3, radiance: random.unit() }
    }

    fn doubled_area(&self) -> DVec3 {
        (self.corners[1] - self.corners[0]).cross(self.corners[2] - self.corners[0])
    }

    fn emission(&self) -> Emission {
        let [a, b, c] = self.corners;
        Emission {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
            power: self.radiance * self.doubled_area().length(),
            axis: self.doubled_area().normalize(),
            cos_normals: 1.0,
            cos_emission: 0.0,
            both_sides: self.both_sides,
        }
    }

    /// Light at `x` per area of the triangle from the point (u, v) of it.
    fn light(&self, x: DVec3, normal: Option<DVec3>, (u, v): (f64, f64)) -> f64 {
        let [a, b, c] = self.corners;
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let to = a + u * (b - a) + v * (c - a) - x;
        let direction = to.normalize();
        let origin_prim = -direction.dot(self.doubled_area().normalize());
        let origin_prim = if self.both_sides { origin_prim.abs() } else { origin_prim.max(0.0) };
        self.radiance * origin_prim * normal.map_or(1.0, |n| n.dot(direction).max(0.0)) / to.length_squared()
    }
}

fn emissions(triangles: &[TriangleLight]) -> Vec<Emission> {
    triangles.iter().map(TriangleLight::emission).collect()
}

/// Triangles in a cube of half-width 1.
fn cloud(random: &mut Random, count: usize, size: f64) -> Vec<TriangleLight> {
    std::iter::repeat_with(|| {
        let middle = random.point();
        TriangleLight::random(random, middle, size)
    })
    .take(count)
    .collect()
}

/// An emitter in one point that shines everywhere.
fn spark(at: DVec3, power: f64) -> Emission {
    Emission {
        min: at,
        max: at,
        power,
        axis: DVec3::Z,
        cos_normals: -1.0,
        cos_emission: 0.0,
        both_sides: false,
    }
}

fn probabilities(tree: &Tree, x: DVec3, normal: Option<DVec3>) -> Vec<f64> {
    (0..tree.polylines.len() as u32)
        .map(|emitter| tree.probability(emitter, x, normal.map(LitSide::flat)))
        .collect()
}

/// The probability that the choice ends without an emitter.
fn loss(tree: &Tree, x: DVec3, normal: Option<DVec3>) -> f64 {
    let receiver = tree.receiver(x, normal.map(LitSide::flat));
    let mut lost = 0.0;
    let mut pending: Vec<(Subtree, f64)> = tree.root.map(|root| (root, 1.0)).into_iter().collect();
    while let Some((subtree, probability)) = pending.pop() {
        let Subtree::Pair(first) = subtree else { continue };
        let Chances { left, right } = tree.chances(first, &receiver);
        if left.is_nan() {
            lost += probability;
            continue;
        }
        let below = (0..).zip([left, right]);
        pending
            .extend(below.map(|(i, chance)| (tree.nodes[first as usize + i].subtree, probability * chance)));
    }
    lost
}

#[test]
fn probabilities_and_what_ends_without_an_emitter_sum_to_1() {
    let mut random = Random::new(1);
    for count in [1, 2, 3, 10, 300] {
        let flat = build(&emissions(&cloud(&mut random, count, 0.2)), 0.0);
        for _ in 0..200 {
            let (x, normal) = (1.5 * random.point(), random.normal());
            let sum: f64 = probabilities(&flat, x, normal).iter().sum();
            assert!((sum + loss(&flat, x, normal) - 1.0).abs() < 1e-12, "{count}: {sum}");
        }
    }
}

#[test]
fn with_a_floor_or_emitters_that_shine_everywhere_probabilities_sum_to_1() {
    let mut random = Random::new(2);
    let triangles = emissions(&cloud(&mut random, 500, 0.2));
    let sparks: Vec<Emission> = (0..500).map(|i| spark(random.point(), f64::from(i))).collect();
    for tree in [build(&triangles, 0.1), build(&sparks, 0.0)] {
        for _ in 0..200 {
            // Emitters behind a surface light it only where there is a floor.
            let (x, any) = (1.5 * random.point(), random.normal());
            let normal = any.filter(|_| tree.floor > 0.0);
            let sum: f64 = probabilities(&tree, x, normal).iter().sum();
            assert!((sum - 1.0).abs() < 1e-12, "{sum}");
            assert!(tree.sample(x, normal.map(LitSide::flat), random.unit()).is_some());
        }
    }
}

#[test]
fn where_nothing_shines_nothing_is_chosen() {
    let down = |i: i32| Emission {
        axis: DVec3::NEG_Z,
        cos_normals: 1.0,
        ..spark(DVec3::new(f64::from(i % 10), f64::from(i / 10), 0.0), 1.0)
    };
    let tree = build(&(0..100).map(down).collect::<Vec<_>>(), 0.0);
    let above = DVec3::new(4.0, 5.0, 8.0);
    assert_eq!(tree.sample(above, None, 0.3), None);
    assert!(probabilities(&tree, above, None).iter().all(|&p| p == 0.0));
    assert!(tree.sample(-above, None, 0.3).is_some());
}

#[test]
fn emitters_are_chosen_as_often_as_their_probabilities_say_and_the_rest_of_u_is_uniform() {
    const DRAWS: u32 = 400_000;
    let mut random = Random::new(3);
    for (count, floor) in [(2, 0.0), (7, 0.0), (60, 0.2)] {
        let tree = build(&emissions(&cloud(&mut random, count, 0.3)), floor);
        for _ in 0..5 {
            let (x, normal) = (random.point(), random.normal());
            let expected = probabilities(&tree, x, normal);
            let mut moments = vec![[0.0; 3]; count];
            for i in 0..DRAWS {
                let u = (f64::from(i) + 0.5) / f64::from(DRAWS);
                let Some((emitter, probability, rest)) = tree.sample(x, normal.map(LitSide::flat), u) else {
                    continue;
                };
                assert_eq!(probability.to_bits(), expected[emitter as usize].to_bits());
                assert!((0.0..1.0).contains(&rest), "{rest}");
                let at = &mut moments[emitter as usize];
                *at = [at[0] + 1.0, at[1] + rest, at[2] + rest * rest];
            }
            for (probability, [number, sum, squares]) in expected.into_iter().zip(moments) {
                // Each emitter's share of [0, 1) is one interval, so that strata miss it by less than one at each end.
                assert!(
                    (number - probability * f64::from(DRAWS)).abs() < 1.0 + 1e-6,
                    "{number} {probability}"
                );
                if number > 0.0 {
                    assert!((sum / number - 0.5).abs() <= 0.5 / number + 1e-6, "{sum} {number}");
                    assert!(
                        (squares / number - 1.0 / 3.0).abs() <= 1.0 / number + 1e-6,
                        "{squares} {number}"
                    );
                }
            }
        }
    }
}

#[test]
fn many_receivers_choose_together_what_each_chooses_alone() {
    let mut random = Random::new(23);
    let (mut descents, mut found) = (Descents::default(), Vec::new());
    for count in [0, 1, 2, 3, 5, 6, 40, 500] {
        let tree = build(&emissions(&cloud(&mut random, count, 0.3)), 0.0);
        for asked in [1, 5, 8, 30] {
            let places: Vec<_> =
                (0..asked).map(|_| (2.0 * random.point(), random.normal().map(LitSide::flat))).collect();
            let numbers: Vec<_> = (0..asked).map(|_| (random.unit() < 0.8).then(|| random.unit())).collect();
            let mut receivers = Columns::default();
            receivers.gather(asked, |lane| tree.receiver(places[lane].0, places[lane].1));
            tree.sample_all(&receivers, &numbers, &mut descents, &mut found);
            let alone = |(u, (x, side)): (&Option<f64>, &_)| tree.sample(*x, *side, (*u)?);
            let alone: Vec<_> = numbers.iter().zip(&places).map(alone).collect();
            assert_eq!(found, alone, "{count} emitters");
        }
    }
}

#[test]
fn what_can_contribute_along_a_straight_line_is_never_left_out() {
    let mut random = Random::new(4);
    let mut shining = 0;
    for (count, size, offset) in
        [(2, 0.5, 0.0), (40, 0.3, 0.0), (40, 0.01, 0.0), (300, 0.1, 0.0), (40, 0.3, 1e9)]
    {
        let offset = DVec3::splat(offset);
        let mut triangles = cloud(&mut random, count, size);
        triangles.iter_mut().for_each(|t| t.corners = t.corners.map(|corner| corner + offset));
        let tree = build(&emissions(&triangles), 0.0);
        for i in 0..400 {
            // Every other point close to an emitter's plane, where light barely leaves it.
            let plane = &triangles[i % count];
            let beside = 0.5 * (plane.corners[0] + plane.corners[1])
                + (plane.corners[2] - plane.corners[0]) * 3.0 * random.unit()
                + plane.doubled_area().normalize() * 1e-6 * random.unit();
            let x = if i % 2 == 0 { offset + 1.2 * random.point() } else { beside };
            let normal = random.normal();
            for (triangle, probability) in triangles.iter().zip(probabilities(&tree, x, normal)) {
                let light = triangle.light(x, normal, (random.unit(), random.unit()));
                shining += u32::from(light > 0.0);
                assert!(light <= 0.0 || probability > 0.0, "{count} {size}: {light} at {x}");
            }
        }
    }
    assert!(shining > 10_000);
}

#[test]
fn emitters_of_a_narrow_beam_and_bent_ones_are_never_left_out() {
    let mut random = Random::new(5);
    let (cos_normals, cos_emission) = (0.3f64.cos(), 0.2f64.cos());
    let lamps: Vec<Emission> = (0..200)
        .map(|_| Emission {
            axis: random.direction(),
            cos_normals,
            cos_emission,
            ..spark(random.point(), 1.0)
        })
        .collect();
    let tree = build(&lamps, 0.0);
    let mut lost = 0;
    for _ in 0..1000 {
        let x = 1.5 * random.point();
        for (lamp, probability) in lamps.iter().zip(probabilities(&tree, x, None)) {
            let angle = (x - lamp.min).angle_between(lamp.axis);
            assert!(probability > 0.0 || angle > 0.5 - 1e-9, "{angle}");
            assert!(probability == 0.0 || angle < 0.5 + 1e-4, "{angle}");
            lost += u32::from(probability == 0.0);
        }
    }
    assert!(lost > 100_000, "{lost}");
}

#[test]
fn with_a_floor_all_that_have_power_can_be_chosen() {
    let mut random = Random::new(6);
    let mut all = emissions(&cloud(&mut random, 300, 0.1));
    all.iter_mut().step_by(3).for_each(|emission| emission.power = 0.0);
    all[1].power = 1e-60;
    let tree = build(&all, 0.05);
    for _ in 0..300 {
        let (x, normal) = (2.0 * random.point(), random.normal());
        for (emission, probability) in all.iter().zip(probabilities(&tree, x, normal)) {
            assert_eq!(emission.power > 0.0, probability > 0.0);
        }
    }
}

#[test]
fn an_emitter_close_by_is_far_likelier_than_by_its_power() {
    let mut random = Random::new(7);
    let triangles = cloud(&mut random, 10_000, 0.005);
    let all = emissions(&triangles);
    let tree = build(&all, 0.0);
    let total: f64 = all.iter().map(|emission| emission.power).sum();
    for i in (0..10_000).step_by(100) {
        let [a, b, c] = triangles[i].corners;
        let x = (a + b + c) / 3.0 + 0.01 * all[i].axis;
        let likelier =
            tree.probability(i as u32, x, Some(LitSide::flat(-all[i].axis))) / (all[i].power / total);
        assert!(likelier > 30.0, "{likelier}");
    }
}

/// Relative variance of light at `x` by one emitter of a cloud that is chosen with the given probabilities.
fn variance(lights: &[f64], probabilities: impl Iterator<Item = f64>) -> f64 {
    let total: f64 = lights.iter().sum();
    let chosen = lights.iter().zip(probabilities).filter(|(light, _)| **light > 0.0);
    let squares: f64 = chosen.map(|(light, probability)| light * light / probability).sum();
    squares / (total * total) - 1.0
}

#[test]
fn below_a_ceiling_the_variance_is_several_times_below_that_of_a_choice_by_power() {
    let mut random = Random::new(8);
    let triangles: Vec<TriangleLight> = std::iter::repeat_with(|| {
        let middle = DVec3::new(20.0 * random.point().x, 3.0 + 0.2 * random.unit(), 20.0 * random.point().x);
        TriangleLight::random(&mut random, middle, 0.05)
    })
    .take(10_000)
    .collect();
    let all = emissions(&triangles);
    let total: f64 = all.iter().map(|emission| emission.power).sum();
    for floor in [0.0, 0.1] {
        let tree = build(&all, floor);
        let (mut by_tree, mut by_power) = (0.0, 0.0);
        for _ in 0..30 {
            let x = DVec3::new(18.0 * random.point().x, random.unit(), 18.0 * random.point().x);
            let normal = Some((DVec3::Y + 0.5 * random.point()).normalize());
            let light = |triangle: &TriangleLight| {
                triangle.light(x, normal, (1.0 / 3.0, 1.0 / 3.0)) * triangle.doubled_area().length()
            };
            let lights: Vec<f64> = triangles.iter().map(light).collect();
            by_tree += variance(&lights, probabilities(&tree, x, normal).into_iter());
            by_power += variance(&lights, all.iter().map(|emission| emission.power / total));
        }
        assert!(10.0 * by_tree < by_power, "{by_tree} {by_power}");
    }
}

#[test]
fn a_single_emitter_is_certain_and_none_is_none() {
    let x = DVec3::new(1e9, -3.0, 0.1);
    let one = build(&[spark(DVec3::ONE, 0.0), spark(DVec3::ZERO, 3.0)], 0.0);
    for at in [x, DVec3::ZERO] {
        assert_eq!(one.sample(at, Some(LitSide::flat(DVec3::X)), 0.7), Some((1, 1.0, 0.7)));
        assert_eq!(probabilities(&one, at, Some(DVec3::X)), [0.0, 1.0]);
    }
    assert_eq!(one.probability(9, x, None), 0.0);
    for none in [build(&[], 0.0), build(&[spark(DVec3::ONE, 0.0)], 1.0)] {
        assert!(none.is_empty());
        assert_eq!(none.sample(x, None, 0.5), None);
        assert_eq!(none.probability(0, x, None), 0.0);
    }
}

#[test]
fn emitters_in_one_place_in_a_row_and_far_away_are_all_found() {
    let line = |i: i32| DVec3::new(f64::from(i), 0.0, 0.0);
    // Halves towards a point: every cut peels off a few, far beyond 64 levels.
    let shrinking = |i: i32| DVec3::new(0.5f64.powi(i), 0.0, 0.0);
    let layouts: [(&str, &dyn Fn(i32) -> DVec3); 5] = [
        ("one place", &|_| DVec3::ONE),
        ("the origin", &|_| DVec3::ZERO),
        ("a row", &line),
        ("far away", &|i| 1e9 + 1e-3 * line(i)),
        ("shrinking", &shrinking),
    ];
    for (name, place) in layouts {
        let all: Vec<Emission> = (0..1000).map(|i| spark(place(i), 1.0 + f64::from(i))).collect();
        let tree = build(&all, 0.0);
        let mut random = Random::new(9);
        for x in [DVec3::ZERO, place(17), place(999), DVec3::splat(1e9), DVec3::splat(-1e30)] {
            let all = probabilities(&tree, x, None);
            let sum: f64 = all.iter().sum();
            assert!((sum - 1.0).abs() < 1e-12 && all.iter().all(|&p| p > 0.0), "{name} at {x}: {sum}");
            let lit: f64 = probabilities(&tree, x, Some(DVec3::X)).iter().sum();
            assert!((lit + loss(&tree, x, Some(DVec3::X)) - 1.0).abs() < 1e-12, "{name} at {x}: {lit}");
            for _ in 0..100 {
                let chosen = tree.sample(x, None, random.unit());
                let (emitter, probability, _) = chosen.expect("sparks shine everywhere");
                assert_eq!(probability, all[emitter as usize], "{name} at {x}");
            }
        }
        assert_eq!(tree.sample(DVec3::NAN, None, 0.5), None);
    }
}

#[test]
fn no_emitter_of_a_hundred_thousand_is_lost_however_deep_cuts_would_go() {
    for ratio in [0.5f64, 0.999] {
        let all: Vec<Emission> =
            (0..100_000).map(|i| spark(DVec3::splat(ratio.powi(i)), ratio.powi(-(i % 400)))).collect();
        let tree = build(&all, 0.0);
        let mut polylines = tree.polylines.clone();
        polylines.sort_unstable();
        polylines.dedup();
        assert_eq!(polylines.len(), all.len());
        assert_eq!(tree.nodes.len(), 2 * all.len() - 2);
        for (emitter, &polyline) in tree.polylines.iter().enumerate().step_by(97) {
            let (mut subtree, mut polyline) = (tree.root.expect("there are emitters"), polyline);
            while let Subtree::Pair(first) = subtree {
                subtree = tree.nodes[first as usize + (polyline & 1) as usize].subtree;
                polyline >>= 1;
            }
            assert!(matches!((subtree, polyline), (Subtree::Emitter(found), 1) if found as usize == emitter));
        }
    }
}

#[test]
fn a_node_is_small() {
    assert!(size_of::<LightTreeNode>() <= 64);
}

#[test]
fn a_light_that_a_leaning_normal_faces_is_not_rarely_chosen_where_it_grazes_the_surface() {
    for height in [1e-2, 1e-5, 1e-9] {
        let tree = build(&[spark(DVec3::Y, 1.0), spark(DVec3::new(1.0, height, 0.0), 1.0)], 0.0);
        let grazing = |grazing| tree.probability(1, DVec3::ZERO, Some(LitSide { normal: DVec3::Y, grazing }));
        assert!((grazing(0.0) - height.max(1e-6)).abs() < 0.02 * height.max(1e-6), "{}", grazing(0.0));
        assert!((grazing(0.25) - 0.2).abs() < 1e-4, "{}", grazing(0.25));
        assert!((tree.probability(0, DVec3::ZERO, None) - 0.5).abs() < 1e-4);
    }
    let below = build(&[spark(DVec3::Y, 1.0), spark(DVec3::new(1.0, -0.01, 0.0), 1.0)], 0.0);
    assert_eq!(below.probability(1, DVec3::ZERO, Some(LitSide { normal: DVec3::Y, grazing: 0.25 })), 0.0);
}
