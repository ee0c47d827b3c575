//! Light samples: an emitter of ten thousand for a point among them, and directions in which lamps may be seen from
//! where camera rays land in a scene. One core.

mod common;

use std::hint::black_box;
use std::path::Path;

use common::{ITEMS, direction, random};
use divan::Bencher;
use divan::counter::ItemsCount;
use glam::{DVec2, DVec3};
use rand::RngExt;
use rand::rngs::Xoshiro256PlusPlus;
use warpfront::geometry::PrimitiveId;
use warpfront::light::{Emission, Lensed, LightSampler, Lights, LitSide, Receiver, StraightAim, Tree};
use warpfront::scene::{self, Baked};
use warpfront::spacetime::SpacetimeKind;
use warpfront::trace::transport::Outcome;
use warpfront::trace::{Ray, shoot};

fn main() {
    divan::main();
}

const EMITTERS: u32 = 10_000;

fn tree(random: &mut Xoshiro256PlusPlus) -> Tree {
    let mut emission = || {
        let middle = DVec3::from_array(random.random());
        Emission {
            min: middle - 0.002,
            max: middle + 0.002,
            power: random.random(),
            axis: direction(random),
            cos_normals: 1.0,
            cos_emission: 0.0,
            both_sides: false,
        }
    };
    let emissions: Vec<Emission> = (0..EMITTERS).map(|_| emission()).collect();
    Tree::build(EMITTERS, |emitter| emissions[emitter as usize], 0.1)
}

fn count(bencher: Bencher, find: impl Fn(&Tree, DVec3, DVec3, f64) -> f64) {
    let mut random = random();
    let tree = tree(&mut random);
    let mut place = || (DVec3::from_array(random.random()), direction(&mut random), random.random());
    let places: Vec<(DVec3, DVec3, f64)> = (0..ITEMS).map(|_| place()).collect();
    bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
        for &(x, normal, u) in &places {
            black_box(find(&tree, black_box(x), normal, u));
        }
    });
}

#[divan::bench]
fn sample(bencher: Bencher) {
    count(bencher, |tree, x, normal, u| {
        tree.sample(x, Some(LitSide::flat(normal)), u).map_or(0.0, |chosen| chosen.1)
    });
}

#[divan::bench]
fn probability(bencher: Bencher) {
    count(bencher, |tree, x, normal, u| {
        tree.probability((u * f64::from(EMITTERS)) as u32, x, Some(LitSide::flat(normal)))
    });
}

/// The scene whose lamp is proposed.
const SCENE: &str = "scenes/cornell_black_hole.toml";

/// Where rays through random places of the film land: the points, their normals towards the camera, and what they lie
/// on.
fn landings(scene: &Baked, random: &mut Xoshiro256PlusPlus) -> Vec<(DVec3, DVec3, PrimitiveId)> {
    let mut ray = || {
        let film = DVec2::from_array(random.random());
        let (position, direction) = scene.camera.ray(film, 4.0 / 3.0, DVec2::splat(0.5)).expect("a ray");
        Ray { position, direction, origin_prim: PrimitiveId::NONE }
    };
    let rays: Vec<Ray> = (0..ITEMS).map(|_| ray()).collect();
    let landing = |end| match end {
        Outcome::Landed(landing) => {
            let normal = scene.geometry.surface_point(landing.primitive, landing.position).normal;
            Some((landing.position, -normal * normal.dot(landing.direction).signum(), landing.primitive))
        }
        _ => None,
    };
    shoot(scene, &rays).iter().filter_map(|shot| landing(shot.end)).collect()
}

/// Proposes directions to the lamp with an aim, which the scene's spacetime decides.
fn propose<S: LightSampler>(bencher: Bencher, sampler: impl FnOnce(SpacetimeKind) -> S) {
    let scene = scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join(SCENE), &[]).expect(SCENE);
    let mut random = random();
    let sampler = sampler(scene.spacetime.clone());
    let lights = Lights::new(
        &scene.geometry,
        (&scene.materials, &scene.textures),
        &scene.environment,
        &scene.punctual,
        0.0,
    );
    let places = landings(&scene, &mut random);
    let numbers: Vec<[f64; 2]> = places.iter().map(|_| random.random()).collect();
    bencher.counter(ItemsCount::new(places.len())).bench_local(|| {
        for (&(position, normal, on), &u) in places.iter().zip(&numbers) {
            let receiver =
                Receiver { position: black_box(position), normal, grazing: 0.0, both_sides: false, on };
            black_box(sampler.sample(&lights, &receiver, u));
        }
    });
}

#[divan::bench]
fn propose_along_lines(bencher: Bencher) {
    propose(bencher, |_| StraightAim);
}

#[divan::bench]
fn propose_along_geodesics(bencher: Bencher) {
    propose(bencher, |spacetime| {
        let (center, metric) = spacetime.medium().expect(SCENE);
        Lensed::new(metric, center, 1).expect("a photon sphere")
    });
}
