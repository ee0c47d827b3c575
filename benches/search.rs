//! The first hit in a mesh of 327 680 triangles, along short arcs of marched rays and along whole straight rays: the
//! choice of hierarchy. One core.
//!
//! The engine's own hierarchy, which widens every box by the bow of the arc at hand, one walk after the other and eight
//! by turns, against obvhs's own traversals of its `CwBvh` and of its `Bvh2`, whose boxes must be inflated by the
//! largest sagitta when they are built. All test the same f64 primitives in the end; how many hits each finds is
//! printed first, and the numbers must agree.

mod common;

use std::hint::black_box;
use std::sync::LazyLock;
use std::time::Duration;

use common::BUMPS;
use divan::Bencher;
use divan::counter::ItemsCount;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray, RayHit};
use warpfront::geometry::{Need, PrimitiveId, Query, Search, Segment, SideBySide, Triangle};

fn main() {
    println!("{}", describe());
    divan::main();
}

/// The mesh in the hierarchies of obvhs.
struct Hierarchies {
    wide: Theirs<CwBvh>,
    wide_inflated: Theirs<CwBvh>,
    binary: Theirs<Bvh2>,
    binary_inflated: Theirs<Bvh2>,
}

static THEIRS: LazyLock<Hierarchies> = LazyLock::new(|| {
    let mesh = &BUMPS.mesh;
    let placed = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|index| mesh.positions[index as usize].into());
        Triangle { a, b, c }
    };
    let triangles: Vec<Triangle> = mesh.triangles.iter().map(placed).collect();
    Hierarchies {
        wide: Theirs::build(&triangles, 0.0),
        wide_inflated: Theirs::build(&triangles, BUMPS.thickest),
        binary: Theirs::build(&triangles, 0.0),
        binary_inflated: Theirs::build(&triangles, BUMPS.thickest),
    }
});

fn walk(segment: &impl Segment) -> Option<f64> {
    BUMPS.geometry.intersect(segment, PrimitiveId::NONE).map(|hit| hit.s)
}

/// Sizes, and how many hits each search finds.
fn describe() -> String {
    let hits = |found: &mut dyn Iterator<Item = Option<f64>>| found.flatten().count();
    let (arcs, lines) = (&BUMPS.arcs, &BUMPS.lines);
    let of_arcs = [
        hits(&mut arcs.iter().map(walk)),
        hits(&mut arcs.iter().map(|arc| THEIRS.wide_inflated.find(arc))),
        hits(&mut arcs.iter().map(|arc| THEIRS.binary_inflated.find(arc))),
    ];
    let of_lines = [
        hits(&mut lines.iter().map(walk)),
        hits(&mut lines.iter().map(|line| THEIRS.wide.find(line))),
        hits(&mut lines.iter().map(|line| THEIRS.binary.find(line))),
    ];
    let length: f64 = arcs.iter().map(|arc| arc.p0.distance(arc.p2)).sum();
    format!(
        "{} triangles; {} arcs of mean length {:.3}: {of_arcs:?} hits; {} rays: {of_lines:?} hits (own walk, CwBvh, Bvh2)",
        BUMPS.geometry.counts().triangles,
        arcs.len(),
        length / arcs.len() as f64,
        lines.len()
    )
}

fn count<S: Segment>(bencher: Bencher, segments: &[S], find: impl Fn(&S) -> Option<f64>) {
    bencher.counter(ItemsCount::new(segments.len())).bench_local(|| {
        for segment in segments {
            black_box(find(black_box(segment)));
        }
    });
}

fn by_turns<S: SideBySide>(bencher: Bencher, segments: &[S]) {
    let mut search = Search::default();
    search.queries.gather(segments.len(), |lane| Query {
        segment: segments[lane],
        origin_prim: PrimitiveId::NONE,
        need: Need::Whole,
    });
    bencher
        .counter(ItemsCount::new(segments.len()))
        .bench_local(|| BUMPS.geometry.search_all(black_box(&mut search), segments.len()));
}

#[divan::bench]
fn arcs_by_turns(bencher: Bencher) {
    by_turns(bencher, &BUMPS.arcs);
}

#[divan::bench]
fn rays_by_turns(bencher: Bencher) {
    by_turns(bencher, &BUMPS.lines);
}

#[divan::bench]
fn arcs_walk(bencher: Bencher) {
    count(bencher, &BUMPS.arcs, walk);
}

#[divan::bench]
fn arcs_cwbvh_inflated(bencher: Bencher) {
    count(bencher, &BUMPS.arcs, |arc| THEIRS.wide_inflated.find(arc));
}

#[divan::bench]
fn arcs_bvh2_inflated(bencher: Bencher) {
    count(bencher, &BUMPS.arcs, |arc| THEIRS.binary_inflated.find(arc));
}

#[divan::bench]
fn rays_bvh2(bencher: Bencher) {
    count(bencher, &BUMPS.lines, |line| THEIRS.binary.find(line));
}

#[divan::bench]
fn rays_walk(bencher: Bencher) {
    count(bencher, &BUMPS.lines, walk);
}

#[divan::bench]
fn rays_cwbvh(bencher: Bencher) {
    count(bencher, &BUMPS.lines, |line| THEIRS.wide.find(line));
}

#[divan::bench]
fn rays_cwbvh_inflated(bencher: Bencher) {
    count(bencher, &BUMPS.lines, |line| THEIRS.wide_inflated.find(line));
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
            let s = segment.cross_triangle(&self.triangles[slot], false);
            if s == f64::INFINITY {
                return f32::INFINITY;
            }
            nearest = Some(nearest.map_or(s, |best| best.min(s)));
            (segment.point(s) - start).dot(direction) as f32
        });
        nearest
    }
}
