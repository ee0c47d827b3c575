//! What the micro-benchmarks share: random rays past a hole, and the arcs in which they cross a mesh around it.
#![allow(dead_code)] // Each benchmark is a crate of its own and uses a part of this.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use glam::{DAffine3, DVec3};
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use warpfront::geodesic::{Arc, Control, Launch, Phase, Rkn6, Step, fit_arc};
use warpfront::geometry::{Geometry, Instance, Line, Mesh, Primitives, Surface};
use warpfront::spacetime::{ConformallyFlat, Schwarzschild};
use warpfront::study::bench::bumpy_sphere;

/// Items of a sample: the timer's own cost vanishes beside them.
pub const ITEMS: usize = 4096;
/// Schwarzschild radius of a hole in the middle of the mesh, whose radius is about 1.
pub const HOLE: f64 = 0.2;
/// What steps are held to: radians, and distance between an arc and its ray.
pub const TOLERANCES: (f64, f64) = (1e-5, 1e-4);
/// Triangles of the mesh.
const TRIANGLES: usize = 327_680;

pub fn random() -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(1)
}

pub fn direction(random: &mut Xoshiro256PlusPlus) -> DVec3 {
    let (z, phi) = (2.0 * random.random::<f64>() - 1.0, TAU * random.random::<f64>());
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * phi.cos(), radius * phi.sin(), z)
}

/// Start and unit direction of rays from all around towards the mesh.
pub fn rays(count: usize) -> Vec<(DVec3, DVec3)> {
    let mut random = random();
    let mut ray = || {
        let start = 3.0 * direction(&mut random);
        let target = 1.1 * random.random::<f64>().cbrt() * direction(&mut random);
        (start, (target - start).normalize())
    };
    (0..count).map(|_| ray()).collect()
}

/// A mesh, and what it is searched along.
pub struct Bumps {
    pub mesh: Mesh,
    pub geometry: Geometry,
    /// Largest sagitta of the arcs.
    pub thickest: f64,
    pub arcs: Vec<Arc>,
    pub lines: Vec<Line>,
}

pub static BUMPS: LazyLock<Bumps> = LazyLock::new(|| {
    let mesh = bumpy_sphere(TRIANGLES);
    let placed = Instance { mesh: 0, to_world: DAffine3::IDENTITY };
    let geometry = Geometry::build(Primitives {
        meshes: vec![mesh.clone()],
        instances: vec![(placed, Surface { material: 0, entity: 0 })],
        ..Primitives::default()
    });
    // As the tracer does: arcs are halved until they are thin beside the triangles.
    let thickest = 0.25 * geometry.typical_extent();
    let line = |(start, direction)| Line { p0: start, p2: start + 6.0 * direction };
    Bumps {
        arcs: marched_arcs(thickest, geometry.bounds().unwrap_or_default()),
        lines: rays(ITEMS).into_iter().map(line).collect(),
        thickest,
        geometry,
        mesh,
    }
});

/// Arcs of real rays around the hole, within the bounds of the mesh.
fn marched_arcs(thickest: f64, (min, max): (DVec3, DVec3)) -> Vec<Arc> {
    let medium = Schwarzschild::new(HOLE);
    let control = Control::<f64>::new(&medium, TOLERANCES.0, TOLERANCES.1);
    let mut arcs = Vec::new();
    for (x, direction) in rays(ITEMS / 4) {
        let launch = Launch::new(&medium, x, direction, f64::EPSILON);
        let (b, mut phase) = (launch.b, Phase::new(&medium, launch.w, launch.v));
        let (mut h, mut previous, mut swept) =
            (control.first_step(&medium, Rkn6::ESTIMATE.order, b, &phase), 1.0, 0.0);
        for _ in 0..40 {
            let step = Step::new(&medium, &Rkn6, b, phase, h);
            let arc = fit_arc(&step);
            let verdict = control.judge::<Rkn6>(&step, arc.error, previous);
            h = verdict.next_h;
            if verdict.accepted {
                let (sin, cos) = f64::sin_cos(swept);
                let radial = cos * launch.radial + sin * launch.along;
                let along = cos * launch.along - sin * launch.radial;
                split(arc.placed(launch.position(phase.w, swept), radial, along), thickest, &mut arcs);
                (phase, previous) = (step.end, verdict.error);
                swept += (b * step.h).atan();
                h = control.within(h, b, &phase);
            }
            if phase.w < 0.25 || 2.0 * phase.w * medium.horizon() > 1.0 {
                break;
            }
        }
    }
    arcs.retain(|arc| {
        let (low, high) = (arc.p0.min(arc.p1).min(arc.p2), arc.p0.max(arc.p1).max(arc.p2));
        low.cmple(max).all() && high.cmpge(min).all()
    });
    arcs.truncate(ITEMS);
    arcs
}

fn split(arc: Arc, thickest: f64, arcs: &mut Vec<Arc>) {
    if arc.sagitta() <= thickest {
        return arcs.push(arc);
    }
    let (left, right) = arc.halves();
    split(left, thickest, arcs);
    split(right, thickest, arcs);
}
