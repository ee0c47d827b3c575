//! Point, spot and distant lights around spinning holes: without spin those around Schwarzschild's, far away those of
//! flat space, and a point light that of a small ball.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::support::lit::{Agreement, picture};
use crate::support::{Random, camera, film, material, mesh, obj, rectangle, scene_with};
use warpfront::geodesic::kerr::PlacedHole;
use warpfront::geometry::{Geometry, PrimitiveId, Primitives};
use warpfront::light::{Incoming, Lensed, LightSampler, Lights, Punctual, Receiver, Regions};
use warpfront::scene::Baked;
use warpfront::scene::LightSampling::Geodesic;
use warpfront::shade::Environment;
use warpfront::spacetime::{KerrNewman, Placement, Schwarzschild, SpacetimeKind};

/// Numbers in [0, 1) that choose between rays.
const CHOICES: usize = 2000;

fn spinning(r_s: f64, spin: f64, axis: DVec3) -> Regions {
    let hole = KerrNewman::new(r_s, spin, 0.0);
    let placement = Placement { axis, ..DVec3::ZERO.into() };
    let frame = SpacetimeKind::Spinning { placement, hole }.rest_frame();
    Regions::new(PlacedHole::new(placement, &hole), frame, 1)
}

/// Mean irradiance of a light's samples at a receiver that faces along `normal`, how much one choice more or less of each
/// ray would change that, and the directions that occur.
fn light(
    sampler: &dyn LightSampler,
    light: Punctual,
    position: DVec3,
    normal: DVec3,
) -> (f64, f64, Vec<DVec3>) {
    let lights =
        Lights::new(&Geometry::build(Primitives::default()), (&[], &[]), &Environment::Black, &[light], 0.1);
    let receiver = Receiver { position, normal, grazing: 0.0, both_sides: false, on: PrimitiveId::NONE };
    let (mut sum, mut grain, mut directions): (f64, f64, Vec<DVec3>) = (0.0, 0.0, Vec::new());
    for i in 0..CHOICES {
        let u = (i as f64 + 0.5) / CHOICES as f64;
        let Some(sample) = sampler.sample(&lights, &receiver, [0.5, u]) else { continue };
        let Incoming::Irradiance(irradiance) = sample.light else { panic!("{:?}", sample.light) };
        sum += f64::from(irradiance.x) / CHOICES as f64;
        if irradiance.x > 0.0 && !directions.iter().any(|known| known.distance(sample.direction) < 1e-3) {
            directions.push(sample.direction);
            grain += f64::from(irradiance.x) / CHOICES as f64;
        }
    }
    (sum, grain, directions)
}

#[test]
fn lights_without_spin_are_those_around_schwarzschilds_hole() {
    let mut random = Random::new(11);
    let (mut worst, mut dark) = (0.0_f64, 0);
    for number in 0..30 {
        let r_s = random.log_between(0.5, 3.0);
        let isotropic = |random: &mut Random| r_s * random.log_between(1.5, 15.0) * random.direction();
        // Areal radius of the chart without spin.
        let areal = |x: DVec3| x * (1.0 + 0.25 * r_s / x.length()).powi(2);
        let (position, place) = (isotropic(&mut random), isotropic(&mut random));
        let intensity = Vec3::splat(3.0);
        let direction = random.direction();
        let at = |position: DVec3| match number % 3 {
            0 => Punctual::Point { position, intensity },
            1 => Punctual::Spot { position, direction, intensity, cos_inner: 0.6, cos_outer: -0.2 },
            _ => Punctual::Distant { direction, irradiance: intensity },
        };
        let normal = position.normalize();
        let lensed = Lensed::new(Schwarzschild::new(r_s), DVec3::ZERO, 1).expect("a photon sphere");
        let (wanted, grain, exact) = light(&lensed, at(place), position, normal);
        let kerr = spinning(r_s, 0.0, random.direction());
        let (found, _, directions) = light(&kerr, at(areal(place)), areal(position), normal);
        assert_eq!(directions.len(), exact.len(), "{number}: {directions:?} for {exact:?}");
        for direction in &directions {
            let off = exact.iter().map(|one| one.distance(*direction)).fold(f64::INFINITY, f64::min);
            assert!(off < 1e-4, "{number}: {direction} of {exact:?}");
        }
        let off = (found - wanted).abs() - 2.0 * grain;
        assert!(off <= 1e-4 * wanted, "{number}: {found} for {wanted}");
        worst = worst.max(off / wanted.max(1e-9));
        dark += usize::from(wanted == 0.0);
    }
    println!("worst irradiance {worst:.1e}, {dark} dark");
    assert!(dark < 10);
}

#[test]
fn far_from_a_spinning_hole_a_distant_light_is_that_of_flat_space() {
    let sampler = spinning(1.0, 0.9, DVec3::new(1.0, 2.0, 2.0) / 3.0);
    let mut random = Random::new(5);
    for _ in 0..20 {
        let position = 1e7 * random.direction();
        let direction = random.direction();
        // The hole shifts what is behind it.
        if direction.dot(position) > 0.9 * position.length() {
            continue;
        }
        let distant = Punctual::Distant { direction, irradiance: Vec3::splat(2.0) };
        let (irradiance, _, directions) = light(&sampler, distant, position, -direction);
        assert!(directions[0].distance(-direction) < 1e-5, "{} for {}", directions[0], -direction);
        assert!((irradiance / 2.0 - 1.0).abs() < 2e-3, "{irradiance}");
    }
}

/// A floor and a wall beside a hole of mass ½ that spins, lit by what `lamp` adds. All that the camera sees is floor, so
/// that no lamp is seen itself.
fn stage(lamp: &str, files: &[(&str, &str)]) -> Baked {
    let text = "[spacetime]\nkind = \"kerr\"\nschwarzschild_radius = 1\nspin = 0.9\naxis = [1, 3, 1]\n"
        .to_owned()
        + &camera(DVec3::new(0.0, -1.2, 4.0), DVec3::new(0.0, -2.5, 3.9), 80.0)
        + &film(8, 6)
        + "[render]\nmax_depth = 2\nroulette_depth = 2\n"
        + &material("white", 0.8, 0.0)
        + &mesh("floor.obj", DVec3::new(0.0, -2.5, 0.0), "white")
        + &mesh("wall.obj", DVec3::new(0.0, 0.0, -4.0), "white")
        + lamp;
    let floor = rectangle(DVec3::ZERO, 6.0 * DVec3::Z, 6.0 * DVec3::X);
    let wall = rectangle(DVec3::ZERO, 6.0 * DVec3::X, 4.0 * DVec3::Y);
    scene_with(&text, &[files, &[("floor.obj", floor.as_str()), ("wall.obj", wall.as_str())]].concat())
}

/// A polyhedron about `place` that an observer at rest there sees as a ball of radius 1: its corners in the chart, with
/// its faces, and the mean of its cross-sections at rest.
fn ball(place: DVec3, radius: f64, scene: &Baked) -> (String, f64) {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    let (rows, columns) = (8, 16);
    for row in 0..=rows {
        for column in 0..columns {
            let (polar, azimuth) = (PI * row as f64 / rows as f64, 2.0 * PI * column as f64 / columns as f64);
            corners.push(DVec3::new(polar.sin() * azimuth.cos(), polar.cos(), polar.sin() * azimuth.sin()));
        }
    }
    let corner = |row: usize, column: usize| row * columns + column % columns;
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [corner(row, column), corner(row, column + 1)];
            let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
            if row > 0 {
                faces.push([a, b, d]);
            }
            if row + 1 < rows {
                faces.push([a, d, c]);
            }
        }
    }
    // Cauchy: a quarter of the surface.
    let area =
        |[a, b, c]: &[usize; 3]| 0.5 * (corners[*b] - corners[*a]).cross(corners[*c] - corners[*a]).length();
    let section = 0.25 * radius * radius * faces.iter().map(area).sum::<f64>();
    // The frame at rest is stretched along one direction: lengths of the chart are shorter there.
    let SpacetimeKind::Spinning { placement, hole } = scene.spacetime else { unreachable!() };
    let stretched = |v: DVec3| {
        let rotation = placement.rotation();
        let (n, potential) = hole.outgoing(rotation * (place - placement.center));
        let n = rotation.transpose() * n;
        v - (1.0 - (1.0 - potential).sqrt()) * n.dot(v) * n
    };
    let corners: Vec<DVec3> = corners.iter().map(|corner| radius * stretched(*corner)).collect();
    (obj(&corners, &faces), section)
}

#[test]
fn a_point_light_beside_a_spinning_hole_is_a_small_ball() {
    for (number, place) in
        [DVec3::new(2.5, 1.5, 1.0), DVec3::new(-3.0, 2.0, -1.0), DVec3::new(-0.5, 1.5, -3.0)]
            .into_iter()
            .enumerate()
    {
        let point = format!(
            "[[entity]]\nlight = {{ kind = \"point\", position = {:?}, intensity = [5, 5, 5] }}\n",
            place.to_array()
        );
        let mut lit = stage(&point, &[]);
        let (corners, section) = ball(place, 0.2, &lit);
        let lamp = material("lamp", 0.0, 5.0 / section) + &mesh("ball.obj", place, "lamp");
        let mut small = stage(&lamp, &[("ball.obj", &corners)]);
        let with = picture(&mut lit, Geodesic, 256, 2 * number as u64);
        let without = picture(&mut small, Geodesic, 12288, 2 * number as u64 + 1);
        Agreement::of(&with, &without).check(&format!("light at {place}"));
    }
}
