//! Geometry at its most awkward: edges, vertices, tangents, slivers, places far from the origin, walls at the horizon.

use crate::support::{Random, hole, material, mesh, obj, scene, scene_with, sphere};
use glam::DVec3;
use warpfront::geometry::PrimitiveId;
use warpfront::scene::Baked;
use warpfront::trace::transport::Outcome;
use warpfront::trace::{Ray, Shot, shoot};

fn ray(position: DVec3, direction: DVec3) -> Ray {
    Ray { position, direction: direction.normalize(), origin_prim: PrimitiveId::NONE }
}

fn follow(scene: &Baked, position: DVec3, direction: DVec3) -> Shot {
    shoot(scene, &[ray(position, direction)])[0]
}

/// Where a ray lands; it must.
fn landing(scene: &Baked, position: DVec3, direction: DVec3) -> DVec3 {
    let shot = follow(scene, position, direction);
    let Outcome::Landed(landing) = shot.end else { panic!("from {position} to {direction}: {shot:?}") };
    landing.position
}

/// A closed octahedron around the origin, each face cut into `n`² triangles.
fn octahedron(n: usize, radius: f64) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let mut index = std::collections::BTreeMap::new();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for signs in 0..8 {
        let sign = |bit: usize| if signs >> bit & 1 == 0 { 1i64 } else { -1 };
        let mut vertex = |i: usize, j: usize| {
            let corner = [i as i64 * sign(0), j as i64 * sign(1), (n - i - j) as i64 * sign(2)];
            *index.entry(corner).or_insert_with(|| {
                positions.push(DVec3::from(corner.map(|c| c as f64 / n as f64 * radius)));
                positions.len() - 1
            })
        };
        for i in 0..n {
            for j in 0..n - i {
                triangles.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < n {
                    triangles.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
    }
    (positions, triangles)
}

#[test]
fn radial_rays_at_the_vertices_and_edges_of_a_closed_mesh_around_a_hole_hit_it() {
    let (positions, triangles) = octahedron(12, 8.0);
    let file = obj(&positions, &triangles);
    for r_s in [0.0, 1e-9, 1.0] {
        let text =
            hole(DVec3::ZERO, r_s) + &material("black", 0.0, 0.0) + &mesh("shell.obj", DVec3::ZERO, "black");
        let scene = scene_with(&text, &[("shell.obj", &file)]);
        let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let middles = edges.map(|[a, b]| 0.5 * (positions[a] + positions[b]));
        for target in positions.iter().copied().chain(middles) {
            // The mesh is stored in 32 bits.
            let outwards = landing(&scene, 0.5 * target.normalize(), target);
            assert!(outwards.distance(target) < 1e-5, "r_s = {r_s}: {outwards} for {target}");
            let inwards = landing(&scene, 3.0 * target, -target);
            assert!(inwards.distance(target) < 1e-5, "r_s = {r_s}: {inwards} for {target}");
        }
    }
}

#[test]
fn a_ray_within_rounding_of_the_tangent_of_a_sphere_hits_or_passes_and_is_never_lost() {
    for r_s in [0.0, 0.5] {
        // A ray that passes the hole has its periastron at the tangent point of a concentric sphere.
        let radius = 4.0;
        let text = hole(DVec3::ZERO, r_s)
            + "[environment]\ncolor = [1, 1, 1]\n"
            + "[render]\nstepper = \"dop853\"\ntolerance = 1e-13\narc_tolerance = 1e-9\n"
            + &material("black", 0.0, 0.0)
            + &sphere(DVec3::ZERO, radius, "black");
        let scene = scene(&text);
        let index = |rho: f64| (1.0 + 0.25 * r_s / rho).powi(3) / (1.0 - 0.25 * r_s / rho);
        let distance = 20.0;
        for k in 3..=15 {
            for sign in [-1.0, 1.0] {
                let offset = sign * 10f64.powi(-k);
                let b = radius * index(radius) * (1.0 + offset);
                let sine = b / (distance * index(distance));
                let direction = DVec3::new(-(1.0 - sine * sine).sqrt(), sine, 0.0);
                let shot = follow(&scene, DVec3::new(distance, 0.0, 0.0), direction);
                let hits = match shot.end {
                    Outcome::Landed(landing) => {
                        assert!((landing.position.length() - radius).abs() < 1e-9);
                        true
                    }
                    Outcome::Escaped(_) => false,
                    end => panic!("offset {offset:e}: {end:?}"),
                };
                // Within 1e-12 of the tangent, rounding decides.
                assert!(k > 11 || hits == (sign < 0.0), "r_s = {r_s}, offset {offset:e}: {shot:?}");
            }
        }
    }
}

#[test]
fn no_ray_slips_through_a_wall_with_slivers_of_aspect_a_million() {
    // Strips of height 1 and width 1e-6 between plain rectangles, in the plane z = 5.
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let mut columns = vec![-10.0];
    for i in -8..=8 {
        columns.extend([f64::from(i), f64::from(i) + 1e-6]);
    }
    columns.push(10.0);
    for &x in &columns {
        positions.extend((-10..=10).map(|y| DVec3::new(x, f64::from(y), 5.0)));
    }
    for column in 0..columns.len() - 1 {
        for row in 0..20 {
            let corner = |dx: usize, dy: usize| (column + dx) * 21 + row + dy;
            triangles.extend([
                [corner(0, 0), corner(1, 0), corner(1, 1)],
                [corner(0, 0), corner(1, 1), corner(0, 1)],
            ]);
        }
    }
    let file = obj(&positions, &triangles);
    for r_s in [0.0, 0.3] {
        let text = hole(DVec3::new(0.0, 0.0, -4.0), r_s)
            + "[environment]\ncolor = [1, 1, 1]\n"
            + &material("black", 0.0, 0.0)
            + &mesh("wall.obj", DVec3::ZERO, "black");
        let scene = scene_with(&text, &[("wall.obj", &file)]);
        let mut random = Random::new(5);
        for _ in 0..50_000 {
            let column = f64::from(random.between(-4.0, 5.0).floor() as i32);
            let x = column + random.between(-1.0, 2.0) * 1e-6;
            let target = DVec3::new(x, random.between(-4.0, 4.0), 5.0);
            let start =
                DVec3::new(random.between(-3.0, 3.0), random.between(-3.0, 3.0), random.between(1.0, 4.0));
            let place = landing(&scene, start, target - start);
            assert!((place.z - 5.0).abs() < 1e-9, "{place}");
            assert!(r_s > 0.0 || place.distance(target) < 1e-5, "{place} for {target}");
        }
    }
}

/// Landings of the same rays from `eye` in a room that stands `far` from the origin.
fn landings_far_out(far: f64, hole_beside: bool, precision: &str) -> Vec<DVec3> {
    let place = DVec3::new(far, -0.5 * far, 0.25 * far);
    let center = if hole_beside { place + DVec3::new(1.0, 0.5, -0.5) } else { DVec3::ZERO };
    let text = hole(center, 0.5)
        + &format!("[render]\ntolerance = 1e-4\narc_tolerance = 1e-3\nprecision = \"{precision}\"\n")
        + &material("black", 0.0, 0.0)
        + &sphere(place, 6.0, "black")
        + &sphere(place + DVec3::new(2.0, -1.0, 2.5), 0.5, "black");
    let scene = scene(&text);
    let mut random = Random::new(7);
    let mut start =
        || ray(place + DVec3::new(-4.0, 0.5, 0.3), DVec3::new(1.0, 0.0, 0.0) + 0.6 * random.in_cube());
    let rays: Vec<Ray> = (0..3000).map(|_| start()).collect();
    let end = |shot: &Shot| match shot.end {
        Outcome::Landed(landing) => landing.position - place,
        Outcome::Captured => DVec3::INFINITY,
        end => panic!("{end:?}"),
    };
    shoot(&scene, &rays).iter().map(end).collect()
}

#[test]
fn places_at_ten_million_do_not_jitter_in_single_precision() {
    for hole_beside in [true, false] {
        // The place itself is exact in 64 bits; its sum with a coordinate in the room is good to 2e-9.
        let exact = landings_far_out(1e7, hole_beside, "f64");
        let single = landings_far_out(1e7, hole_beside, "f32");
        let mut distances: Vec<f64> = exact
            .iter()
            .zip(&single)
            .filter(|(a, b)| a.is_finite() && b.is_finite())
            .map(|(a, b)| a.distance(*b))
            .collect();
        distances.sort_by(f64::total_cmp);
        let (median, most) = (distances[distances.len() / 2], distances[distances.len() * 99 / 100]);
        println!("hole beside {hole_beside}: median {median:e}, 99 % {most:e}");
        // A coordinate of 1e7 in 32 bits is good to 1.
        assert!(median < 2e-4, "median {median:e}");
        assert!(!hole_beside || most < 1e-2, "99 % {most:e}");
        let fates = exact.iter().zip(&single).filter(|(a, b)| a.is_finite() != b.is_finite()).count();
        assert!(fates <= 3, "{fates} fates differ");
    }
}

#[test]
fn a_wall_a_thousandth_of_the_hole_above_its_horizon_is_met_where_it_stands() {
    // The horizon is at 0.25, the wall at 0.251, as triangles and as a sphere that touches the same height.
    let wall = obj(
        &[DVec3::new(-40.0, 0.251, -40.0), DVec3::new(40.0, 0.251, -40.0), DVec3::new(0.0, 0.251, 60.0)],
        &[[0, 1, 2]],
    );
    let quality = |stepper: &str, tolerance: f64| {
        let text = hole(DVec3::ZERO, 1.0)
            + &format!(
                "[render]\nstepper = \"{stepper}\"\ntolerance = {tolerance:?}\narc_tolerance = 1e-4\n"
            )
            + "[environment]\ncolor = [1, 1, 1]\n"
            + &material("black", 0.0, 0.0)
            + &mesh("wall.obj", DVec3::ZERO, "black");
        scene_with(&text, &[("wall.obj", &wall)])
    };
    let (standard, reference) = (quality("rkn6", 1e-5), quality("dop853", 1e-11));
    assert!(
        (landing(&standard, DVec3::new(0.0, 3.0, 0.0), DVec3::NEG_Y) - DVec3::new(0.0, 0.251, 0.0)).length()
            < 1e-6
    );
    let mut random = Random::new(11);
    let mut start = || {
        let position =
            DVec3::new(random.between(-2.0, 2.0), random.between(0.3, 3.0), random.between(-2.0, 2.0));
        ray(position, random.direction())
    };
    let rays: Vec<Ray> = (0..20_000).map(|_| start()).collect();
    let (mut landed, mut differ, mut far) = (0, 0, 0);
    for ((a, b), ray) in shoot(&standard, &rays).iter().zip(&shoot(&reference, &rays)).zip(&rays) {
        match (a.end, b.end) {
            (Outcome::Landed(a), Outcome::Landed(b)) => {
                assert!((a.position.y - 0.251).abs() < 1e-7, "{ray:?}: {a:?}");
                landed += 1;
                far += usize::from(a.position.distance(b.position) > 1e-3 * b.position.length().max(1.0));
            }
            (Outcome::Escaped(_), Outcome::Escaped(_)) | (Outcome::Captured, Outcome::Captured) => {}
            (Outcome::StepLimit | Outcome::NonFinite, _) | (_, Outcome::StepLimit | Outcome::NonFinite) => {
                panic!("{ray:?}: {a:?}, {b:?}")
            }
            _ => differ += 1,
        }
    }
    println!("{landed} landed, {far} far apart, {differ} of another fate");
    assert!(landed > 5000 && far * 200 < landed && differ * 500 < rays.len());
}
