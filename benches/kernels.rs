//! Micro-benchmarks of the kernels, one core: `cargo bench`, or `cargo bench -- search` for a part.
//!
//! `search` measures the choice of hierarchy: the engine's own walk over the eight-wide `CwBvh`, which widens every box
//! by the sagitta of the arc at hand, against obvhs's own traversals of its `CwBvh` and of its `Bvh2`, whose boxes must
//! be inflated by the largest sagitta when they are built. All test the same f64 primitives; how many hits each finds is
//! printed first, and the numbers must agree.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::sync::LazyLock;
use std::time::Duration;

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::{DAffine3, DVec3};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray, RayHit};
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use warpfront::geodesic::{
    Arc, Control, Dop853, Dopri5, Launch, Leapfrog4, PaperRk4, Phase, Rk4, Rkf45, Rkn4, Rkn6, Step, Stepper,
    fit_arc,
};
use warpfront::geometry::{
    Geometry, Instance, Line, Mesh, PrimitiveId, Primitives, Segment, Sphere, Surface, Triangle,
};
use warpfront::light::{Emission, Tree};
use warpfront::math::real::Real;
use warpfront::spacetime::{ConformallyFlat, Schwarzschild};

/// Items of a sample: the timer's own cost vanishes beside them.
const ITEMS: usize = 4096;
/// A hole in the middle of the mesh, whose radius is about 1.
const HOLE: f64 = 0.2;
/// What steps are held to.
const TOLERANCES: (f64, f64) = (1e-5, 1e-4);

fn main() {
    println!("{}", BENCH_SCENE.describe());
    divan::main();
}

fn random() -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(1)
}

fn direction(random: &mut Xoshiro256PlusPlus) -> DVec3 {
    let (z, phi) = (2.0 * random.random::<f64>() - 1.0, TAU * random.random::<f64>());
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * phi.cos(), radius * phi.sin(), z)
}

/// Start and unit direction of rays from all around towards the mesh.
fn rays(count: usize) -> Vec<(DVec3, DVec3)> {
    let mut random = random();
    let mut ray = || {
        let start = 3.0 * direction(&mut random);
        let target = 1.1 * random.random::<f64>().cbrt() * direction(&mut random);
        (start, (target - start).normalize())
    };
    (0..count).map(|_| ray()).collect()
}

/// First steps of rays, each in one loop over the arrays of a wave: (b, phase, h) in, the step out.
mod steps {
    use super::*;

    type Start<R> = (R, Phase<R>, R);

    fn starts<R: Real, S: Stepper>() -> Vec<Start<R>> {
        let medium = Schwarzschild::new(HOLE);
        let control = Control::<R>::new(&medium, TOLERANCES.0, TOLERANCES.1);
        let start = |(x, direction): (DVec3, DVec3)| {
            let Launch { b, w, v, .. } = Launch::new(&medium, x, direction, R::EPSILON);
            let (b, phase) = (R::of(b), Phase::new(&medium, R::of(w), R::of(v)));
            (b, phase, control.first_step(&medium, S::ESTIMATE.order, b, &phase))
        };
        rays(ITEMS).into_iter().map(start).collect()
    }

    fn take<R: Real, S: Stepper>(bencher: Bencher, stepper: S) {
        let (medium, starts) = (Schwarzschild::new(HOLE), starts::<R, S>());
        let mut ends = vec![(Phase::<R>::default(), R::default()); ITEMS];
        bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
            for (&(b, phase, h), end) in black_box(&starts).iter().zip(&mut ends) {
                let step = Step::new(&medium, &stepper, b, phase, h);
                *end = (step.end, step.embedded + step.undone);
            }
            black_box(&ends);
        });
    }

    macro_rules! steppers {
        ($($name:ident: $stepper:ident,)*) => {
            $(mod $name {
                use super::*;

                #[divan::bench]
                fn single(bencher: Bencher) {
                    take::<f32, _>(bencher, $stepper);
                }

                #[divan::bench]
                fn double(bencher: Bencher) {
                    take::<f64, _>(bencher, $stepper);
                }
            })*
        };
    }
    steppers! {
        rk4: Rk4,
        rkn4: Rkn4,
        leapfrog4: Leapfrog4,
        rkf45: Rkf45,
        dopri5: Dopri5,
        rkn6: Rkn6,
        dop853: Dop853,
    }

    #[divan::bench]
    fn rk4_paper(bencher: Bencher) {
        let (medium, stepper) = (Schwarzschild::new(HOLE), PaperRk4 { r_s: HOLE });
        let momentum = |(x, direction): (DVec3, DVec3)| {
            (x, direction * medium.index_squared(1.0 / x.length()).sqrt(), 0.1)
        };
        let states: Vec<(DVec3, DVec3, f64)> = rays(ITEMS).into_iter().map(momentum).collect();
        bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
            for (x, p, dt) in &states {
                black_box(stepper.step(black_box(*x), *p, *dt));
            }
        });
    }

    fn fit<R: Real>(bencher: Bencher) {
        let medium = Schwarzschild::new(HOLE);
        let step = |(b, phase, h): Start<R>| Step::new(&medium, &Rkn6, b, phase, h);
        let steps: Vec<Step<R>> = starts::<R, Rkn6>().into_iter().map(step).collect();
        bencher.counter(ItemsCount::new(ITEMS)).bench_local(|| {
            for step in &steps {
                black_box(fit_arc(black_box(step)));
            }
        });
    }

    #[divan::bench]
    fn fit_an_arc_single(bencher: Bencher) {
        fit::<f32>(bencher);
    }

    #[divan::bench]
    fn fit_an_arc_double(bencher: Bencher) {
        fit::<f64>(bencher);
    }
}

/// One primitive beside each segment, so near that boxes would not have told them apart.
mod primitives {
    use super::*;

    fn near(segment: &impl Segment, random: &mut Xoshiro256PlusPlus, size: f64) -> DVec3 {
        segment.point(0.5) + size * direction(random)
    }

    #[divan::bench]
    fn arc_sphere(bencher: Bencher) {
        let mut random = random();
        let pairs: Vec<(Arc, Sphere)> = BENCH_SCENE
            .arcs
            .iter()
            .map(|arc| (*arc, Sphere { center: near(arc, &mut random, 0.02), radius: 0.02 }))
            .collect();
        bencher.counter(ItemsCount::new(pairs.len())).bench_local(|| {
            for (arc, sphere) in &pairs {
                black_box(arc.cross_sphere(black_box(sphere), false));
            }
        });
    }

    fn with_triangles<S: Segment>(bencher: Bencher, segments: &[S]) {
        let mut random = random();
        let mut triangle = |segment: &S| {
            let corners = std::array::from_fn(|_| near(segment, &mut random, 0.02).as_vec3().to_array());
            (*segment, Triangle { corners })
        };
        let pairs: Vec<(S, Triangle)> = segments.iter().map(&mut triangle).collect();
        bencher.counter(ItemsCount::new(pairs.len())).bench_local(|| {
            for (segment, triangle) in &pairs {
                black_box(segment.cross_triangle(black_box(triangle), false));
            }
        });
    }

    #[divan::bench]
    fn arc_triangle(bencher: Bencher) {
        with_triangles(bencher, &BENCH_SCENE.arcs);
    }

    #[divan::bench]
    fn line_triangle(bencher: Bencher) {
        with_triangles(bencher, &BENCH_SCENE.lines);
    }
}

/// The first hit in the mesh.
mod search {
    use super::*;

    fn count<S: Segment>(bencher: Bencher, segments: &[S], find: impl Fn(&S) -> Option<f64>) {
        bencher.counter(ItemsCount::new(segments.len())).bench_local(|| {
            for segment in segments {
                black_box(find(black_box(segment)));
            }
        });
    }

    #[divan::bench]
    fn arcs_thick_walk(bencher: Bencher) {
        count(bencher, &BENCH_SCENE.arcs, |arc| BENCH_SCENE.walk(arc));
    }

    #[divan::bench]
    fn arcs_cwbvh_inflated(bencher: Bencher) {
        count(bencher, &BENCH_SCENE.arcs, |arc| BENCH_SCENE.wide_inflated.find(arc));
    }

    #[divan::bench]
    fn arcs_bvh2_inflated(bencher: Bencher) {
        count(bencher, &BENCH_SCENE.arcs, |arc| BENCH_SCENE.binary_inflated.find(arc));
    }

    #[divan::bench]
    fn rays_bvh2(bencher: Bencher) {
        count(bencher, &BENCH_SCENE.lines, |line| BENCH_SCENE.binary.find(line));
    }

    #[divan::bench]
    fn rays_thick_walk(bencher: Bencher) {
        count(bencher, &BENCH_SCENE.lines, |line| BENCH_SCENE.walk(line));
    }

    #[divan::bench]
    fn rays_cwbvh(bencher: Bencher) {
        count(bencher, &BENCH_SCENE.lines, |line| BENCH_SCENE.wide.find(line));
    }

    #[divan::bench]
    fn rays_cwbvh_inflated(bencher: Bencher) {
        count(bencher, &BENCH_SCENE.lines, |line| BENCH_SCENE.wide_inflated.find(line));
    }
}

/// One of ten thousand emitters for a point among them.
mod lights {
    use super::*;

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
        Tree::build(&(0..EMITTERS).map(|_| emission()).collect::<Vec<_>>(), 0.1)
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
        count(bencher, |tree, x, normal, u| tree.sample(x, Some(normal), u).map_or(0.0, |chosen| chosen.1));
    }

    #[divan::bench]
    fn probability(bencher: Bencher) {
        count(bencher, |tree, x, normal, u| {
            tree.probability((u * f64::from(EMITTERS)) as u32, x, Some(normal))
        });
    }
}

/// What is searched, and for what.
struct BenchScene {
    geometry: Geometry,
    wide: Theirs<CwBvh>,
    wide_inflated: Theirs<CwBvh>,
    binary: Theirs<Bvh2>,
    binary_inflated: Theirs<Bvh2>,
    arcs: Vec<Arc>,
    lines: Vec<Line>,
}

static BENCH_SCENE: LazyLock<BenchScene> = LazyLock::new(|| {
    let mesh = bumpy_icosphere(7);
    let triangles: Vec<Triangle> = mesh
        .triangles
        .iter()
        .map(|corners| Triangle { corners: corners.map(|index| mesh.positions[index as usize]) })
        .collect();
    let placed = Instance { mesh: 0, to_world: DAffine3::IDENTITY };
    let geometry = Geometry::build(Primitives {
        meshes: vec![mesh],
        instances: vec![(placed, Surface { material: 0, entity: 0 })],
        ..Primitives::default()
    });
    // As the tracer does: arcs are halved until they are thin beside the triangles.
    let thickest = 0.25 * geometry.typical_extent();
    let arcs = marched_arcs(thickest, geometry.bounds().unwrap_or_default());
    let line = |(start, direction)| Line { p0: start, p2: start + 6.0 * direction };
    BenchScene {
        wide: Theirs::build(&triangles, 0.0),
        wide_inflated: Theirs::build(&triangles, thickest),
        binary: Theirs::build(&triangles, 0.0),
        binary_inflated: Theirs::build(&triangles, thickest),
        lines: rays(ITEMS).into_iter().map(line).collect(),
        arcs,
        geometry,
    }
});

impl BenchScene {
    fn walk(&self, segment: &impl Segment) -> Option<f64> {
        self.geometry.intersect(segment, PrimitiveId::NONE).map(|hit| hit.s)
    }

    /// Sizes, and how many hits each search finds.
    fn describe(&self) -> String {
        let hits = |found: &mut dyn Iterator<Item = Option<f64>>| found.flatten().count();
        let arcs = [
            hits(&mut self.arcs.iter().map(|arc| self.walk(arc))),
            hits(&mut self.arcs.iter().map(|arc| self.wide_inflated.find(arc))),
            hits(&mut self.arcs.iter().map(|arc| self.binary_inflated.find(arc))),
        ];
        let lines = [
            hits(&mut self.lines.iter().map(|line| self.walk(line))),
            hits(&mut self.lines.iter().map(|line| self.wide.find(line))),
            hits(&mut self.lines.iter().map(|line| self.binary.find(line))),
        ];
        let length: f64 = self.arcs.iter().map(|arc| arc.p0.distance(arc.p2)).sum();
        format!(
            "{} triangles; {} arcs of mean length {:.3}: {arcs:?} hits; {} rays: {lines:?} hits (own walk, CwBvh, Bvh2)",
            self.geometry.counts().triangles,
            self.arcs.len(),
            length / self.arcs.len() as f64,
            self.lines.len()
        )
    }
}

/// A hierarchy of obvhs with its own traversal.
trait Hierarchy {
    fn build(boxes: &[Aabb]) -> Self;
    /// Box index of each leaf slot.
    fn order(&self) -> &[u32];
    fn search(&self, ray: Ray, leaf: impl FnMut(usize) -> f32);
}

impl Hierarchy for CwBvh {
    fn build(boxes: &[Aabb]) -> Self {
        build_cwbvh(boxes, BvhBuildParams::medium_build(), &mut Duration::default())
    }

    fn order(&self) -> &[u32] {
        &self.primitive_indices
    }

    fn search(&self, ray: Ray, mut leaf: impl FnMut(usize) -> f32) {
        self.ray_traverse(ray, &mut RayHit::none(), |_, slot| leaf(slot));
    }
}

impl Hierarchy for Bvh2 {
    fn build(boxes: &[Aabb]) -> Self {
        build_bvh2(boxes, BvhBuildParams::medium_build(), &mut Duration::default())
    }

    fn order(&self) -> &[u32] {
        &self.primitive_indices
    }

    fn search(&self, ray: Ray, mut leaf: impl FnMut(usize) -> f32) {
        self.ray_traverse(ray, &mut RayHit::none(), |_, slot| leaf(slot));
    }
}

/// Triangles in the leaf order of a hierarchy of obvhs.
struct Theirs<T> {
    tree: T,
    triangles: Vec<Triangle>,
}

/// The node test of `CwBvh` loses hits nearer than 1e-4, so a segment starts this much earlier.
const LEAD: f64 = 2e-4;

impl<T: Hierarchy> Theirs<T> {
    fn build(triangles: &[Triangle], inflation: f64) -> Self {
        let boxed = |triangle: &Triangle| {
            let (min, max) = triangle.bounds();
            Aabb::new((min - inflation).as_vec3a(), (max + inflation).as_vec3a())
        };
        let tree = T::build(&triangles.iter().map(boxed).collect::<Vec<_>>());
        let triangles = tree.order().iter().map(|&index| triangles[index as usize]).collect();
        Self { tree, triangles }
    }

    fn find(&self, segment: &impl Segment) -> Option<f64> {
        let chord = segment.chord();
        let along = chord.end - chord.start;
        let length = along.length();
        let direction = along / length;
        let start = chord.start - LEAD * direction;
        // A little past the end as well: a hit at exactly the ray's end is missed.
        let range = (LEAD as f32, (length + 2.0 * LEAD) as f32);
        let ray = Ray::new(start.as_vec3a(), direction.as_vec3a(), range.0, range.1);
        let mut nearest: Option<f64> = None;
        self.tree.search(ray, |slot| {
            let Some(s) = segment.cross_triangle(&self.triangles[slot], false) else { return f32::INFINITY };
            nearest = Some(nearest.map_or(s, |best| best.min(s)));
            (segment.point(s) - start).dot(direction) as f32
        });
        nearest
    }
}

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

/// An icosahedron with every triangle cut in four `levels` times, on a bumpy sphere.
fn bumpy_icosphere(levels: u32) -> Mesh {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.extend([DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)]);
    }
    let edge = 2.0;
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let corners = [points[i], points[j], points[k]];
                let neighbours = |a: DVec3, b: DVec3| (a.distance(b) - edge).abs() < 1e-9;
                if neighbours(corners[0], corners[1])
                    && neighbours(corners[1], corners[2])
                    && neighbours(corners[2], corners[0])
                {
                    triangles.push(corners);
                }
            }
        }
    }
    for _ in 0..levels {
        triangles = triangles.into_iter().flat_map(quartered).collect();
    }
    let bumpy = |corner: DVec3| {
        let unit = corner.normalize();
        let height = 1.0 + 0.05 * (9.0 * unit.x).sin() * (11.0 * unit.y).sin() * (13.0 * unit.z).cos();
        (height * unit).as_vec3().to_array()
    };
    Mesh {
        positions: triangles.iter().flatten().map(|&corner| bumpy(corner)).collect(),
        normals: Vec::new(),
        triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    }
}

fn quartered([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
    [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
}
