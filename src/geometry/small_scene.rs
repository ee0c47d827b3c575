//! Scenes of few primitives: no hierarchy, each primitive is tested against blocks of segments, lane beside lane.
//!
//! Planes and lines give their crossing at once. Where an arc may cross a sphere is decided side by side, too, by the
//! signs of a polynomial; the few that do are queued, and their roots are found in full blocks.

use glam::DVec3;

use super::facets::Foremost;
use super::line::LineBlock;
use super::query::{Need, Query, QueryBlock};
use super::scene::Item;
use super::sphere::FromStart;
use super::{Finds, Found, Geometry, Line, PrimitiveId, Segment, Sphere, Triangle};
use crate::geodesic::Arc;
use crate::math::bernstein::{Isolated, bracketed_roots, isolated};
use crate::math::columns::{Field, LANES, Row};
use crate::math::kernel::widest;

/// Shift that makes a segment NaN, so that it meets nothing.
const NOWHERE: DVec3 = DVec3::NAN;

/// First crossings of the segments of a block.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    /// Parameters; infinite where there is none.
    s: [f64; LANES],
    /// Slots of the primitives crossed.
    slot: [u32; LANES],
}

/// A segment that crosses a sphere, and what changes its sign there.
#[derive(Clone, Copy, Debug)]
struct Pending {
    lane: u32,
    slot: u32,
    along: Isolated<5>,
}

/// Spheres that are screened before any crossing is looked for, at most: a bit for each and each lane.
const MOST: usize = u128::BITS as usize / LANES;
const _: () = assert!(<Arc as SideBySide>::FEW <= MOST);

/// Candidate crossings of spheres by the segments of a block, examined when all spheres have been screened: a branch
/// for each would be as good as random.
#[derive(Default)]
pub struct Culled {
    count: usize,
    slots: [u32; MOST],
    /// Polynomial that changes its sign where a segment crosses, as Bernstein coefficients by lane.
    along: [[[f64; LANES]; 5]; MOST],
    /// By sphere and lane, whether the coefficients differ in sign.
    may: u128,
}

impl Culled {
    #[inline(always)]
    fn clear(&mut self) {
        (self.count, self.may) = (0, 0);
    }

    /// Adds the sphere in a slot; `may` has a byte a lane, 0 or 1.
    #[inline(always)]
    fn push(&mut self, slot: u32, along: [[f64; LANES]; 5], may: [u8; LANES]) {
        let at = self.count % MOST;
        // The product gathers the bytes' lowest bits in its highest byte.
        let bits = u64::from_le_bytes(may).wrapping_mul(0x0102_0408_1020_4080) >> (u64::BITS - u8::BITS);
        (self.slots[at], self.along[at]) = (slot, along);
        self.may |= u128::from(bits) << (at * LANES);
        self.count += 1;
    }

    /// Takes the next slot, lane and coefficients.
    #[inline(always)]
    fn pop(&mut self) -> Option<(u32, usize, [f64; 5])> {
        if self.may == 0 {
            return None;
        }
        let bit = self.may.trailing_zeros() as usize % (MOST * LANES);
        self.may &= self.may - 1;
        let (at, lane) = (bit / LANES, bit % LANES);
        Some((self.slots[at], lane, std::array::from_fn(|k| self.along[at][k][lane])))
    }
}

/// First hits of segments. Its memory is used again from round to round.
#[derive(Default)]
pub struct SmallScene {
    foremost: Vec<Foremost>,
    best: Vec<Crossings>,
    pending: Vec<Pending>,
    screened: Culled,
}

impl SmallScene {
    /// Searches the first `lanes` lanes of blocks of queries; `near_start` are those whose first crossing is near their
    /// start. Only where there are [few](Geometry::is_small) primitives.
    pub fn search<S: SideBySide>(
        &mut self,
        geometry: &Geometry,
        (queries, lanes): (&[<Query<S> as Row>::Block], usize),
        found: &mut Finds,
        near_start: &mut Vec<usize>,
    ) {
        widest(Searching::<S> { geometry, queries, lanes, few: self, found, near_start });
    }
}

/// A segment whose crossings of primitives are found side by side.
pub trait SideBySide: Segment + Row {
    /// Up to this many primitives are tested side by side: beyond, a hierarchy is faster.
    const FEW: usize;
    /// Triangles that take the time of another primitive.
    const TRIANGLES: usize;

    /// Segment with all that is the same for all spheres.
    type Prepared: Row;

    /// The segment, prepared.
    fn prepared(&self) -> Self::Prepared;

    /// Takes crossings of the sphere in a slot into account if they are found at once; else they are `screened`. With the
    /// segments come the slots that they start on.
    fn consider_sphere(
        geometry: &Geometry,
        segments: (&<Self::Prepared as Row>::Block, &[u64; LANES]),
        sphere: (Sphere, u32),
        first: &mut Crossings,
        screened: &mut Culled,
    );

    /// The segments as lines, if they are: these are screened side by side for the triangle that they meet first.
    #[inline(always)]
    fn lines(_: &Self::Block) -> Option<&LineBlock> {
        None
    }
}

impl SideBySide for Line {
    const FEW: usize = 16;
    const TRIANGLES: usize = 6;
    type Prepared = Line;

    #[inline(always)]
    fn prepared(&self) -> Line {
        *self
    }

    #[inline(always)]
    fn consider_sphere(
        geometry: &Geometry,
        (lines, own): (&<Line as Row>::Block, &[u64; LANES]),
        (sphere, slot): (Sphere, u32),
        first: &mut Crossings,
        _: &mut Culled,
    ) {
        let mut s = [f64::INFINITY; LANES];
        for lane in 0..LANES {
            s[lane] = Line::get(lines, lane).cross_sphere(&sphere, own[lane] == u64::from(slot));
        }
        first.consider_all(geometry, slot, &s);
    }

    #[inline(always)]
    fn lines(lines: &LineBlock) -> Option<&LineBlock> {
        Some(lines)
    }
}

/// Looks which triangles segments may meet first that are lines.
#[inline(always)]
fn foremost<S: SideBySide>(geometry: &Geometry, queries: &[QueryBlock<S::Block>], found: &mut Vec<Foremost>) {
    let line = |block: usize, lane: usize| {
        let queries = &queries[block];
        let line = S::lines(&queries.segment).map_or(Line::default(), |lines| Line::get(lines, lane));
        (line.shifted(queries.shift(geometry, lane)), own_slot(queries.origin_prim[lane]) as u32)
    };
    geometry.facets.all_foremost(queries.len(), line, found);
}

/// Takes crossings of the triangles that lines may meet first into account. With the lines come the slots that they start
/// on.
#[inline(always)]
fn cross_foremost(
    geometry: &Geometry,
    (lines, own): (&LineBlock, &[u64; LANES]),
    Foremost { slot, next }: &Foremost,
    first: &mut Crossings,
) {
    let mut triangles = <Triangle as Row>::Block::default();
    for (lane, &slot) in slot.iter().enumerate() {
        let is_any = slot != Foremost::NONE;
        let triangle = if is_any { geometry.triangle(slot) } else { Triangle::NOWHERE };
        Triangle::set(&mut triangles, lane, triangle);
    }
    let mut s = [0.0; LANES];
    for (lane, s) in s.iter_mut().enumerate() {
        *s = Line::get(lines, lane).cross_triangle(&Triangle::get(&triangles, lane), false);
    }
    for lane in 0..LANES {
        if s[lane] < f64::from(next[lane]) {
            first.consider(geometry, lane, slot[lane], s[lane]);
        } else if slot[lane] != Foremost::NONE && next[lane] < f32::INFINITY {
            all_triangles(geometry, &Line::get(lines, lane), (lane, own[lane] as u32), first);
        }
    }
}

/// Takes crossings of all triangles by the line of a lane into account.
#[cold]
#[inline(never)]
fn all_triangles(geometry: &Geometry, line: &Line, (lane, own): (usize, u32), first: &mut Crossings) {
    for slot in geometry.facets.slots() {
        let s = line.cross_triangle(&geometry.triangle(slot), slot == own);
        first.consider(geometry, lane, slot, s);
    }
}

impl SideBySide for Arc {
    const FEW: usize = 12;
    const TRIANGLES: usize = 1;
    type Prepared = FromStart;

    #[inline(always)]
    fn prepared(&self) -> FromStart {
        FromStart::of(self)
    }

    #[inline(always)]
    fn consider_sphere(
        _: &Geometry,
        (arcs, own): (&<FromStart as Row>::Block, &[u64; LANES]),
        (sphere, slot): (Sphere, u32),
        _: &mut Crossings,
        screened: &mut Culled,
    ) {
        let number = u64::from(slot);
        // Most blocks have no segment that starts on the sphere.
        let (along, may) = match own.contains(&number) {
            true => cull(arcs, &sphere, |lane| own[lane] == number),
            false => cull(arcs, &sphere, |_| false),
        };
        screened.push(slot, along, may);
    }
}

/// Takes crossings of all triangles into account. With the segments come the slots that they start on.
#[inline(always)]
fn cross_triangles<S: SideBySide>(
    geometry: &Geometry,
    (segments, own): (&S::Block, &[u64; LANES]),
    first: &mut Crossings,
) {
    for slot in geometry.facets.slots() {
        let triangle = geometry.triangle(slot);
        let mut s = [f64::INFINITY; LANES];
        for lane in 0..LANES {
            s[lane] = S::get(segments, lane).cross_triangle(&triangle, own[lane] == u64::from(slot));
        }
        first.consider_all(geometry, slot, &s);
    }
}

/// Culls the arcs of a block against a sphere: the polynomials that change their sign where the arcs cross it, as
/// Bernstein coefficients, and by lane 1 if they have not all the same sign, else 0.
#[inline(always)]
fn cull(
    arcs: &<FromStart as Row>::Block,
    sphere: &Sphere,
    origin_prim: impl Fn(usize) -> bool,
) -> ([[f64; LANES]; 5], [u8; LANES]) {
    let (mut along, mut may) = ([[0.0; LANES]; 5], [0; LANES]);
    let (center, radius2) = (sphere.center, sphere.radius * sphere.radius);
    for lane in 0..LANES {
        let c = FromStart::get(arcs, lane).along(center, radius2, origin_prim(lane));
        let (mut least, mut most) = (c[0], c[0]);
        for (along, c) in along.iter_mut().zip(c) {
            along[lane] = c;
            least = if c < least { c } else { least };
            most = if c > most { c } else { most };
        }
        may[lane] = u8::from((least < 0.0) & (most >= 0.0));
    }
    (along, may)
}

impl Geometry {
    /// True if segments of this kind are tested against all primitives side by side.
    pub fn is_small<S: SideBySide>(&self) -> bool {
        let triangles = self.bvh.len() - self.others.len();
        self.others.len() * S::TRIANGLES + triangles <= S::FEW * S::TRIANGLES
            && !self.others.iter().any(|item| matches!(item, Item::Instance(_)))
    }

    /// True if slot `a` was given before slot `b`.
    #[inline(always)]
    fn is_given_before(&self, a: u32, b: u32) -> bool {
        let order = self.bvh.order();
        order[a as usize] < order[b as usize]
    }
}

struct Searching<'a, S: SideBySide> {
    geometry: &'a Geometry,
    queries: &'a [QueryBlock<S::Block>],
    lanes: usize,
    few: &'a mut SmallScene,
    found: &'a mut Finds,
    near_start: &'a mut Vec<usize>,
}

impl<S: SideBySide> pulp::NullaryFnOnce for Searching<'_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Searching { geometry, queries, lanes, few, found, near_start } = self;
        let SmallScene { foremost, best, pending, screened } = few;
        best.clear();
        pending.clear();
        if !S::BENDS && !geometry.facets.is_empty() {
            self::foremost::<S>(geometry, queries, foremost);
        }
        for (number, queries) in queries.iter().enumerate() {
            screened.clear();
            let first = first_crossings::<S>(geometry, (queries, foremost.get(number)), screened);
            while let Some((slot, lane, along)) = screened.pop() {
                if let Some(along) = isolated(along) {
                    pending.push(Pending { lane: (number * LANES + lane) as u32, slot, along });
                }
            }
            best.push(first);
        }
        for some in pending.chunks(LANES) {
            let mut along = [[0.0; LANES]; 5];
            for lane in 0..LANES {
                // Lanes to spare repeat the last.
                let c = some[lane.min(some.len() - 1)].along.c;
                (0..5).for_each(|k| along[k][lane] = c[k]);
            }
            let roots = bracketed_roots(&along);
            for (&Pending { lane, slot, along }, root) in some.iter().zip(roots) {
                let s = along.place(root);
                best[lane as usize / LANES].consider(geometry, lane as usize % LANES, slot, s);
            }
        }
        for (number, (queries, Crossings { s, slot })) in queries.iter().zip(best.iter()).enumerate() {
            let (mut points, mut is_near) = (DVec3::block::<LANES>(), [false; LANES]);
            for lane in 0..LANES {
                let segment = S::get(&queries.segment, lane);
                let point = segment.point(s[lane]);
                Field::set(&mut points, lane, point);
                is_near[lane] = geometry.is_near_start(segment.chord().start, point);
            }
            for lane in 0..LANES.min(lanes - number * LANES) {
                let primitive = PrimitiveId { item: slot[lane], triangle: 0 };
                let point = <DVec3 as Field>::get(&points, lane);
                let at = number * LANES + lane;
                if is_near[lane] {
                    near_start.push(at);
                } else if s[lane] < f64::INFINITY {
                    found.add(at, Found { point, primitive });
                }
            }
        }
    }
}

/// First crossings of the segments of a block, as far as they are found at once; the others are `screened`.
#[inline(always)]
fn first_crossings<S: SideBySide>(
    geometry: &Geometry,
    (queries, foremost): (&QueryBlock<S::Block>, Option<&Foremost>),
    screened: &mut Culled,
) -> Crossings {
    let (mut segments, mut prepared) = (S::Block::default(), <S::Prepared as Row>::Block::default());
    for lane in 0..LANES {
        let segment = S::get(&queries.segment, lane).shifted(queries.shift(geometry, lane));
        S::set(&mut segments, lane, segment);
        S::Prepared::set(&mut prepared, lane, segment.prepared());
    }
    let own = queries.origin_prim.map(own_slot);
    let mut best = Crossings { s: [f64::INFINITY; LANES], slot: [0; LANES] };
    for (slot, item) in geometry.others() {
        match item {
            Item::Sphere(i) => {
                let sphere = (geometry.spheres[i as usize].0, slot);
                S::consider_sphere(geometry, (&prepared, &own), sphere, &mut best, screened);
            }
            Item::Disk(i) => {
                let disk = geometry.disks[i as usize].0;
                let mut s = [f64::INFINITY; LANES];
                for lane in 0..LANES {
                    s[lane] = S::get(&segments, lane).cross_disk(&disk, own[lane] == u64::from(slot));
                }
                best.consider_all(geometry, slot, &s);
            }
            Item::Triangle(_) | Item::Instance(_) => {}
        }
    }
    match (S::lines(&segments), foremost) {
        _ if geometry.facets.is_empty() => {}
        (Some(lines), Some(foremost)) => cross_foremost(geometry, (lines, &own), foremost, &mut best),
        _ => cross_triangles::<S>(geometry, (&segments, &own), &mut best),
    }
    best
}

impl<B> QueryBlock<B> {
    /// Shift of a lane's segment to the origin of the geometry; to nowhere if it need not be searched.
    #[inline(always)]
    fn shift(&self, geometry: &Geometry, lane: usize) -> DVec3 {
        if self.need[lane] == Need::Whole { -geometry.origin } else { NOWHERE }
    }
}

/// Slot of what a segment starts on; any other if that is nothing.
#[inline(always)]
fn own_slot(PrimitiveId { item, triangle }: PrimitiveId) -> u64 {
    match triangle {
        0 => u64::from(item),
        _ => u64::MAX,
    }
}

impl Crossings {
    /// Takes crossings of the primitive in a slot into account, by lane.
    #[inline(always)]
    pub(super) fn consider_all(&mut self, geometry: &Geometry, slot: u32, s: &[f64; LANES]) {
        if *s != [f64::INFINITY; LANES] {
            (0..LANES).for_each(|lane| self.consider(geometry, lane, slot, s[lane]));
        }
    }

    /// Takes a crossing at `s` if it is the first, or at the same place as the first and given before it.
    #[inline(always)]
    fn consider(&mut self, geometry: &Geometry, lane: usize, slot: u32, s: f64) {
        let best = self.s[lane];
        let is_tie = s == best && s < f64::INFINITY;
        if s < best || (is_tie && geometry.is_given_before(slot, self.slot[lane])) {
            (self.s[lane], self.slot[lane]) = (s, slot);
        }
    }
}
