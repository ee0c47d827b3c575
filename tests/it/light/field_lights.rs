//! Light sampling among several holes and through lenses: regions have the densities that are said of them, and pictures
//! are those that rays show that nothing aims; lights that are points light as past one hole.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::support::lit::{Agreement, Twist, picture, room};
use crate::support::{Random, camera, closed_box, film, material, scene_with, sphere};
use warpfront::geometry::PrimitiveId;
use warpfront::light::{EmitterHit, FieldRegions, Incoming, LightSampler, Lights, Punctual, Receiver};
use warpfront::scene::Baked;
use warpfront::scene::LightSampling::{Geodesic, Off};
use warpfront::spacetime::{Entry, GradedLens, Hole, IndexMedium, Lenses, SeveralHoles, SpacetimeKind};

/// Puts holes into a scene.
fn put_holes(scene: &mut Baked, holes: &[Hole]) {
    scene.spacetime = SpacetimeKind::Indexed(IndexMedium::SeveralHoles(SeveralHoles::new(holes)));
}

const HOLES: [Hole; 2] = [
    Hole { center: DVec3::new(-2.5, 0.5, 1.0), mass: 0.6 },
    Hole { center: DVec3::new(2.0, -1.0, 0.0), mass: 0.3 },
];

/// A grey room about the origin, seen from within, with `more` in it.
fn grey_room(more: &str) -> Baked {
    let text = camera(DVec3::new(5.0, 4.0, 5.5), DVec3::ZERO, 85.0)
        + &film(32, 32)
        + "[render]\nmax_depth = 4\n"
        + &material("grey", 0.5, 0.0)
        + "[[entity]]\nmesh = \"box.obj\"\nmaterial = \"grey\"\n"
        + more;
    scene_with(&text, &[("box.obj", &closed_box(DVec3::splat(-6.0), DVec3::splat(6.0)))])
}

#[test]
fn regions_among_several_holes_have_the_density_that_is_said_of_them() {
    let (mut random, mut count) = (Random::new(1), 0);
    for _ in 0..40 {
        let hole = |_| Hole { center: 6.0 * random.in_cube(), mass: random.log_between(0.1, 1.0) };
        let field = SeveralHoles::new(&(0..3).map(hole).collect::<Vec<_>>());
        let more = material("light", 0.5, 1.0)
            + &sphere(8.0 * random.in_cube(), random.log_between(0.05, 1.0), "light");
        let Baked { geometry, materials, environment, .. } = grey_room(&more);
        let lights = Lights::new(&geometry, (&materials, &[]), &environment, &[], 0.1);
        let emitter = lights.emitters()[0];
        let sampler = FieldRegions::new(field, 20.0, 1);
        let (position, normal) = (8.0 * random.in_cube(), random.direction());
        let receiver = Receiver { position, normal, grazing: 0.0, both_sides: false, on: PrimitiveId::NONE };
        for _ in 0..50 {
            let numbers = [0; 2].map(|_| random.between(0.0, 1.0));
            let Some(sample) = sampler.sample(&lights, &receiver, numbers) else { continue };
            let Incoming::Radiance(radiance, said) = sample.light else { panic!("{:?}", sample.light) };
            let (primitive, arrival) = (emitter.primitive, sample.direction);
            let hit = EmitterHit { primitive, position: emitter.middle(), normal: DVec3::X, arrival };
            let density = sampler.surface_density(&lights, &receiver, sample.direction, &hit);
            assert!(radiance == Vec3::ONE && said.is_finite(), "{said}");
            assert!((density / said - 1.0).abs() < 1e-9, "{said} is not {density}");
            count += 1;
        }
    }
    assert!(count > 1000, "{count}");
}

/// Compares pictures with and without light sampling of `count` random rooms with holes or lenses.
fn random_rooms(count: u64, spp: u32) {
    let mut squares = 0.0;
    for number in 0..count {
        let mut random = Random::new(3000 + number);
        let twist = [Twist::Flat, Twist::Nothing, Twist::Close][number as usize % 3];
        let mut scene = room(&mut random, twist, 1.5);
        let places = 2 + number as usize % 3;
        if number % 4 == 3 {
            let lens = |_| GradedLens::Gaussian {
                center: 6.0 * random.in_cube(),
                width: random.between(0.5, 2.0),
                amplitude: random.between(-0.3, 0.5),
            };
            let lenses = Lenses::new(&(0..places).map(lens).collect::<Vec<_>>());
            scene.spacetime = SpacetimeKind::Indexed(IndexMedium::Lenses(lenses));
        } else {
            let hole = |_| Hole { center: 7.0 * random.in_cube(), mass: random.log_between(0.1, 1.0) };
            put_holes(&mut scene, &(0..places).map(hole).collect::<Vec<_>>());
        }
        let with = picture(&mut scene, Geodesic, spp / 4, 2 * number + 1);
        let without = picture(&mut scene, Off, spp, 2 * number);
        let agreement = Agreement::of(&with, &without);
        agreement.check(&format!("{number} {twist:?}, {places} things"));
        squares += agreement.z.powi(2);
    }
    let mean = squares / count as f64;
    println!("mean square of z {mean:.2}");
    assert!(mean < 1.5 + 3.0 * (2.0 / count as f64).sqrt(), "{mean}");
}

#[test]
fn rooms_with_several_holes_or_lenses_look_the_same_with_and_without_light_sampling() {
    random_rooms(4, 128);
}

#[test]
#[ignore = "so little noise takes half an hour: cargo test --release --test it field_lights -- --ignored --nocapture"]
fn rooms_with_several_holes_or_lenses_look_the_same_to_a_few_permille() {
    random_rooms(12, 2000);
}

#[test]
fn lights_that_are_points_are_seen_past_one_hole_as_past_a_hole_of_extremal_charge() {
    let center = DVec3::new(-1.0, 0.5, 0.0);
    let lights = [
        Punctual::Point { position: DVec3::new(-3.0, -1.0, -1.0), intensity: Vec3::splat(20.0) },
        Punctual::Spot {
            position: DVec3::new(3.0, 4.0, 2.0),
            direction: DVec3::new(-0.6, -0.8, 0.0),
            intensity: Vec3::splat(30.0),
            cos_inner: 0.9,
            cos_outer: 0.4,
        },
        // Into an open room.
        Punctual::Distant { direction: DVec3::new(0.48, -0.6, 0.64), irradiance: Vec3::ONE },
    ];
    for light in lights {
        let mut scene = grey_room("");
        if light.position().is_none() {
            let text = camera(DVec3::new(5.0, 4.0, 5.5), DVec3::ZERO, 85.0)
                + &film(32, 32)
                + &material("grey", 0.5, 0.0)
                + &sphere(DVec3::new(0.5, -4.0, 1.0), 3.0, "grey");
            scene = scene_with(&text, &[]);
        }
        scene.punctual = vec![light];
        scene.spacetime = Entry::named("reissner-nordstrom").unwrap().with(center, &[1.0, 1.0]);
        let charged = picture(&mut scene, Geodesic, 64, 1);
        put_holes(&mut scene, &[Hole { center, mass: 0.5 }]);
        let one = picture(&mut scene, Geodesic, 64, 2);
        Agreement::of(&one, &charged).check(&format!("{light:?}"));
    }
}

#[test]
#[ignore = "a small ball that nothing aims at takes minutes: cargo test --release --test it a_point_among -- --ignored --nocapture"]
fn a_point_among_several_holes_lights_a_room_as_a_small_ball_does() {
    let (place, radius, radiance) = (DVec3::new(0.5, 3.0, -2.0), 0.3, 80.0);
    let potential = HOLES.iter().map(|hole| hole.mass / hole.center.distance(place)).sum::<f64>() + 1.0;
    let intensity = radiance * PI * (radius * potential).powi(2);
    // All that the camera sees is floor and walls, so that the ball is not seen itself.
    let room = |more: &str| {
        let text = camera(DVec3::new(0.0, -3.0, 5.0), DVec3::new(0.0, -6.0, 4.0), 60.0)
            + &film(16, 12)
            + "[render]\nmax_depth = 2\n"
            + &material("grey", 0.75, 0.0)
            + "[[entity]]\nmesh = \"box.obj\"\nmaterial = \"grey\"\n"
            + more;
        let mut scene = scene_with(&text, &[("box.obj", &closed_box(DVec3::splat(-6.0), DVec3::splat(6.0)))]);
        put_holes(&mut scene, &HOLES);
        scene
    };
    let mut point = room("");
    point.punctual = vec![Punctual::Point { position: place, intensity: Vec3::splat(intensity as f32) }];
    let mut ball = room(&(material("lamp", 0.0, radiance) + &sphere(place, radius, "lamp")));
    let with = picture(&mut point, Geodesic, 512, 1);
    let without = picture(&mut ball, Off, 1 << 16, 2);
    Agreement::of(&with, &without).check("a point and a ball");
}

#[test]
fn a_distant_light_among_far_holes_lights_as_in_flat_space() {
    let text = camera(DVec3::new(5.0, 4.0, 5.5), DVec3::ZERO, 85.0)
        + &film(16, 16)
        + &material("grey", 0.5, 0.0)
        + &sphere(DVec3::new(0.5, -4.0, 1.0), 3.0, "grey");
    let mut scene = scene_with(&text, &[]);
    let direction = DVec3::new(0.48, -0.6, 0.64);
    scene.punctual = vec![Punctual::Distant { direction, irradiance: Vec3::ONE }];
    scene.spacetime = SpacetimeKind::Flat;
    let flat = picture(&mut scene, Geodesic, 64, 1);
    put_holes(&mut scene, &HOLES.map(|hole| Hole { center: hole.center + 1e7 * DVec3::Y, ..hole }));
    Agreement::of(&picture(&mut scene, Geodesic, 64, 2), &flat).check("far holes");
}
