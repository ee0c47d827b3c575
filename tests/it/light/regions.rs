//! Light sampling around spinning holes: regions of directions have the densities that are said of them, and show the
//! same picture as rays that nothing aims.

use std::f64::consts::PI;

use glam::{DMat3, DVec3, Vec3};

use crate::support::chi_square::{Directions, Verdict};
use crate::support::lit::{Agreement, Twist, picture, room};
use crate::support::{Random, camera, material, mesh, rectangle, scene_with, sphere};
use warpfront::geodesic::kerr::PlacedHole;
use warpfront::geometry::{PrimitiveId, Shape};
use warpfront::light::{EmitterHit, Incoming, LightSampler, Lights, Receiver, Regions, Sky, Target};
use warpfront::scene::Baked;
use warpfront::scene::LightSampling::{Geodesic, Off};
use warpfront::shade::{Environment, LatLong, Material};
use warpfront::spacetime::{AtInfinity, KerrNewman, Placement, Side, SpacetimeKind};

/// Samples of a test: few enough that the edges of regions within cells do not show.
const COUNT: usize = 5000;

/// Puts a spinning hole into a scene.
fn spin(scene: &mut Baked, (r_s, spin, charge): (f64, f64, f64), placement: Placement) {
    scene.spacetime = SpacetimeKind::Spinning { placement, hole: KerrNewman::new(r_s, spin, charge) };
}

/// A ball, a disk and two triangles that shine, of radius or width `size`, at the same place.
fn lamps(place: DVec3, size: f64) -> Baked {
    let text = camera(DVec3::new(0.0, 1.0, 60.0), DVec3::ZERO, 60.0)
        + &material("light", 0.5, 1.0)
        + &sphere(place, size, "light")
        + &mesh("lamp.obj", DVec3::ZERO, "light")
        + &format!(
            "[[entity]]\ndisk = {{ center = {:?}, normal = [0.3, -1, 0], outer = {size:?} }}\nmaterial = \"light\"\n",
            place.to_array()
        );
    scene_with(&text, &[("lamp.obj", &rectangle(place, size * DVec3::X, size * DVec3::Y))])
}

/// Probability of drawn directions, one of them the `first`, with a density: by cells as fine as their region.
fn chance_of(directions: &[Option<DVec3>], first: DVec3, density: impl Fn(DVec3) -> f64) -> f64 {
    let spread = directions.iter().flatten().map(|direction| 0.25 * direction.distance_squared(first));
    let cells = Directions { near: 0.1 * spread.fold(0.0, f64::max), ..Directions::even(first) };
    cells.probability(directions.iter().copied(), density)
}

/// A receiver that is lit from one side.
fn receiver(position: DVec3, normal: DVec3) -> Receiver {
    Receiver { position, normal, grazing: 0.0, both_sides: false, on: PrimitiveId::NONE }
}

#[test]
fn regions_are_drawn_from_with_the_density_that_is_said_of_them() {
    let (mut random, mut verdict, mut seen) = (Random::new(1), Verdict::default(), 0);
    for number in 0..6 {
        let axis = random.direction();
        let a = [0.0, 0.9, -0.998, 0.5][number % 4];
        let place = random.log_between(3.0, 25.0) * random.direction();
        let size = random.log_between(0.1, 2.0);
        let position = match number % 3 {
            0 => -random.log_between(4.0, 25.0) * place.normalize(),
            _ => random.log_between(4.0, 25.0) * random.direction(),
        };
        let mut scene = lamps(place, size);
        spin(&mut scene, (2.0, a, 0.0), Placement { axis, ..DVec3::ZERO.into() });
        let SpacetimeKind::Spinning { placement, hole } = scene.spacetime else { unreachable!() };
        let sampler =
            Regions::new(PlacedHole::new(placement, &hole), scene.spacetime.rest_frame(), number as u32 % 2);
        let Baked { geometry, materials, environment, .. } = &scene;
        let lights = Lights::new(geometry, (materials, &[]), environment, &[], 0.1);
        let receiver = receiver(position, random.direction());
        let samples: Vec<_> = (0..COUNT)
            .map(|_| sampler.sample(&lights, &receiver, [0; 2].map(|_| random.between(0.0, 1.0))))
            .collect();
        // Each density is an aim of its own: one light of each scene.
        for emitter in lights.emitters().iter().skip(number % 4).take(1) {
            let hit = |direction| EmitterHit {
                primitive: emitter.primitive,
                position: emitter.middle(),
                normal: DVec3::X,
                arrival: direction,
            };
            let density = |direction| sampler.surface_density(&lights, &receiver, direction, &hit(direction));
            let mine = samples.iter().map(|sample| {
                let sample = sample.as_ref()?;
                let Target::Surface(primitive, _) = sample.target else { return None };
                (primitive == emitter.primitive).then_some(sample)
            });
            let mine: Vec<_> = mine.collect();
            let Some(first) = mine.iter().flatten().next() else { continue };
            for sample in mine.iter().flatten().take(200) {
                let Incoming::Radiance(_, said) = sample.light else { panic!("{:?}", sample.light) };
                let error = density(sample.direction) / said - 1.0;
                assert!(error.abs() < 1e-9, "{number}: {said} is not {}", density(sample.direction));
            }
            seen += 1;
            // Two regions far from each other are no matter for one set of cells.
            if number % 2 == 1 {
                continue;
            }
            let directions: Vec<_> = mine.iter().map(|sample| Some(sample.as_ref()?.direction)).collect();
            let chance = chance_of(&directions, first.direction, density);
            verdict.add(format!("{number}, a = {a}, {:?}", emitter.form), chance);
        }
    }
    assert!(seen > 3, "{seen}");
    verdict.check();
}

/// A dark sky with two bright spots, one of them a pixel.
fn sky() -> Environment {
    let (width, height) = (64, 32);
    let mut pixels = vec![Vec3::splat(0.1); width * height];
    for (x, y, radiance) in [(40, 9, 500.0), (10, 20, 20.0), (11, 20, 20.0), (11, 21, 20.0)] {
        pixels[y * width + x] = Vec3::splat(radiance);
    }
    Environment::Image(LatLong { width, height, pixels, from_world: DMat3::from_rotation_x(0.4) })
}

#[test]
fn tiles_of_a_sky_are_drawn_from_with_the_density_that_is_said_of_them() {
    let (mut random, mut verdict) = (Random::new(5), Verdict::default());
    for number in 0..4 {
        let a = [0.9, -0.998, 0.0, 0.5][number];
        let mut scene = lamps(DVec3::X, 1.0);
        let axis = random.direction();
        spin(&mut scene, (2.0, a, 0.0), Placement { axis, ..DVec3::ZERO.into() });
        let SpacetimeKind::Spinning { placement, hole } = scene.spacetime else { unreachable!() };
        let frame = scene.spacetime.rest_frame();
        let sampler = Regions::new(PlacedHole::new(placement, &hole), frame, number as u32 % 2);
        let lights = Lights::new(&scene.geometry, (&[Material::default()], &[]), &sky(), &[], 0.1);
        assert!(lights.has_sky() && lights.emitters().is_empty());
        let Environment::Image(picture) = sky() else { unreachable!() };
        let tiles = Sky::new(&picture).unwrap();
        let position = random.log_between(4.0, 25.0) * random.direction();
        let receiver = receiver(position, random.direction());
        let samples: Vec<_> = (0..4 * COUNT)
            .map(|_| sampler.sample(&lights, &receiver, [0; 2].map(|_| random.between(0.0, 1.0))))
            .collect();
        // The tile of the brightest pixel, and where it is seen.
        let tile = (0..100).filter_map(|i| tiles.choose_tile(0.01 * f64::from(i)));
        let (index, tile, _) = tile.max_by(|a, b| a.1.pmf.total_cmp(&b.1.pmf)).unwrap();
        let bright = tile.middle;
        assert_eq!(tiles.tile_of(bright).0, index);
        let there = AtInfinity { side: Side::Near, direction: bright };
        let density = |direction| sampler.sky_density(&lights, &receiver, direction, there);
        let mine: Vec<_> = samples
            .iter()
            .map(|sample| sample.filter(|sample| sample.target == Target::SkyTile(Side::Near, index)))
            .collect();
        let first = mine.iter().flatten().next().expect("a sample of the bright pixel");
        for sample in mine.iter().flatten().take(200) {
            let Incoming::Seen(said) = sample.light else { panic!("{:?}", sample.light) };
            let error = density(sample.direction) / said - 1.0;
            assert!(error.abs() < 1e-9, "{number}: {said} is not {}", density(sample.direction));
        }
        if number % 2 == 0 {
            let directions: Vec<_> = mine.iter().map(|sample| Some(sample.as_ref()?.direction)).collect();
            let chance = chance_of(&directions, first.direction, density);
            verdict.add(format!("{number}, a = {a}"), chance);
        }
    }
    verdict.check();
}

#[test]
fn no_place_of_a_light_or_a_receiver_is_too_odd() {
    let mut random = Random::new(2);
    let samplers = [-1.0, -0.6, 0.0, 0.3, 0.998].map(|a| {
        let placement = Placement { axis: random.direction(), ..DVec3::ZERO.into() };
        let mut scene = lamps(DVec3::X, 1.0);
        spin(&mut scene, (2.0, a, 0.0), placement);
        let place = PlacedHole::new(placement, &KerrNewman::new(2.0, a, 0.0));
        (placement, Regions::new(place, scene.spacetime.rest_frame(), 1))
    });
    for number in 0..300 {
        let (Placement { axis, .. }, sampler) = &samplers[number % samplers.len()];
        let radius = |random: &mut Random| random.log_between(1e-3, 1e6);
        let along = number % 3 == 0;
        let near = |random: &mut Random| random.log_between(1e-2, 1e3);
        let place = near(&mut random) * if along { *axis } else { random.direction() };
        let position = radius(&mut random) * if along { -*axis } else { random.direction() };
        let position = if number % 7 == 0 { place } else { position };
        let scene = lamps(place, near(&mut random));
        let lights = Lights::new(&scene.geometry, (&scene.materials, &scene.textures), &sky(), &[], 0.1);
        let receiver = receiver(position, random.direction());
        for _ in 0..20 {
            let numbers = [0; 2].map(|_| random.between(0.0, 1.0));
            let Some(sample) = sampler.sample(&lights, &receiver, numbers) else { continue };
            let density = match sample.light {
                Incoming::Radiance(radiance, density) if radiance == Vec3::ONE => density,
                Incoming::Seen(density) => density,
                light => panic!("{light:?}"),
            };
            assert!(density > 0.0 && density.is_finite(), "{number}: {density}");
            assert!((sample.direction.length() - 1.0).abs() < 1e-9, "{number}: {}", sample.direction);
        }
    }
}

/// Compares pictures with and without light sampling of `count` random rooms around spinning holes.
fn random_rooms(count: u64, spp: u32) {
    let (mut squares, mut compared, mut number) = (0.0, 0, 0);
    while compared < count {
        number += 1;
        let mut random = Random::new(2000 + number);
        let twist = [Twist::Flat, Twist::Nothing, Twist::Close][number as usize % 3];
        let mut scene = room(&mut random, twist, 1.5);
        let a = [0.9, -0.9, 0.0, 0.998][number as usize % 4];
        let charge = if number % 5 == 0 { 0.3 } else { 0.0 };
        let charge = if a * a + charge * charge > 1.0 { 0.0 } else { charge };
        let placement = Placement { axis: random.direction(), ..(3.0 * random.in_cube()).into() };
        let r_s = random.between(0.8, 4.0);
        // Nothing is at rest in the ergosphere.
        if scene.geometry.radii(placement.center).is_none_or(|(nearest, _)| nearest < 1.1 * r_s) {
            continue;
        }
        spin(&mut scene, (r_s, a, charge), placement);
        let with = picture(&mut scene, Geodesic, spp / 4, 2 * number + 1);
        let without = picture(&mut scene, Off, spp, 2 * number);
        let agreement = Agreement::of(&with, &without);
        agreement.check(&format!("{number} {twist:?} a = {a}, e = {charge}"));
        squares += agreement.z.powi(2);
        compared += 1;
    }
    let mean = squares / count as f64;
    println!("mean square of z {mean:.2}");
    assert!(mean < 1.5 + 3.0 * (2.0 / count as f64).sqrt(), "{mean}");
}

#[test]
fn rooms_with_spinning_holes_look_the_same_with_and_without_light_sampling() {
    random_rooms(4, 128);
}

#[test]
#[ignore = "so little noise takes half an hour: cargo test --release --test it regions -- --ignored --nocapture"]
fn rooms_with_spinning_holes_look_the_same_to_a_few_permille() {
    random_rooms(12, 2000);
}

#[test]
fn a_lamp_behind_a_spinning_hole_is_sampled_as_a_ring() {
    // On the axis of the hole, on either side: light comes from all around.
    let place = DVec3::new(0.0, -10.0, 0.0);
    let mut scene = lamps(place, 0.5);
    spin(&mut scene, (2.0, 0.9, 0.0), DVec3::ZERO.into());
    let SpacetimeKind::Spinning { placement, hole } = scene.spacetime else { unreachable!() };
    let sampler = Regions::new(PlacedHole::new(placement, &hole), scene.spacetime.rest_frame(), 1);
    let Baked { geometry, materials, environment, .. } = &scene;
    let lights = Lights::new(geometry, (materials, &[]), environment, &[], 0.1);
    let position = DVec3::new(0.0, 15.0, 0.0);
    let receiver = receiver(position, DVec3::NEG_Y);
    let mut random = Random::new(3);
    let mut azimuths = [0; 8];
    for _ in 0..4000 {
        let numbers = [0; 2].map(|_| random.between(0.0, 1.0));
        let Some(sample) = sampler.sample(&lights, &receiver, numbers) else { continue };
        let Target::Surface(primitive, _) = sample.target else { continue };
        let emitter = lights.emitters().iter().find(|emitter| emitter.primitive == primitive);
        if emitter
            .is_some_and(|emitter| matches!(emitter.form, warpfront::light::Form::Whole(Shape::Sphere(_))))
        {
            let azimuth = libm::atan2(sample.direction.z, sample.direction.x) / PI;
            azimuths[((azimuth + 1.0) * 4.0).min(7.9) as usize] += 1;
        }
    }
    let (least, most) = (azimuths.iter().min().unwrap(), azimuths.iter().max().unwrap());
    assert!(*least > 20 && *most < 4 * least, "{azimuths:?}");
}
