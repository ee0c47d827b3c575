//! The hierarchy against a search of everything, and segments that share their ends.

use crate::support::Random;
use glam::{DAffine3, DMat3, DVec3};
use warpfront::geodesic::Arc;
use warpfront::geometry::{
    Geometry, Hit, Instance, Line, Mesh, PrimitiveId, Primitives, Segment, Sphere, Surface,
};

const SURFACE: Surface = Surface { material: 0, entity: 0 };

/// A soup of random triangles around the origin.
fn soup(random: &mut Random, count: usize) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count as u32 {
        let (place, size) = (random.in_cube(), random.log_between(1e-3, 0.3));
        for _ in 0..3 {
            mesh.positions.push((place + size * random.in_cube()).as_vec3().to_array());
        }
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

/// A random map that scales, shears and, every other time, mirrors.
fn placement(random: &mut Random, offset: DVec3, scale: f64) -> DAffine3 {
    loop {
        let matrix = DMat3::from_cols(random.in_cube(), random.in_cube(), random.in_cube());
        if matrix.determinant().abs() > 0.1 {
            return DAffine3::from_mat3_translation(scale * matrix, offset + random.in_cube());
        }
    }
}

/// Spheres of all sizes, a mesh that appears once, and one that appears ten times, within about 2 of `offset`.
fn scene(random: &mut Random, offset: DVec3) -> Geometry {
    let spheres = (0..60)
        .map(|_| (offset + random.in_cube(), random.log_between(1e-4, 0.3)))
        .map(|(center, radius)| (Sphere { center, radius }, SURFACE))
        .collect();
    let meshes = vec![soup(random, 200), soup(random, 40)];
    let mut instances = vec![(Instance { mesh: 0, to_world: DAffine3::from_translation(offset) }, SURFACE)];
    for _ in 0..10 {
        instances.push((Instance { mesh: 1, to_world: placement(random, offset, 0.5) }, SURFACE));
    }
    Geometry::build(Primitives { spheres, disks: Vec::new(), meshes, instances })
}

/// Ends of a segment of any size up to ten times the scene's, through `point`.
fn ends(random: &mut Random, point: DVec3) -> (DVec3, DVec3) {
    let along = random.log_between(1e-6, 20.0) * random.direction();
    let start = point - random.between(0.0, 1.0) * along;
    (start, start + along)
}

/// An arc between random ends that turns by less than a right angle, as those of steps do.
fn arc(random: &mut Random, point: DVec3) -> Arc {
    let (p0, p2) = ends(random, point);
    let chord = p2 - p0;
    let height = random.log_between(1e-8, 0.45) * chord.length();
    let aside = chord.cross(random.direction()).normalize_or_zero();
    let p1 = p0 + random.between(0.3, 0.7) * chord + height.min(0.3 * chord.length()) * aside;
    Arc { p0, p1, p2, w: random.between(0.5, 1.5) }
}

/// Searches `count` random segments both ways and, from where something is hit, another one that starts there.
fn compare<S: Segment + std::fmt::Debug>(
    seed: u64,
    offset: DVec3,
    count: usize,
    segment: fn(&mut Random, DVec3) -> S,
    from_hit: fn(&S, DVec3) -> S,
) {
    let mut random = Random::new(seed);
    let geometry = scene(&mut random, offset);
    let (mut hits, mut mismatches) = (0, Vec::new());
    let mut search = |segment: &S, origin_prim: PrimitiveId| -> Option<Hit> {
        let (fast, slow) =
            (geometry.intersect(segment, origin_prim), geometry.intersect_brute_force(segment, origin_prim));
        if fast != slow {
            mismatches.push((*segment, fast, slow));
        }
        hits += usize::from(slow.is_some());
        slow
    };
    let mut surface = offset;
    for i in 0..count {
        // Every other segment goes through a point of a surface, so that short ones meet something too.
        let point = if i % 2 == 0 { offset + 1.2 * random.in_cube() } else { surface };
        let segment = segment(&mut random, point);
        if let Some(hit) = search(&segment, PrimitiveId::NONE) {
            surface = segment.point(hit.s);
            search(&from_hit(&segment, surface), hit.primitive);
        }
    }
    println!("{hits} hits from {offset}");
    assert!(mismatches.is_empty(), "{} mismatches, first {:?}", mismatches.len(), mismatches[0]);
    assert!(hits > count / 3, "{hits} hits only");
}

fn line(random: &mut Random, point: DVec3) -> Line {
    let (p0, p2) = ends(random, point);
    Line { p0, p2 }
}

fn rest_of_line(line: &Line, point: DVec3) -> Line {
    Line { p0: point, p2: line.p2 }
}

fn arc_from(arc: &Arc, point: DVec3) -> Arc {
    let shift = point - arc.p0;
    Arc { p0: point, p1: arc.p1 + shift, p2: arc.p2 + shift, w: arc.w }
}

const FAR: DVec3 = DVec3::new(1e6, -2e6, 5e5);

#[test]
fn the_hierarchy_finds_what_a_search_of_everything_finds_along_lines() {
    for seed in 0..4 {
        compare(seed, DVec3::ZERO, 15_000, line, rest_of_line);
    }
}

#[test]
fn the_hierarchy_finds_what_a_search_of_everything_finds_along_arcs() {
    for seed in 10..14 {
        compare(seed, DVec3::ZERO, 15_000, arc, arc_from);
    }
}

#[test]
fn the_hierarchy_finds_what_a_search_of_everything_finds_far_from_the_origin() {
    for seed in 20..22 {
        compare(seed, FAR, 10_000, line, rest_of_line);
        compare(seed, FAR, 10_000, arc, arc_from);
    }
}

/// Walls across x = 1, 2, …, 9, alternately of triangles and of spheres that touch the axis there, with an identity
/// each.
fn gauntlet() -> Geometry {
    let mut primitives = Primitives::default();
    for i in 1..10u32 {
        let (x, surface) = (f64::from(i), Surface { material: 0, entity: i });
        if i % 2 == 0 {
            // Within the gap to the next wall only: from its near pole on, out again at +1/4.
            let sphere = Sphere { center: DVec3::new(x + 0.125, 0.0, 0.0), radius: 0.125 };
            primitives.spheres.push((sphere, surface));
            continue;
        }
        let x = x as f32;
        primitives
            .instances
            .push((Instance { mesh: primitives.meshes.len() as u32, to_world: DAffine3::IDENTITY }, surface));
        primitives.meshes.push(Mesh {
            positions: vec![[x, -2.0, -1.0], [x, 3.0, -1.0], [x, 0.0, 4.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        });
    }
    Geometry::build(primitives)
}

/// All crossings of the gauntlet along pieces of a line that share their ends, as (place, entity).
fn crossings(geometry: &Geometry, from: DVec3, to: DVec3, pieces: usize) -> Vec<(f64, u32)> {
    let point = |i: usize| from + (to - from) * (i as f64 / pieces as f64);
    let mut found = Vec::new();
    for i in 0..pieces {
        let mut line = Line { p0: point(i), p2: point(i + 1) };
        let mut origin_prim = PrimitiveId::NONE;
        while let Some(hit) = geometry.intersect(&line, origin_prim) {
            let place = line.point(hit.s);
            found.push((place.x, geometry.surface(hit.primitive).entity));
            line = Line { p0: place, p2: line.p2 };
            origin_prim = hit.primitive;
            assert!(found.len() < 100, "stuck at {place}");
        }
    }
    found
}

#[test]
fn a_ray_cut_into_any_number_of_segments_crosses_what_the_whole_one_crosses() {
    let geometry = gauntlet();
    for (from, to) in [(0.0, 10.0), (10.0, 0.0)] {
        let (from, to) = (DVec3::new(from, 0.0, 0.0), DVec3::new(to, 0.0, 0.0));
        let whole = crossings(&geometry, from, to, 1);
        assert_eq!(whole.len(), 5 + 2 * 4, "{whole:?}");
        // Multiples of ten put ends on the walls, of eighty on the spheres' poles too.
        for pieces in 1..=1000 {
            let cut = crossings(&geometry, from, to, pieces);
            let same = cut.len() == whole.len()
                && cut.iter().zip(&whole).all(|(a, b)| a.1 == b.1 && (a.0 - b.0).abs() < 1e-12);
            assert!(same, "{pieces} pieces from {from}: {cut:?} is not {whole:?}");
        }
    }
}

#[test]
fn a_straight_arc_cut_into_any_number_of_segments_first_meets_what_the_whole_one_meets() {
    let geometry = gauntlet();
    for (from, to, entity) in [(0.5, 9.5, 1), (1.5, 9.5, 2), (9.5, 0.5, 9)] {
        for pieces in 1..=1000 {
            let point = |i: usize| DVec3::X * (from + (to - from) * (i as f64 / pieces as f64));
            let found: Vec<u32> = (0..pieces)
                .filter_map(|i| {
                    let (p0, p2) = (point(i), point(i + 1));
                    geometry.intersect(&Arc { p0, p1: 0.5 * (p0 + p2), p2, w: 1.0 }, PrimitiveId::NONE)
                })
                .map(|hit| geometry.surface(hit.primitive).entity)
                .collect();
            assert_eq!(found.first(), Some(&entity), "{pieces} pieces from {from}: {found:?}");
        }
    }
}

#[test]
fn hierarchies_over_equal_touching_and_nested_faces_take_time_in_proportion() {
    const COUNT: usize = 20_000;
    let folder = tempfile::tempdir().unwrap();
    let pairs: String = (0..=COUNT).map(|i| format!("v {i} 0 0\nv {i} 1 0\n")).collect();
    let strip = (0..COUNT).map(|i| 2 * i + 1).map(|i| format!("f {i} {} {} {}\n", i + 2, i + 3, i + 1));
    let strip = pairs.clone() + &strip.collect::<String>();
    let copies = "v 1000 0 0\nv 1001 0 0\nv 1001 1 0\nv 1000 1 0\n".to_owned() + &"f 1 2 3 4\n".repeat(COUNT);
    let nested = (0..COUNT).map(|i| 1.0 + i as f64 / COUNT as f64).map(|size| {
        format!(
            "v -{size} -{size} 0\nv {size} -{size} 0\nv {size} {size} 0\nv -{size} {size} 0\nf -4 -3 -2 -1\n"
        )
    });
    for (name, text) in [("strip.obj", strip), ("copies.obj", copies), ("nested.obj", nested.collect())] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let started = std::time::Instant::now();
        let scene = warpfront::scene::load(&path, &[]).unwrap();
        assert_eq!(scene.geometry.counts().triangles, 2 * COUNT, "{name}");
        assert!(started.elapsed().as_secs_f64() < 4.0, "{name}: {:.1?}", started.elapsed());
    }
}
