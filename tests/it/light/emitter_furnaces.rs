//! Every emitter, seen from inside, from outside and from itself, at every size, in flat space and near and far from a
//! hole: in a closed room that emits 1 and reflects ½ the radiance is 2 wherever one looks, whichever way lights are
//! sampled.

use crate::support::{
    camera, closed_box, film, hole, material, mean_red, mesh, render, scene_with, sphere, vector,
};
use glam::DVec3;
use warpfront::light::Heuristic::{self, Balance, Power};
use warpfront::scene::LightSampling::{self, Geodesic, Off, Straight};
use warpfront::trace::Run;

/// What emits, and where it is looked at from; sizes relative to the room's.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Emitters {
    /// A sphere, from inside.
    Sphere,
    /// A sphere in a sphere: from outside and from itself as well.
    SphereInSphere,
    /// Annuli in a sphere, on top of each other.
    DiskInSphere,
    /// A box, from inside.
    Mesh,
    /// Two boxes and a sphere in a box: triangles from outside, some of a shared mesh.
    MeshInMesh,
    /// A picture of the sky, and a sphere and an annulus in front of it.
    Sky,
}

const EMITTERS: [Emitters; 6] = [
    Emitters::Sphere,
    Emitters::SphereInSphere,
    Emitters::DiskInSphere,
    Emitters::Mesh,
    Emitters::MeshInMesh,
    Emitters::Sky,
];

/// Where the hole is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spacetime {
    Flat,
    /// Outside the room, so that space is nearly flat in it.
    Far,
    /// In the room, in a sphere that covers its horizon.
    Near,
}

/// How lights are sampled, where that has an influence on the mean.
const WAYS: [(LightSampling, Heuristic); 4] =
    [(Off, Power), (Straight, Power), (Geodesic, Balance), (Geodesic, Power)];

/// A sky of radiance ⅛ everywhere, as a Radiance picture.
const SKY: &str = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n@@@\u{7f}@@@\u{7f}";

/// The mean of a furnace whose room has the size `size`, over the radiance that it must have, and its standard error.
fn furnace(
    emitters: Emitters,
    size: f64,
    spacetime: Spacetime,
    (way, heuristic): (LightSampling, Heuristic),
    spp: u32,
) -> (f64, f64) {
    let at = |x: f64, y: f64, z: f64| size * DVec3::new(x, y, z);
    let lamp = |center, radius: f64| sphere(center, size * radius, "lamp");
    let disk = |center: DVec3, inner: f64, outer: f64| {
        format!(
            "[[entity]]\ndisk = {{ center = {}, normal = [0, 0.6, 0.8], inner = {:?}, outer = {:?} }}\nmaterial = \"lamp\"\n",
            vector(center),
            size * inner,
            size * outer
        )
    };
    let room = |file: &str, place: DVec3| mesh(file, place, "lamp");
    let content = match emitters {
        Emitters::Sphere => lamp(DVec3::ZERO, 1.0),
        Emitters::SphereInSphere => lamp(DVec3::ZERO, 1.0) + &lamp(at(0.3, 0.1, -0.2), 0.2),
        Emitters::DiskInSphere => {
            lamp(DVec3::ZERO, 1.0)
                + &disk(at(0.3, 0.1, -0.3), 0.1, 0.4)
                + &disk(at(0.3, 0.2, -0.25), 0.0, 0.3)
        }
        Emitters::Mesh => room("room.obj", DVec3::ZERO),
        Emitters::MeshInMesh => {
            room("room.obj", DVec3::ZERO)
                + &room("box.obj", at(0.3, 0.3, -0.3))
                + &room("box.obj", at(0.3, -0.3, -0.3))
                + &lamp(at(-0.3, 0.3, -0.3), 0.15)
        }
        Emitters::Sky => {
            lamp(at(0.3, 0.1, -0.2), 0.3)
                + &disk(at(-0.3, 0.2, -0.25), 0.0, 0.3)
                + "[environment]\nimage = \"sky.hdr\"\nstrength = 16\n"
        }
    };
    let hole = match spacetime {
        Spacetime::Flat => String::new(),
        Spacetime::Far => hole(at(40.0, 10.0, 0.0), size),
        Spacetime::Near => hole(at(-0.4, -0.1, -0.2), 0.1 * size) + &lamp(at(-0.4, -0.1, -0.2), 0.06),
    };
    let text = hole
        + &camera(at(0.1, 0.2, 0.6), at(0.0, 0.0, -0.2), 90.0)
        + &film(16, 16)
        + &format!("[render]\nspp = {spp}\nmax_depth = 40\nroulette_depth = 40\n")
        + &material("lamp", 0.5, 1.0)
        + &content;
    let files = [
        ("room.obj", closed_box(at(-1.0, -1.0, -1.0), at(1.0, 1.0, 1.0))),
        // Turned inside out: both sides emit.
        ("box.obj", closed_box(at(-0.15, -0.2, -0.1), at(0.15, 0.2, 0.1))),
        ("sky.hdr", SKY.to_owned()),
    ];
    let mut scene = scene_with(&text, &files.each_ref().map(|(name, file)| (*name, file.as_str())));
    (scene.settings.light_sampling, scene.settings.heuristic) = (way, heuristic);
    let rendered = render(&scene, &Run::default());
    let (mean, red) = (mean_red(&rendered), rendered.image.channel("R").unwrap());
    let squares: f64 = red.iter().map(|&value| (f64::from(value) - mean).powi(2)).sum();
    (0.5 * mean, 0.5 * squares.sqrt() / red.len() as f64)
}

/// Whether a furnace has an answer: around a hole straight light sampling is the paper's, which is not exact.
fn is_exact(spacetime: Spacetime, way: LightSampling) -> bool {
    spacetime == Spacetime::Flat || way != Straight
}

fn check(all: &[(Emitters, f64, Spacetime, (LightSampling, Heuristic))], spp: u32) {
    let mut wrong = Vec::new();
    for &(emitters, size, spacetime, way) in all {
        let (mean, error) = furnace(emitters, size, spacetime, way, spp);
        println!("{emitters:?} of size {size:e}, {spacetime:?}, {way:?}: {mean:.5} ± {error:.5}");
        // The noise is below two permille but of straight light sampling: where surfaces meet, its variance is not
        // finite.
        let allowed = (if way.0 == Straight { 4.0 } else { 3.0 } * error).max(2e-3);
        if (mean - 1.0).abs() > allowed {
            wrong.push((emitters, size, spacetime, way, mean));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn emitters_of_every_kind_light_a_furnace_right_in_every_way() {
    let mut all = Vec::new();
    for (number, emitters) in EMITTERS.into_iter().enumerate() {
        for (turn, way) in WAYS[1..].iter().copied().enumerate() {
            let size = [1e-3, 1.0, 50.0, 1e6][(number + turn) % 4];
            let spacetimes = if way.0 == Straight {
                [Spacetime::Flat].to_vec()
            } else {
                [Spacetime::Flat, [Spacetime::Far, Spacetime::Near][(number + turn) % 2]].to_vec()
            };
            all.extend(spacetimes.into_iter().map(|spacetime| (emitters, size, spacetime, way)));
        }
    }
    check(&all, 16);
}

#[test]
#[ignore = "takes minutes: cargo test --release --test it emitter_furnaces -- --ignored --nocapture"]
fn emitters_of_every_kind_and_size_light_a_furnace_right_in_every_way() {
    let mut all = Vec::new();
    for emitters in EMITTERS {
        for size in [1e-3, 0.1, 1.0, 50.0, 1e3, 1e6] {
            for spacetime in [Spacetime::Flat, Spacetime::Far, Spacetime::Near] {
                let ways = WAYS.into_iter().filter(|way| is_exact(spacetime, way.0));
                all.extend(ways.map(|way| (emitters, size, spacetime, way)));
            }
        }
    }
    check(&all, 96);
}
