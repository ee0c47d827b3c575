//! Footprints of pixels in textures, through the lens: what few samples see is near what many do.

use crate::support::quads::{Quad, gltf, picture};
use crate::support::{
    Random, camera, far, film, hole, material, render, scene, scene_with, sphere, wormhole,
};
use glam::{DMat3, DVec2, DVec3};
use serde_json::json;
use warpfront::geometry::PrimitiveId;
use warpfront::light::{BeamRay, Beams, Lensed};
use warpfront::scene::{Baked, LightSampling};
use warpfront::spacetime::{ConformallyFlat, Ellis, Mouths, Schwarzschild, Side};
use warpfront::trace::transport::{Landing, Outcome};
use warpfront::trace::{Ray, Run, Shot, shoot};

/// Fields along an edge of a wall.
const FIELDS: u32 = 32;
/// Half the width of the room.
const HALF: f64 = 16.0;
/// Width of the picture.
const SIZE: usize = 48;

/// Lower left corner, right and up of the walls, seen from inside.
fn walls() -> [[DVec3; 3]; 6] {
    let wall = |outwards: DVec3, up: DVec3| {
        let right = outwards.cross(up);
        [HALF * (outwards - right - up), 2.0 * HALF * right, 2.0 * HALF * up]
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    [wall(-z, y), wall(z, y), wall(x, y), wall(-x, y), wall(y, z), wall(-y, z)]
}

/// A room whose walls shine in a checker, a hole in its middle.
fn room() -> Baked {
    let fields = (0..FIELDS * FIELDS).map(|at| [255 * ((at + at / FIELDS) % 2) as u8; 3]);
    let texels: Vec<[u8; 4]> = fields.map(|[r, g, b]| [r, g, b, 255]).collect();
    let quads = walls().map(|[corner, right, up]| Quad::new(corner, right, up, 0));
    let shining = json!([{
        "extensions": { "KHR_materials_unlit": {} },
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
    }]);
    let text = hole(DVec3::ZERO, 1.0)
        + &camera(15.0 * DVec3::Z, DVec3::ZERO, 40.0)
        + &film(SIZE, SIZE)
        + "[[entity]]\ngltf = \"a.gltf\"\n";
    let mut scene = scene_with(&text, &[("a.gltf", &gltf(&quads, &shining, &[picture(FIELDS, &texels)]))]);
    scene.settings.light_sampling = LightSampling::Off;
    scene
}

/// The ray through a place of a pixel.
fn ray(scene: &Baked, pixel: usize, place: DVec2) -> Ray {
    let film = (DVec2::new((pixel % SIZE) as f64, (pixel / SIZE) as f64) + place) / SIZE as f64;
    let (position, direction) = scene.camera.ray(film, 1.0, DVec2::splat(0.5)).expect("a ray");
    Ray { position, direction, origin_prim: PrimitiveId::NONE }
}

/// The field that a ray ends on: 0 or 1; 0 within the hole.
fn field(shot: &Shot) -> f64 {
    let Outcome::Landed(landing) = shot.end else { return 0.0 };
    let height = |[corner, right, up]: &[DVec3; 3]| {
        (landing.position - corner).dot(right.cross(*up).normalize()).abs()
    };
    let [corner, right, up] =
        walls().into_iter().min_by(|one, other| height(one).total_cmp(&height(other))).expect("six");
    let from = landing.position - corner;
    let along =
        |edge: DVec3| ((from.dot(edge) / edge.length_squared() * f64::from(FIELDS)) as u32).min(FIELDS - 1);
    f64::from((along(right) + FIELDS - 1 - along(up)) % 2)
}

/// The green plane.
fn green(scene: &mut Baked, spp: u32, seed: u64) -> Vec<f64> {
    (scene.settings.spp, scene.settings.seed) = (spp, seed);
    let image = render(scene, &Run::default()).image;
    image.channel("G").expect("G").iter().map(|&value| f64::from(value)).collect()
}

#[test]
fn a_checker_around_the_photon_ring_does_not_shimmer_and_keeps_its_mean() {
    const LOOKS: usize = 64;
    const SEEDS: u64 = 16;
    let mut scene = room();
    let mut random = Random::new(1);
    // Points by themselves, without textures.
    let mut place = || DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0));
    let rays: Vec<Ray> = (0..SIZE * SIZE * LOOKS).map(|look| ray(&scene, look / LOOKS, place())).collect();
    let mean = |shots: &[Shot]| shots.iter().map(field).sum::<f64>() / LOOKS as f64;
    let means: Vec<f64> = shoot(&scene, &rays).chunks(LOOKS).map(mean).collect();
    let pictures: Vec<Vec<f64>> = (1..=SEEDS).map(|seed| green(&mut scene, 1, seed)).collect();
    let of_seeds = |pixel: usize| {
        let values = || pictures.iter().map(|picture| picture[pixel]);
        let mean = values().sum::<f64>() / SEEDS as f64;
        (mean, values().map(|value| (value - mean).powi(2)).sum::<f64>() / (SEEDS - 1) as f64)
    };
    let hole = Schwarzschild::new(1.0);
    let (mut shimmer, mut points) = (0.0, 0.0);
    for (pixel, mean) in means.iter().enumerate() {
        let Ray { position, direction, .. } = ray(&scene, pixel, DVec2::splat(0.5));
        let b = hole.index(1.0 / position.length()) * position.cross(direction).length();
        if (1.05..1.2).contains(&(b / hole.critical_impact_parameter())) {
            (shimmer, points) = (shimmer + of_seeds(pixel).1, points + mean * (1.0 - mean));
        }
    }
    // By distance alone it is a fifteenth.
    assert!(points > 20.0 && shimmer < 0.01 * points, "variance {shimmer}, of points {points}");
    for block in 0..16 {
        let pixels = (0..SIZE * SIZE).filter(|at| at % SIZE / 12 + at / SIZE / 12 * 4 == block);
        let (mut difference, mut variance) = (0.0, 0.0);
        for pixel in pixels {
            let (mean, (found, of_one)) = (means[pixel], of_seeds(pixel));
            difference += found - mean;
            variance += mean * (1.0 - mean) / (LOOKS - 1) as f64 + of_one / SEEDS as f64;
        }
        let z = difference / variance.sqrt();
        assert!(z.abs() < 4.0, "block {block}: {z}");
    }
}

#[test]
fn beams_through_a_throat_are_as_wide_as_neighbouring_rays_are_apart() {
    /// Angle between the rays, radians.
    const APART: f64 = 1e-5;
    let beyond = DVec3::new(90.0, 10.0, -20.0);
    let (eye, place) =
        (DVec3::new(1.0, 2.0, 7.0), format!("far_center = {}\n", crate::support::vector(beyond)));
    let scene = scene(
        &(wormhole(DVec3::ZERO, 1.0, &place)
            + &camera(eye, DVec3::ZERO, 40.0)
            + &film(2000, 2000)
            + "[render]\nstepper = \"dop853\"\ntolerance = 1e-10\narc_tolerance = 1e-9\n"
            + &material("wall", 0.5, 0.0)
            + &sphere(DVec3::ZERO, 20.0, "wall")
            + &far(&sphere(beyond, 15.0, "wall"))),
    );
    let mouths = Mouths { near: DVec3::ZERO, far: beyond, rotation: DMat3::IDENTITY };
    let beams = Lensed::through(Ellis::new(1.0), mouths, 0).expect("a photon sphere");
    let landing = |direction: DVec3| -> Landing {
        let ray = Ray { position: eye, direction, origin_prim: PrimitiveId::NONE };
        let Outcome::Landed(landing) = shoot(&scene, &[ray])[0].end else { panic!("{direction}") };
        landing
    };
    let inwards = -eye.normalize();
    let (across, out) = inwards.any_orthonormal_pair();
    let mut sides = [0, 0];
    for number in 0..40 {
        let angle = 0.01 * f64::from(number) + 0.003;
        let turned = |in_plane: f64, beside: f64| {
            let (sin, cos) = (angle + in_plane).sin_cos();
            (beside.cos() * (cos * inwards + sin * across) + beside.sin() * out).normalize()
        };
        let Landing { position, direction: arrival, primitive, .. } = landing(turned(0.0, 0.0));
        let width = |in_plane: f64, beside: f64| {
            let [one, other] =
                [0.5, -0.5].map(|half| landing(turned(half * in_plane, half * beside)).position);
            (one - other - (one - other).dot(arrival) * arrival).length() / APART
        };
        let (leaving, to) = (turned(0.0, 0.0), (primitive.side(), position));
        let ray = BeamRay { from: (Side::Near, eye), leaving, to, arriving: arrival };
        let found = beams.widths(&ray).expect("widths");
        for (found, apart) in found.into_iter().zip([width(APART, 0.0), width(0.0, APART)]) {
            assert!(
                (found / apart - 1.0).abs() < 2e-3,
                "{angle} on the {:?} side: {found} for {apart}",
                to.0
            );
        }
        sides[usize::from(to.0 == Side::Far)] += 1;
    }
    assert!(sides[0] > 5 && sides[1] > 5, "{sides:?}");
}
