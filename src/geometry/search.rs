//! Searches of many segments at once.
//!
//! With few primitives, segments are tested side by side ([`small_scene`](super::small_scene)). Otherwise each is taken
//! through the hierarchy, several interleaved: while one waits for memory, others go on.

use obvhs::faststack::HeapStack;

use super::bvh::Walk;
use super::nearest::Nearest;
use super::query::{Need, Query, Sought};
use super::scene::{Geometry, Hit, PrimitiveId};
use super::small_scene::SmallScene;
use super::{Finds, Found, Segment, SideBySide};
use crate::math::columns::Columns;
use crate::math::simd8::{Simd8, Simd8Work, with_simd8};
use crate::spacetime::Side;

/// Segments to be searched and what they meet first. Its memory is used again from round to round.
pub struct Search<S: SideBySide> {
    /// Queries to search.
    pub queries: Columns<Query<S>>,
    /// The first crossings; nothing for what is not to be searched as a whole.
    pub found: Finds,
    few: SmallScene,
    /// Lanes whose first crossing is near their start.
    near_start: Vec<usize>,
    part: SideQueries<S>,
}

/// The queries on one side of a wormhole.
struct SideQueries<S: SideBySide> {
    lanes: Vec<usize>,
    queries: Columns<Query<S>>,
    found: Finds,
}

/// Queries for each that is put together with others for a search side by side, at least.
const SPARSE: usize = 3;
/// Interleaved traversals: enough that what the next of them visits has come when it is its turn. Measured.
const TURNS: usize = 8;
/// Bytes of a hierarchy with its triangles that stay in a core's cache: one traversal after the other is faster then.
/// Measured.
const IN_CACHE: usize = 5 << 19;

impl<S: SideBySide> Default for Search<S> {
    fn default() -> Self {
        let part = SideQueries { lanes: Vec::new(), queries: Columns::default(), found: Finds::default() };
        Self {
            queries: Columns::default(),
            found: Finds::default(),
            few: SmallScene::default(),
            near_start: Vec::new(),
            part,
        }
    }
}

impl Geometry {
    /// Searches the first `lanes` queries of `search`, each on the side of the primitive that it starts on.
    pub fn search_all<S: SideBySide>(&self, search: &mut Search<S>, lanes: usize) {
        self.seek_all(search, lanes, |_| Sought::First);
    }

    /// [`Self::search_all`] of queries by lane that need not find the first crossing, if what they find tells whether what
    /// is `sought` by them is so.
    pub fn seek_all<S: SideBySide>(
        &self,
        search: &mut Search<S>,
        lanes: usize,
        sought: impl Fn(usize) -> Sought,
    ) {
        let Search { queries, found, few, near_start, part } = search;
        if self.far.is_none() && !self.are_worth_gathering(queries, lanes) {
            return self.search_own((queries, sought), found, (few, near_start), lanes);
        }
        found.reset(lanes);
        for side in Side::BOTH {
            let Some(geometry) = self.of(side) else { continue };
            let is_on = |query: &Query<S>| query.need == Need::Whole && query.origin_prim.side() == side;
            part.lanes.clear();
            part.lanes.extend(queries.lanes_where(lanes, is_on));
            part.queries.gather(part.lanes.len(), |i| {
                let query = queries.get(part.lanes[i]);
                Query { origin_prim: query.origin_prim.on(Side::Near), ..query }
            });
            let lanes = part.lanes.len();
            let sought = |lane: usize| sought(part.lanes[lane]);
            geometry.search_own((&part.queries, sought), &mut part.found, (few, near_start), lanes);
            for (i, hit) in part.found.iter() {
                found.add(part.lanes[i], Found { primitive: hit.primitive.on(side), ..hit });
            }
        }
    }

    /// True if queries are tested side by side, and so few of them need a search that others would cost more than to
    /// put these together.
    fn are_worth_gathering<S: SideBySide>(&self, queries: &Columns<Query<S>>, lanes: usize) -> bool {
        if !self.is_small::<S>() {
            return false;
        }
        let needed = queries.lanes_where(lanes, |query| query.need == Need::Whole).count();
        SPARSE * needed < lanes
    }

    /// Searches the first `lanes` of `queries` on the near side.
    fn search_own<S: SideBySide>(
        &self,
        (queries, sought): (&Columns<Query<S>>, impl Fn(usize) -> Sought),
        found: &mut Finds,
        (few, near_start): (&mut SmallScene, &mut Vec<usize>),
        lanes: usize,
    ) {
        near_start.clear();
        found.reset(lanes);
        if self.is_small::<S>() {
            few.search::<S>(self, (queries.blocks(lanes), lanes), found, near_start);
        } else {
            with_simd8(Traversal { geometry: self, queries, lanes, sought, found, near_start });
        }
        for &lane in near_start.iter() {
            if let Some(first) = self.found_near_start(&queries.get(lane)) {
                found.add(lane, first);
            }
        }
    }

    /// First hit of a query whose first crossing is near its start: primitives that coincide there with the one that it
    /// leaves are left as well.
    #[cold]
    #[inline(never)]
    fn found_near_start<S: SideBySide>(&self, query: &Query<S>) -> Option<Found> {
        let Hit { s, primitive } = self.own_intersection(&query.segment, query.origin_prim)?;
        Some(Found { point: query.segment.point(s), primitive })
    }
}

/// Takes all queries through the hierarchy.
struct Traversal<'a, S: SideBySide, F> {
    geometry: &'a Geometry,
    queries: &'a Columns<Query<S>>,
    lanes: usize,
    sought: F,
    found: &'a mut Finds,
    near_start: &'a mut Vec<usize>,
}

/// A walk with what it looks for, and for which lane.
struct LaneWalk<'a, S> {
    walk: Walk<HeapStack<u64>>,
    nearest: Nearest<'a, S, PrimitiveId>,
    lane: usize,
}

impl<'a, S: SideBySide> LaneWalk<'a, S> {
    /// A walk that is over.
    #[inline(always)]
    fn new(geometry: &'a Geometry) -> Self {
        let walk = Walk::new(HeapStack::new_with_capacity(geometry.bvh.pending()));
        Self { walk, nearest: Nearest::new(geometry, &S::default(), PrimitiveId::NONE), lane: 0 }
    }
}

impl<S: SideBySide, F: Fn(usize) -> Sought> Simd8Work for Traversal<'_, S, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd8>(self, simd: V) {
        let bytes = self.geometry.bvh.memory_bytes() + self.geometry.triangles.memory_bytes();
        if bytes < IN_CACHE { self.one_by_one(simd) } else { self.interleaved(simd) }
    }
}

impl<S: SideBySide, F: Fn(usize) -> Sought> Traversal<'_, S, F> {
    /// In a loop of its own, so that what a walk needs stays in registers.
    #[inline(always)]
    fn one_by_one<V: Simd8>(self, simd: V) {
        let Traversal { geometry, queries, lanes, sought, found, near_start } = self;
        let mut walk = Walk::new(HeapStack::new_with_capacity(geometry.bvh.pending()));
        for lane in 0..lanes {
            let Query { segment, origin_prim, need } = queries.get(lane);
            if need != Need::Whole {
                continue;
            }
            let mut nearest = Nearest::new(geometry, &segment, origin_prim);
            nearest.seek(sought(lane));
            walk.start(simd, &geometry.bvh, &nearest.chord(), nearest.until(), &mut nearest);
            while walk.is_on {
                walk.step(simd, &geometry.bvh, &mut nearest);
            }
            nearest.settle();
            add_found(&nearest, (&segment, lane), found, near_start);
        }
    }

    /// Several at once, a visit of each in turn.
    #[inline(always)]
    fn interleaved<V: Simd8>(self, simd: V) {
        let Traversal { geometry, queries, lanes, sought, found, near_start } = self;
        let bvh = &geometry.bvh;
        // In no array: their loop, written out, would be slower by 2 %.
        let mut walks: Vec<LaneWalk<S>> = (0..TURNS).map(|_| LaneWalk::new(geometry)).collect();
        let (mut lane, mut busy) = (0, true);
        while busy || lane < lanes {
            busy = false;
            for lane_walk in &mut walks {
                if !lane_walk.walk.is_on {
                    let Some(next) = (lane..lanes).find(|&lane| queries.get(lane).need == Need::Whole) else {
                        lane = lanes;
                        continue;
                    };
                    lane = next + 1;
                    let Query { segment, origin_prim, .. } = queries.get(next);
                    lane_walk.lane = next;
                    lane_walk.nearest = Nearest::new(geometry, &segment, origin_prim);
                    lane_walk.nearest.seek(sought(next));
                    let LaneWalk { walk, nearest, .. } = lane_walk;
                    walk.start(simd, bvh, &nearest.chord(), nearest.until(), nearest);
                } else {
                    lane_walk.walk.step(simd, bvh, &mut lane_walk.nearest);
                }
                if lane_walk.walk.is_on {
                    lane_walk.walk.prefetch(bvh, &lane_walk.nearest);
                    busy = true;
                } else {
                    let LaneWalk { lane, nearest, .. } = lane_walk;
                    let segment = queries.get(*lane).segment;
                    nearest.settle();
                    add_found(nearest, (&segment, *lane), found, near_start);
                }
            }
        }
    }
}

/// Adds what a walk along the segment of a lane found to the others, or the lane to those where that is near its start.
#[inline(always)]
fn add_found<S: Segment>(
    nearest: &Nearest<S, PrimitiveId>,
    (segment, lane): (&S, usize),
    found: &mut Finds,
    near_start: &mut Vec<usize>,
) {
    let Some(Hit { s, primitive }) = nearest.hit else { return };
    let point = segment.point(s);
    if nearest.geometry.is_near_start(segment.chord().start, point) {
        near_start.push(lane);
    } else {
        found.add(lane, Found { point, primitive });
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use super::*;
    use crate::geodesic::Arc;
    use crate::geometry::{Instance, Line, Mesh, Primitives, Sphere, Surface};

    const LANES: usize = 30;

    /// Segments that are searched together meet what each of them meets by itself.
    fn check<S: SideBySide>(geometry: &Geometry, segment: impl Fn(usize) -> S) {
        let query = |i| Query { segment: segment(i), origin_prim: PrimitiveId::NONE, need: Need::Whole };
        let mut search = Search::default();
        search.queries.gather(LANES, query);
        geometry.search_all(&mut search, LANES);
        for i in 0..LANES {
            let alone = geometry.intersect_brute_force(&segment(i), PrimitiveId::NONE);
            let alone = alone.map(|Hit { s, primitive }| Found { point: segment(i).point(s), primitive });
            assert_eq!(search.found.get(i), alone, "segment {i}");
        }
        assert!(search.found.iter().next().is_some());
        // Few among others that need no search.
        let all = std::mem::take(&mut search.found);
        let is_needed = |i: usize| i % 4 == 1;
        search.queries.gather(LANES, |i| {
            let need = if is_needed(i) { Need::Whole } else { Need::Nothing };
            Query { need, ..query(i) }
        });
        geometry.search_all(&mut search, LANES);
        for i in 0..LANES {
            assert_eq!(search.found.get(i), all.get(i).filter(|_| is_needed(i)), "segment {i} among few");
        }
    }

    #[test]
    fn any_number_of_spheres_can_be_searched() {
        for count in 1..40 {
            let surface = Surface { material: 0, entity: 0 };
            let sphere = |i: u32| (Sphere { center: 2.0 * f64::from(i) * DVec3::Z, radius: 0.9 }, surface);
            let spheres = (0..count).map(sphere).collect();
            let geometry = Geometry::build(Primitives { spheres, ..Primitives::default() });
            let ends = |i: usize| {
                let (sin, cos) = (1.7 * i as f64).sin_cos();
                (DVec3::new(9.0, cos, 2.0 * i as f64), DVec3::new(-9.0, sin, 3.0 * i as f64 * cos))
            };
            check(&geometry, |i| Line { p0: ends(i).0, p2: ends(i).1 });
            check(&geometry, |i| Arc { p0: ends(i).0, p1: 3.0 * DVec3::Y, p2: ends(i).1, w: 0.5 });
        }
    }

    #[test]
    fn any_number_of_triangles_can_be_searched() {
        for columns in 1..30 {
            // A strip of squares, two triangles each, with a second strip upon it and a third beyond.
            let corners = |layer: u32| (0..=columns).flat_map(move |x| [0, 1].map(|y| [x, y, layer / 2]));
            let positions = (0..3).flat_map(corners).map(|corner| corner.map(|x| x as f32)).collect();
            let square = |at: u32| [[at, at + 2, at + 3], [at, at + 3, at + 1]];
            let strip = |layer: u32| (0..columns).flat_map(move |x| square(2 * (layer * (columns + 1) + x)));
            let triangles = (0..3).flat_map(strip).collect();
            let meshes = vec![Mesh { positions, triangles, ..Mesh::default() }];
            let surface = Surface { material: 0, entity: 0 };
            let instances = vec![(Instance { mesh: 0, to_world: DAffine3::IDENTITY }, surface)];
            let geometry = Geometry::build(Primitives { meshes, instances, ..Primitives::default() });
            // Through corners, edges, diagonals and insides, and across.
            let places = |i: usize| DVec3::new(0.25 * (i % 8) as f64, 0.25 * (i / 8) as f64, 0.0);
            let ends = |i: usize| (places(i) - 2.0 * DVec3::Z, places(i) + 3.0 * DVec3::Z);
            check(&geometry, |i| Line { p0: ends(i).0, p2: ends(i).1 });
            check(&geometry, |i| Line { p0: ends(i).1, p2: ends(i).0 });
            check(&geometry, |i| Line { p0: ends(i).0, p2: ends(3 * i % LANES).1 });
            check(&geometry, |i| {
                let (p0, p2) = ends(i);
                Arc { p0, p1: 0.5 * (p0 + p2) + 0.1 * DVec3::X, p2, w: 0.9 }
            });
        }
    }

    #[test]
    fn lines_that_leave_one_of_few_triangles_meet_the_others() {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let meshes = vec![Mesh { positions, triangles: vec![[0, 1, 2], [1, 3, 2]], ..Mesh::default() }];
        let surface = Surface { material: 0, entity: 0 };
        let sphere = Sphere { center: DVec3::new(0.2, 0.2, 2.0), radius: 0.5 };
        let instances = vec![(Instance { mesh: 0, to_world: DAffine3::IDENTITY }, surface)];
        let geometry = Geometry::build(Primitives {
            spheres: vec![(sphere, surface)],
            meshes,
            instances,
            ..Primitives::default()
        });
        let start = DVec3::new(0.2, 0.2, 0.0);
        let onto = Line { p0: start + DVec3::Z, p2: start - DVec3::Z };
        let own = geometry.intersect(&onto, PrimitiveId::NONE).expect("a hit").primitive;
        let mut search = Search::default();
        search.queries.gather(LANES, |i| {
            let up = Line { p0: start, p2: start + 4.0 * DVec3::Z };
            let segment = if i % 2 == 0 { up } else { Line { p2: start - DVec3::Z, ..up } };
            Query { segment, origin_prim: own, need: if i == 4 { Need::Nothing } else { Need::Whole } }
        });
        geometry.search_all(&mut search, LANES);
        for i in 0..LANES {
            let meets = i % 2 == 0 && i != 4;
            assert_eq!(
                search.found.get(i).map(|found| found.point),
                meets.then_some(DVec3::new(0.2, 0.2, 1.5)),
                "line {i}"
            );
        }
    }

    #[test]
    fn the_first_crossing_tells_what_is_sought_as_less_does() {
        const TRIANGLES: u32 = 500;
        let mut state = 3u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut point = |size: f64| size * DVec3::new(random() - 0.5, random() - 0.5, random() - 0.5);
        let middles: Vec<DVec3> = (0..TRIANGLES).map(|_| point(4.0)).collect();
        let corners = middles.iter().flat_map(|&middle| [middle; 3]);
        let positions = corners.map(|middle| (middle + point(1.0)).as_vec3().to_array()).collect();
        let triangles = (0..TRIANGLES).map(|i| [0, 1, 2].map(|corner| 3 * i + corner)).collect();
        let surface = Surface { material: 0, entity: 0 };
        let geometry = Geometry::build(Primitives {
            meshes: vec![Mesh { positions, triangles, ..Mesh::default() }],
            instances: vec![(Instance { mesh: 0, to_world: DAffine3::IDENTITY }, surface)],
            ..Primitives::default()
        });
        let primitives: Vec<PrimitiveId> =
            geometry.members().map(|(item, _)| PrimitiveId { item, triangle: 0 }).collect();
        const LINES: usize = 3000;
        let lines: Vec<Line> = (0..LINES).map(|_| Line { p0: point(5.0), p2: point(5.0) }).collect();
        let mut search = Search::default();
        search.queries.gather(LINES, |i| Query {
            segment: lines[i],
            origin_prim: PrimitiveId::NONE,
            need: Need::Whole,
        });
        geometry.search_all(&mut search, LINES);
        let first = std::mem::take(&mut search.found);
        let part = |i: usize| (i % 97) as f64 / 97.0;
        let sought = |i: usize| match (i % 4, first.get(i)) {
            (0, _) => Sought::First,
            (1, _) => Sought::Nothing,
            (2, _) => Sought::Point(lines[i].point(part(i))),
            (_, Some(found)) if i % 8 == 3 => Sought::Primitive(found.primitive),
            (_, _) => Sought::Primitive(primitives[i % primitives.len()]),
        };
        geometry.seek_all(&mut search, LINES, sought);
        let mut counts = [0; 4];
        for (i, (less, first)) in (0..LINES).map(|i| (i, (search.found.get(i), first.get(i)))) {
            let is_before = |found: Option<Found>| {
                found.is_some_and(|found| lines[i].parameter_beside(found.point) < part(i))
            };
            let (told, is_so) = match sought(i) {
                Sought::First => (less == first, true),
                Sought::Nothing => (less.is_none(), first.is_none()),
                Sought::Point(_) => (!is_before(less), !is_before(first)),
                Sought::Primitive(primitive) => {
                    let is_met = |found: Option<Found>| found.filter(|found| found.primitive == primitive);
                    assert_eq!(is_met(less), is_met(first), "line {i}");
                    (is_met(less).is_some(), is_met(first).is_some())
                }
            };
            assert_eq!(told, is_so, "line {i}");
            counts[i % 4] += usize::from(is_so);
        }
        assert!(counts.iter().all(|&count| (50..=LINES / 4).contains(&count)), "{counts:?}");
    }
}
