//! Whatever is sampled has the density that is said of it: lobes, emitters, skies, the choice of lights, learnt
//! directions, filters of pixels.

use std::f64::consts::PI;

use crate::support::chi_square::{Directions, Space, Verdict, probability};
use crate::support::{Random, camera, hole, material, mesh, rectangle, render, scene_with, sphere};
use glam::{DMat3, DVec2, DVec3, Vec3};
use warpfront::film::Aov;
use warpfront::geometry::{Disk, PrimitiveId, Shape, Sphere};
use warpfront::light::{
    Approach, Cap, Emission, Emitter, EmitterHit, Form, Guide, Incoming, Lensed, LightRayEnd, LightSampler,
    Lights, LitSide, Photon, Receiver, Sky, StraightAim, Target, Tree, View,
};
use warpfront::scene::Baked;

use warpfront::shade::{
    Dielectric, Diffuse, Environment, Incidence, InterfaceCrossing, Lacquered, LatLong, Lobe, Material,
    Media, Mirror, Principled, Sampler, fresnel, relative_index,
};
use warpfront::trace::transport::{Landing, Outcome};
use warpfront::trace::{Ray, Run, shoot};

/// Samples of a test.
const COUNT: usize = 200_000;

fn numbers<const N: usize>(random: &mut Random) -> [f64; N] {
    [0; N].map(|_| random.between(0.0, 1.0))
}

/// Direction of a bounce; `None` if the path is absorbed.
fn bounce(lobe: &Lobe, incidence: &Incidence, random: &mut Random) -> Option<DVec3> {
    let bounce = lobe.sample(incidence, numbers(random).map(|u: f64| u as f32));
    (bounce.weight != Vec3::ZERO).then_some(bounce.direction)
}

/// Direction of a bounce that is one of many.
fn spread(lobe: &Lobe, incidence: &Incidence, random: &mut Random) -> Option<DVec3> {
    let bounce = lobe.sample(incidence, numbers(random).map(|u: f64| u as f32));
    (bounce.weight != Vec3::ZERO && bounce.density > 0.0).then_some(bounce.direction)
}

/// One material for each kind of lobe.
fn lobes() -> Vec<Material> {
    let all = [
        Lobe::Diffuse(Diffuse { albedo: Vec3::new(0.9, 0.5, 0.1) }),
        Lobe::Mirror(Mirror { reflectance: Vec3::splat(0.9) }),
        Lobe::Dielectric(Dielectric { ior: 1.5, tint: Vec3::ONE }),
        Lobe::Principled(Principled { metallic: 1.0, roughness: 0.4, anisotropy: 0.5, ..Principled::PLAIN }),
        Lobe::Principled(Principled { roughness: 0.5, iridescence: 0.5, ..Principled::PLAIN }),
        Lobe::Principled(Principled {
            roughness: 0.6,
            transmission: 1.0,
            is_thin: false,
            ..Principled::PLAIN
        }),
        Lobe::Principled(Principled {
            roughness: 0.5,
            transmission: 0.6,
            metallic: 0.2,
            ..Principled::PLAIN
        }),
        Lobe::Principled(Principled {
            clearcoat: 0.8,
            clearcoat_roughness: 0.4,
            sheen_color: Vec3::new(1.0, 0.5, 0.2),
            sheen_roughness: 0.5,
            ..Principled::PLAIN
        }),
        // A smooth coat over a rough base: the density is that of the base.
        Lobe::Principled(Principled { clearcoat: 1.0, ..Principled::PLAIN }),
        Lobe::Lacquered(Lacquered {
            principled: Principled { clearcoat: 1.0, clearcoat_roughness: 0.4, ..Principled::PLAIN },
            clearcoat_normal: DVec3::new(0.6, 0.0, 0.8),
        }),
        Lobe::Lacquered(Lacquered {
            principled: Principled {
                clearcoat: 1.0,
                clearcoat_roughness: 0.5,
                transmission: 1.0,
                roughness: 0.5,
                ..Principled::PLAIN
            },
            clearcoat_normal: DVec3::new(0.0, 0.6, 0.8),
        }),
    ];
    // A new kind of lobe does not compile until it is in the list.
    for lobe in all {
        match lobe {
            Lobe::Diffuse(Diffuse { .. })
            | Lobe::Mirror(Mirror { .. })
            | Lobe::Dielectric(Dielectric { .. })
            | Lobe::Principled(Principled { .. })
            | Lobe::Lacquered(Lacquered { .. }) => {}
        }
    }
    all.map(|lobe| Material { lobe, ..Material::default() }).to_vec()
}

fn incidence(random: &mut Random, material: usize) -> Incidence {
    let normal = random.direction();
    let shading_normal = (normal + 0.8 * random.in_cube()).normalize();
    let direction = random.direction();
    let enters = direction.dot(normal) < 0.0;
    let crossing = InterfaceCrossing::of(Media::VACUUM, std::iter::once((material as u32, enters)));
    Incidence::new(direction, normal, shading_normal, relative_index(&lobes(), &crossing))
}

#[test]
fn lobes_scatter_with_the_density_that_they_evaluate_to() {
    let (materials, mut random, mut verdict) = (lobes(), Random::new(1), Verdict::default());
    for (index, Material { lobe, .. }) in materials.iter().enumerate() {
        for number in 0..6 {
            let incidence = incidence(&mut random, index);
            if lobe.is_specular() {
                continue;
            }
            let samples: Vec<_> = (0..COUNT).map(|_| spread(lobe, &incidence, &mut random)).collect();
            let density = |out| lobe.evaluate(&incidence, out).density;
            let directions = Directions::even(incidence.shading_normal);
            verdict.add(format!("lobe {index}, {number}"), directions.probability(samples, density));
        }
    }
    verdict.check();
}

#[test]
fn glass_reflects_as_often_as_fresnel_says() {
    let (materials, mut random, mut verdict) = (lobes(), Random::new(2), Verdict::default());
    let glass = materials.iter().position(|m| matches!(m.lobe, Lobe::Dielectric(Dielectric { .. }))).unwrap();
    for number in 0..40 {
        let mut incidence = incidence(&mut random, glass);
        incidence.shading_normal = incidence.normal;
        let cos = -incidence.direction.dot(incidence.normal);
        let reflectance = fresnel(incidence.eta, cos);
        let count = COUNT / 10;
        let reflected = (0..count).filter(|_| {
            let direction = bounce(&materials[glass].lobe, &incidence, &mut random).unwrap();
            direction.dot(incidence.normal) > 0.0
        });
        let reflected = reflected.count() as f64;
        let (count, expected) = (count as f64, reflectance * count as f64);
        let rest = [reflected, count - reflected];
        verdict.add(format!("{number}: cos {cos}"), probability(&rest, &[expected, count - expected]));
    }
    verdict.check();
}

/// Half-angle of the caps.
const CAP: f64 = 2.0;

/// Normals of a sphere's points as a square without edges of the density across its cells.
fn around(form: &Form, view: &View) -> Directions {
    match (form, *view) {
        (Form::Cap(_, cap), _) => {
            Directions { reach: libm::sin(0.5 * CAP).powi(2), ..Directions::even(cap.axis) }
        }
        (Form::Whole(Shape::Sphere(ball)), View::Outside(Approach { direction, distance, .. })) => {
            // From close by, most of what is seen is close by.
            let excess = distance / ball.radius - 1.0;
            Directions { near: 0.25 * excess * excess, ..Directions::even(-direction) }
        }
        _ => Directions::even(DVec3::Z),
    }
}

/// The probability of points of an emitter under its density over the area.
fn of_emitter(form: Form, view: &View, random: &mut Random) -> f64 {
    let emitter =
        Emitter { primitive: PrimitiveId::NONE, form, radiance: Vec3::ONE, varies: false, both_sides: true };
    let samples: Vec<_> = (0..COUNT)
        .map(|_| {
            let [u, v] = numbers(random);
            emitter.sample(view, u, v)
        })
        .collect();
    for spot in samples.iter().flatten().take(100) {
        let density = emitter.density(view, spot.position, spot.normal);
        assert!((spot.density / density - 1.0).abs() < 1e-9, "{} is not {density}", spot.density);
    }
    match form {
        Form::Whole(Shape::Sphere(ball)) | Form::Cap(ball, _) => {
            let directions = around(&form, view);
            let density = |normal| {
                emitter.density(view, ball.center + ball.radius * normal, normal) * ball.radius * ball.radius
            };
            directions.probability(samples.into_iter().map(|spot| spot.map(|spot| spot.normal)), density)
        }
        Form::Whole(Shape::Disk(disk)) => {
            let (t, s) = warpfront::math::frame::tangents(disk.normal);
            let (inner2, outer2) = (disk.inner * disk.inner, disk.outer * disk.outer);
            let place = |p: DVec3| {
                let offset = DVec2::new((p - disk.center).dot(t), (p - disk.center).dot(s));
                let azimuth = libm::atan2(offset.y, offset.x) / (2.0 * PI);
                [(offset.length_squared() - inner2) / (outer2 - inner2), azimuth.rem_euclid(1.0)]
            };
            let space = Space { place: &place, at: &|_| disk.center, measure: PI * (outer2 - inner2) };
            let points = samples.into_iter().map(|spot| spot.map(|spot| spot.position));
            space.probability(points, |_| emitter.density(view, disk.center, disk.normal))
        }
        Form::Whole(Shape::Triangle([a, b, c])) => {
            let across = (b - a).cross(c - a);
            let place = |p: DVec3| {
                let part = |u: DVec3, v: DVec3| u.cross(v).dot(across) / across.length_squared();
                let (at_b, at_c) = (part(p - a, c - a), part(b - a, p - a));
                // The part of the triangle that is nearer to a, and how far along from b to c.
                let near = at_b + at_c;
                [near * near, if near > 0.0 { at_c / near } else { 0.0 }]
            };
            let at = |[square, along]: [f64; 2]| {
                let near = square.sqrt();
                a + near * ((1.0 - along) * (b - a) + along * (c - a))
            };
            let space = Space { place: &place, at: &at, measure: 0.5 * across.length() };
            let points = samples.into_iter().map(|spot| spot.map(|spot| spot.position));
            space.probability(points, |position| emitter.density(view, position, across.normalize()))
        }
    }
}

#[test]
fn points_of_emitters_have_the_density_that_is_said_of_them() {
    let (mut random, mut verdict) = (Random::new(3), Verdict::default());
    for number in 0..4 {
        let radius = random.log_between(1e-3, 1e6);
        let ball = Sphere { center: radius * random.in_cube(), radius };
        let whole = Form::Whole(Shape::Sphere(ball));
        verdict
            .add(format!("sphere from inside {number}"), of_emitter(whole, &View::Everywhere, &mut random));
        for is_exact in [true, false] {
            let distance = radius * (1.0 + random.log_between(1e-2, 1e2));
            let view = View::Outside(Approach { distance, direction: random.direction(), is_exact });
            let what = format!("sphere from outside {number}, at {distance} of {radius}, exact {is_exact}");
            verdict.add(what, of_emitter(whole, &view, &mut random));
        }
        let cap = Form::Cap(ball, Cap::new(random.direction(), CAP));
        verdict.add(format!("cap {number}"), of_emitter(cap, &View::Everywhere, &mut random));
        let outer = random.log_between(1e-3, 1e3);
        let inner = if number % 2 == 0 { 0.0 } else { 0.7 * outer };
        let disk = Disk { center: random.in_cube(), normal: random.direction(), inner, outer };
        let disk = Form::Whole(Shape::Disk(disk));
        verdict.add(format!("disk {number}"), of_emitter(disk, &View::Everywhere, &mut random));
        let corners = [0; 3].map(|_| radius * random.in_cube());
        let triangle = Form::Whole(Shape::Triangle(corners));
        verdict.add(format!("triangle {number}"), of_emitter(triangle, &View::Everywhere, &mut random));
        let [a, b, c] = corners;
        let height = random.log_between(0.2, 2.0) * ((b - a).cross(c - a).length()).sqrt();
        let x = (a + b + c) / 3.0 + height * (b - a).cross(c - a).normalize() + 0.1 * (b - a);
        let what = format!("triangle {number} from {height}");
        verdict.add(what, of_emitter(triangle, &View::Straight(x), &mut random));
    }
    verdict.check();
}

/// A picture of the sky: dark but for some pixels, and turned if it is not to lie along the cells of the test.
fn picture(random: &mut Random, width: usize, height: usize, from_world: DMat3) -> LatLong {
    let mut pixel =
        || if random.between(0.0, 1.0) < 0.6 { 0.05 } else { random.log_between(0.1, 10.0) as f32 };
    let pixels = (0..width * height).map(|_| Vec3::splat(pixel())).collect();
    LatLong { width, height, pixels, from_world }
}

#[test]
fn directions_of_skies_have_the_density_that_is_said_of_them() {
    let (mut random, mut verdict) = (Random::new(4), Verdict::default());
    // Edges of pixels are edges of cells.
    for (width, height) in [(1, 1), (2, 1), (4, 3), (16, 8), (48, 24)] {
        for from_world in [DMat3::IDENTITY, DMat3::from_rotation_y(0.7)] {
            let image = picture(&mut random, width, height, from_world);
            let sky = Sky::new(&image).unwrap();
            let samples: Vec<_> = (0..COUNT)
                .map(|_| {
                    let [u, v] = numbers(&mut random);
                    sky.sample(u, v).map(|drawn| (from_world * drawn.direction, drawn.density))
                })
                .collect();
            // In the picture, by columns and rows; of solid angle there is sin θ there.
            let density = |(d, _): (DVec3, f64)| {
                sky.density(from_world.transpose() * d) * (d.x * d.x + d.z * d.z).sqrt()
            };
            let wrong = samples.iter().flatten().filter(|(d, said)| {
                let again = sky.density(from_world.transpose() * *d);
                (said / again - 1.0).abs() > 1e-6
            });
            // At the edge of a pixel rounding may choose its neighbour.
            let wrong = wrong.count();
            assert!(wrong < 10, "{wrong} densities are not those of their directions");
            let space = Space {
                place: &|(d, _): (DVec3, f64)| {
                    [0.5 + libm::atan2(d.x, -d.z) / (2.0 * PI), libm::acos(d.y) / PI]
                },
                at: &|[u, v]| {
                    let ((sin, cos), longitude) = (libm::sincos(PI * v), 2.0 * PI * (u - 0.5));
                    let (across, along) = libm::sincos(longitude);
                    (DVec3::new(sin * across, cos, -sin * along), 0.0)
                },
                measure: 2.0 * PI * PI,
            };
            verdict.add(format!("{width} × {height}"), space.probability(samples, density));
        }
    }
    verdict.check();
}

#[test]
fn skies_that_are_not_pictures_are_left_to_chance() {
    let sky = Environment::Gradient { ground: Vec3::ONE, horizon: Vec3::ONE, zenith: Vec3::ONE };
    let dark = scene_with(
        &(camera(DVec3::ZERO, DVec3::X, 40.0) + &material("dark", 0.5, 0.0) + &sphere(DVec3::X, 0.1, "dark")),
        &[],
    );
    for environment in [Environment::Black, Environment::Constant(Vec3::ONE), sky] {
        assert!(!Lights::new(&dark.geometry, (&dark.materials, &[]), &environment, &[], 0.0).has_sky());
    }
}

fn emissions(random: &mut Random, count: usize) -> Vec<Emission> {
    let emission = |random: &mut Random| {
        let (min, size) = (5.0 * random.in_cube(), random.log_between(1e-3, 1.0));
        Emission {
            min,
            max: min + size * (random.in_cube() + 1.0),
            power: random.log_between(0.01, 10.0),
            axis: random.direction(),
            cos_normals: if random.between(0.0, 1.0) < 0.3 { -1.0 } else { 1.0 },
            cos_emission: 0.0,
            both_sides: random.between(0.0, 1.0) < 0.3,
        }
    };
    (0..count).map(|_| emission(random)).collect()
}

#[test]
fn lights_are_chosen_with_the_probability_that_is_said_of_them() {
    let (mut random, mut verdict) = (Random::new(5), Verdict::default());
    for number in 0..12 {
        let count = [1, 2, 3, 20, 300][number % 5];
        let emissions = emissions(&mut random, count);
        let floor = if number % 2 == 0 { 0.0 } else { 0.1 };
        let tree = Tree::build(count as u32, |index| emissions[index as usize], floor);
        let x = 8.0 * random.in_cube();
        let grazing = if number % 4 < 2 { 0.0 } else { 0.3 };
        let side = (number % 3 > 0).then(|| LitSide { normal: random.direction(), grazing });
        let mut counts = vec![0.0; count + 1];
        for _ in 0..COUNT {
            let [u] = numbers(&mut random);
            let index = match tree.sample(x, side, u) {
                Some((index, chance, _)) => {
                    assert_eq!(chance, tree.probability(index, x, side));
                    index as usize
                }
                None => count,
            };
            counts[index] += 1.0;
        }
        let chances = (0..count as u32).map(|index| tree.probability(index, x, side));
        let mut expected: Vec<f64> = chances.map(|chance| chance * COUNT as f64).collect();
        expected.push((COUNT as f64 - expected.iter().sum::<f64>()).max(0.0));
        verdict.add(format!("{count} lights, {number}"), probability(&counts, &expected));
    }
    verdict.check();
}

#[test]
fn learnt_directions_have_the_density_that_is_said_of_them() {
    let (mut random, mut verdict) = (Random::new(6), Verdict::default());
    for number in 0..12 {
        let spread = [0.02, 0.2, 0.6, 1.5][number % 4];
        let axis = random.direction();
        // From two directions by each way.
        let apart = if number < 8 { DVec3::ZERO } else { random.direction() };
        let photons: Vec<Photon> = (0..90)
            .map(|index| Photon {
                side: warpfront::spacetime::Side::Near,
                position: random.in_cube() * DVec3::new(1.0, 1.0, 0.01),
                normal: DVec3::Z,
                direction: (axis + f64::from(index as u32 % 2) * apart + spread * random.in_cube())
                    .normalize(),
                way: Some(index % 3),
            })
            .collect();
        let guide = Guide::new(&photons, 1.0).unwrap();
        let x = 0.5 * random.in_cube() * DVec3::new(1.0, 1.0, 0.0);
        let around = guide.around(x).unwrap();
        let samples: Vec<_> = (0..COUNT).map(|_| Some(around.sample(x, numbers(&mut random))?.0)).collect();
        let directions = Directions { near: 0.5 * spread * spread, ..Directions::even(axis) };
        let density = |direction| around.density(x, direction);
        verdict.add(format!("{number}, spread {spread}"), directions.probability(samples, density));
    }
    verdict.check();
}

#[test]
fn light_that_came_one_way_from_two_directions_is_looked_for_in_both() {
    let mut random = Random::new(7);
    let direction = |x: f64| DVec3::new(x, 0.0, 1.0).normalize();
    let photons: Vec<Photon> = (0..60)
        .map(|index| Photon {
            side: warpfront::spacetime::Side::Near,
            position: random.in_cube() * DVec3::new(1.0, 1.0, 0.0),
            normal: DVec3::Z,
            direction: (direction([-0.5, 0.5][index % 2]) + 0.02 * random.in_cube()).normalize(),
            way: Some(1),
        })
        .collect();
    let guide = Guide::new(&photons, 1.0).unwrap();
    let around = guide.around(DVec3::ZERO).unwrap();
    let [left, middle, right] = [-0.5, 0.0, 0.5].map(|x| around.density(DVec3::ZERO, direction(x)));
    assert!(left.min(right) > 1e3 * middle, "{left} {middle} {right}");
}

/// Where in its pixel each sample of a picture is, in pixels from the middle: from the places that rays meet on a wall.
fn film_points(filter: &str, sampler: &str) -> Vec<[f64; 2]> {
    const SIDE: usize = 300;
    let text = "[camera]\nposition = [0, 0, 1]\ndirection = [0, 0, -1]\nvertical_fov = 90\n".to_owned()
        + &format!("[film]\nwidth = {SIDE}\nheight = {SIDE}\nfilter = \"{filter}\"\n")
        + &format!("[render]\nspp = 1\nmax_depth = 1\nsampler = \"{sampler}\"\n")
        + &material("wall", 0.5, 0.0)
        + &mesh("wall.obj", DVec3::ZERO, "wall");
    let wall = rectangle(DVec3::ZERO, 9.0 * DVec3::X, 9.0 * DVec3::Y);
    let run = Run { aovs: vec![Aov::Position], ..Run::default() };
    let image = render(&scene_with(&text, &[("wall.obj", &wall)]), &run).image;
    let planes = ["position.X", "position.Y"].map(|name| image.channel(name).unwrap());
    let half = 0.5 * SIDE as f64;
    let point = |index: usize| {
        let (column, row) = ((index % SIDE) as f64 + 0.5, (index / SIDE) as f64 + 0.5);
        let [x, y] = planes.map(|plane| f64::from(plane[index]) * half);
        [x + half - column, half - y - row]
    };
    (0..SIDE * SIDE).map(point).collect()
}

#[test]
fn film_points_have_the_density_of_their_filter() {
    let mut verdict = Verdict::default();
    for sampler in ["sobol", "independent"] {
        for (filter, reach) in [("box", 0.5), ("tent", 1.0)] {
            let density = |[x, y]: [f64; 2]| match filter {
                "box" => 1.0,
                _ => (1.0 - x.abs()) * (1.0 - y.abs()),
            };
            let place = |point: [f64; 2]| point.map(|x| (x / reach + 1.0) / 2.0);
            let at = |place: [f64; 2]| place.map(|x| (2.0 * x - 1.0) * reach);
            let space = Space { place: &place, at: &at, measure: 4.0 * reach * reach };
            let points = film_points(filter, sampler).into_iter().map(Some);
            verdict.add(format!("{filter}, {sampler}"), space.probability(points, density));
        }
    }
    verdict.check();
}

#[test]
fn random_numbers_are_even_in_every_pair_of_dimensions() {
    let mut verdict = Verdict::default();
    for (sampler, name) in [(Sampler::sobol(3), "sobol"), (Sampler::independent(3), "independent")] {
        for [a, b] in [[0, 1], [0, 2], [1, 3], [2, 3]] {
            let key = |pixel| warpfront::shade::Key { pixel, sample: 5, set: 7 };
            let pairs = (0..COUNT as u32).map(|pixel| {
                let four: [f32; 4] = sampler.point(key(pixel));
                Some([four[a], four[b]].map(f64::from))
            });
            let space = Space { place: &|pair: [f64; 2]| pair, at: &|place| place, measure: 1.0 };
            verdict.add(format!("{name} {a} {b}"), space.probability(pairs, |_| 1.0));
        }
    }
    verdict.check();
}

/// Three lights of different shape and a picture of the sky, around a floor that they light.
fn lit_scene(random: &mut Random, r_s: f64) -> Baked {
    let text = if r_s > 0.0 { hole(DVec3::new(0.0, 2.0, 0.0), r_s) } else { String::new() }
        + &camera(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, 60.0)
        + &material("floor", 0.5, 0.0)
        + &material("light", 0.5, 1.0)
        + &sphere(DVec3::new(1.5, 1.5, 1.0), 0.8, "light")
        + &mesh("lamp.obj", DVec3::ZERO, "light")
        + "[[entity]]\ndisk = { center = [-2, 3, 1], normal = [0.3, -1, 0], outer = 1.5 }\nmaterial = \"light\"\n"
        + "[[entity]]\ndisk = { center = [0, 0, 0], normal = [0, 1, 0], outer = 20 }\nmaterial = \"floor\"\n";
    let lamp = rectangle(DVec3::new(0.0, 2.5, -3.0), 2.0 * DVec3::X, 1.5 * DVec3::Y);
    let mut scene = scene_with(&text, &[("lamp.obj", &lamp)]);
    scene.environment = Environment::Image(picture(random, 8, 4, DMat3::IDENTITY));
    scene
}

#[test]
fn light_samples_have_the_density_in_solid_angle_that_mis_asks_for() {
    let (mut random, mut verdict) = (Random::new(7), Verdict::default());
    for r_s in [0.0, 0.6] {
        let scene = lit_scene(&mut random, r_s);
        let (sampler, floor): (Box<dyn LightSampler>, f64) = match scene.spacetime.medium() {
            Some((center, metric)) => (Box::new(Lensed::new(metric, center, 1).unwrap()), 0.1),
            None => (Box::new(StraightAim), 0.0),
        };
        let Baked { geometry, materials, environment, punctual, .. } = &scene;
        let lights = Lights::new(geometry, (materials, &[]), environment, punctual, floor);
        let floor = geometry.shapes(|_| true).into_iter().rev();
        let on = floor.map(|(primitive, ..)| primitive).next().unwrap();
        let position = DVec3::new(0.4, 0.0, 0.3);
        let receiver = Receiver { position, normal: DVec3::Y, grazing: 0.0, both_sides: false, on };
        let follow = |directions: Vec<DVec3>| {
            let ray = |direction| Ray { position, direction, origin_prim: on };
            shoot(&scene, &directions.into_iter().map(ray).collect::<Vec<_>>())
        };
        let chosen: Vec<_> =
            (0..COUNT).map(|_| sampler.sample(&lights, &receiver, numbers(&mut random))).collect();
        let directions = chosen.iter().map(|sample| sample.map_or(DVec3::Y, |sample| sample.direction));
        let samples = chosen.iter().zip(follow(directions.collect())).map(|(sample, shot)| {
            let sample = sample.as_ref()?;
            assert!(matches!(sample.light, Incoming::Radiance(..) | Incoming::Sky(..)));
            let met = match (sample.target, shot.end) {
                (target, Outcome::Landed(landing)) => {
                    let Landing { primitive, position, direction, .. } = landing;
                    sampler.reaches(&lights, target, &LightRayEnd { primitive, position, direction })
                }
                (Target::Infinity(_), Outcome::Escaped(_)) => true,
                _ => false,
            };
            met.then_some((sample.direction, 0.0))
        });
        let samples: Vec<_> = samples.collect();

        let density = |direction: DVec3, end: &Outcome<_>| match end {
            Outcome::Landed(landing) => {
                let front = geometry.surface_point(landing.primitive, landing.position).normal;
                let Landing { primitive, position, direction: arrival, .. } = *landing;
                let hit = EmitterHit { primitive, position, normal: front, arrival };
                sampler.surface_density(&lights, &receiver, direction, &hit)
            }
            Outcome::Escaped(to) => sampler.sky_density(&lights, &receiver, direction, *to),
            _ => 0.0,
        };
        // Where rays end is found for all places of all cells at once.
        let (cells, side) = (
            Directions::even(DVec3::Y),
            crate::support::chi_square::CELLS * crate::support::chi_square::FINE,
        );
        let places: Vec<DVec3> = (0..side * side)
            .map(|index| cells.at([index % side, index / side].map(|i| (i as f64 + 0.5) / side as f64)).0)
            .collect();
        let ends = follow(places.clone());
        let space = Space {
            place: &|(direction, _)| cells.place(direction),
            at: &|place| {
                let [x, y] = place.map(|u| (u * side as f64) as usize);
                let index = y * side + x;
                (places[index], density(places[index], &ends[index].end))
            },
            measure: 4.0 * PI,
        };
        verdict.add(format!("r_s {r_s}"), space.probability(samples, |(_, density)| density));
    }
    verdict.check();
}

#[test]
fn a_density_that_is_a_few_percent_off_is_rejected() {
    let (materials, mut random) = (lobes(), Random::new(8));
    let incidence = incidence(&mut random, 0);
    let (lobe, axis) = (&materials[0].lobe, incidence.shading_normal);
    let samples: Vec<_> = (0..COUNT).map(|_| bounce(lobe, &incidence, &mut random)).collect();
    let across = axis.any_orthonormal_vector();
    for wrong in [0.08, -0.08] {
        let density = |out: DVec3| lobe.evaluate(&incidence, out).density * (1.0 + wrong * out.dot(across));
        let mut verdict = Verdict::default();
        verdict.add("wrong", Directions::even(axis).probability(samples.iter().copied(), density));
        assert!(verdict.corrected() < 1e-6, "{wrong}: {}", verdict.corrected());
    }
}

#[test]
fn a_choice_that_is_one_percent_off_is_rejected() {
    let expected = [30_000.0, 70_000.0, 100_000.0];
    assert!(probability(&[30_100.0, 69_900.0, 100_000.0], &expected) > 0.1);
    assert!(probability(&[31_000.0, 69_000.0, 100_000.0], &expected) < 1e-6);
}
