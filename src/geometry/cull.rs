//! Conservative test for the triangles of a block that a segment may cross, in f32, lane beside lane: few are left to
//! be tested exactly.
//!
//! A segment, which turns by less than half a circle, is its chord, moved by a part of its bow. So where it crosses a
//! triangle some of these lines pass inside the triangle's edges, and they do not all stay on one side of its plane.
//! Signed volumes tell (Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection"): they change in
//! proportion with the part of the bow, and their rounding widens the triangle by some ulps of the coordinates.

use glam::Vec3;

use super::Chord;
use super::triangle::TriangleBlock;
use crate::math::columns::LANES;
use crate::math::simd8::Simd8;

/// A chord to be screened.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cull {
    start: Vec3,
    along: Vec3,
    bow: Vec3,
    /// bow × along.
    sweep: Vec3,
    /// Largest component of the chord.
    reach: f32,
    /// Distance that decides nothing, less what the rounding of the triangle's place adds.
    room: f32,
}

/// Rounding of a volume beside the product of the largest components of its factors: a dozen roundings of half an
/// epsilon of six products; thrice that.
pub(super) const ROUNDING: f32 = 64.0 * f32::EPSILON;
/// Volumes below this may have lost digits to the range of f32.
const SMALLEST: f32 = 1e-30;
/// Beyond this the product of three lengths leaves the range of f32.
pub(super) const LARGEST: f32 = 1e12;

impl Cull {
    /// Room for a chord.
    #[inline(always)]
    pub fn new(chord: &Chord) -> Self {
        let (start, along) = (chord.start.as_vec3(), (chord.end - chord.start).as_vec3());
        let (bow, reach) = (chord.bow.as_vec3(), largest(along));
        let room = ROUNDING * (largest(start) + reach + largest(bow));
        Self { start, along, bow, sweep: bow.cross(along), reach, room }
    }

    /// Lanes whose triangles the segment may cross before a part of its chord that is at least `until`, a bit each.
    #[inline(always)]
    pub fn may_cross<V: Simd8>(&self, simd: V, triangles: &TriangleBlock, until: f32) -> u32 {
        let Cull { start, along, bow, sweep, reach, room } = *self;
        let splat = |v: Vec3| [simd.splat(v.x), simd.splat(v.y), simd.splat(v.z)];
        let [a, b, c] = triangles.corners(simd);
        let (e1, e2, from) = (simd.minus(b, a), simd.minus(c, a), simd.minus(splat(start), a));
        let (p, q) = (simd.cross(splat(along), e2), simd.cross(from, e1));
        let (whole, u, v) = (simd.dot(e1, p), simd.dot(from, p), simd.dot(splat(along), q));
        let w = simd.sub(whole, simd.add(u, v));
        let first = simd.dot(e2, q);
        let last = simd.sub(first, simd.mul(simd.splat(until), whole));
        // How much the whole bow adds to them.
        let (more_u, less_v) = (simd.dot(splat(sweep), e2), simd.dot(splat(sweep), e1));
        let more_height = simd.dot(e2, simd.cross(splat(bow), e1));
        let zero = simd.splat(0.0);
        let (more_v, more_w) = (simd.sub(zero, less_v), simd.sub(less_v, more_u));
        let (edge, far) = (simd.max(simd.largest(e1), simd.largest(e2)), simd.largest(from));
        // `from` is a difference of places that are rounded themselves.
        let rounding = simd.mul(simd.mul_add(simd.splat(ROUNDING), far, simd.splat(room)), edge);
        let (inside, beside) = (simd.mul(rounding, simd.splat(reach)), simd.mul(rounding, edge));
        let at_most = |volume, more| simd.add(volume, simd.max(more, zero));
        let at_least = |volume, more| simd.add(volume, simd.min(more, zero));
        let most = simd.min(simd.min(at_most(u, more_u), at_most(v, more_v)), at_most(w, more_w));
        let least = simd.max(simd.max(at_least(u, more_u), at_least(v, more_v)), at_least(w, more_w));
        let lowest = at_least(simd.min(first, last), more_height);
        let highest = at_most(simd.max(first, last), more_height);
        let is_not_above = |a, room| simd.le(simd.sub(a, room), simd.splat(SMALLEST));
        let is_not_below = |a, room| simd.le(simd.splat(-SMALLEST), simd.add(a, room));
        let is_inside = is_not_below(most, inside) | is_not_above(least, inside);
        let huge = simd.le(simd.splat(if reach > LARGEST { 0.0 } else { LARGEST }), simd.max(far, edge));
        (is_inside & is_not_above(lowest, beside) & is_not_below(highest, beside)) | huge
    }

    /// Triangles that the segment, a line, may cross before a part of it that is at least `until`.
    ///
    /// Signs are those of volumes from the front. Where rounding decides which side that is, the line is so near to
    /// the plane's direction that volumes are within rounding of 0.
    #[inline(always)]
    pub fn may_cross_line<V: Simd8>(&self, simd: V, triangles: &TriangleBlock, until: f32) -> MayCross {
        let Cull { start, along, reach, room, .. } = *self;
        let splat = |v: Vec3| [simd.splat(v.x), simd.splat(v.y), simd.splat(v.z)];
        let [a, b, c] = triangles.corners(simd);
        let (e1, e2, from) = (simd.minus(b, a), simd.minus(c, a), simd.minus(splat(start), a));
        let (p, q) = (simd.cross(splat(along), e2), simd.cross(from, e1));
        let volume = simd.dot(e1, p);
        let front = |other: V::F| simd.flip(other, volume);
        let whole = simd.abs(volume);
        let (u, v) = (front(simd.dot(from, p)), front(simd.dot(splat(along), q)));
        let w = simd.sub(whole, simd.add(u, v));
        let first = front(simd.dot(e2, q));
        let last = simd.mul_sub(whole, simd.splat(until), first);
        let (edge, far) = (simd.max(simd.largest(e1), simd.largest(e2)), simd.largest(from));
        let rounding = simd.mul_add(simd.splat(ROUNDING), simd.add(far, edge), simd.splat(room));
        let beside = simd.mul(simd.mul(rounding, edge), edge);
        let inside = simd.mul(simd.mul(rounding, edge), simd.splat(reach));
        let least = simd.min(simd.min(u, v), w);
        let (most_first, least_whole) = (simd.add(first, beside), simd.sub(whole, beside));
        let is_near = simd.min(simd.min(simd.add(least, inside), most_first), simd.add(last, beside));
        let is_within = simd.min(simd.sub(least, inside), simd.sub(first, beside));
        let is_crossed = simd.min(is_within, simd.sub(least_whole, most_first));
        let huge = simd.le(simd.splat(if reach > LARGEST { 0.0 } else { LARGEST }), simd.max(far, edge));
        let before = simd.mul(simd.div(most_first, least_whole), simd.splat(1.0 + 4.0 * f32::EPSILON));
        MayCross {
            may: simd.le(simd.splat(-SMALLEST), is_near) | huge,
            surely: simd.le(simd.splat(SMALLEST), is_crossed) & !huge,
            before: simd.store(before),
        }
    }
}

/// Lanes of a block that a line may cross, a bit each.
#[derive(Clone, Copy, Debug)]
pub struct MayCross {
    /// Those that it may cross.
    pub may: u32,
    /// Those of them that it surely does, if it may cross them,
    pub surely: u32,
    /// before this part of it.
    pub before: [f32; LANES],
}

impl MayCross {
    /// All but a lane.
    #[inline(always)]
    pub fn without(self, lane: Option<usize>) -> Self {
        Self { may: self.may & !lane.map_or(0, |lane| 1 << lane), ..self }
    }
}

/// Largest component by size.
#[inline(always)]
pub(super) fn largest(v: Vec3) -> f32 {
    max(max(v.x.abs(), v.y.abs()), v.z.abs())
}

/// As the instruction does it, without a thought of NaN.
#[inline(always)]
pub(super) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// As the instruction does it, without a thought of NaN.
#[inline(always)]
pub(super) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::{Line, Segment, Triangle, triangle};
    use super::*;
    use crate::geodesic::Arc;
    use crate::math::columns::Row;
    use crate::math::simd8::{LaneByLane, Simd8Work, with_simd8};

    fn random() -> impl FnMut() -> f64 {
        let mut state = 11u64;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            2.0 * ((state >> 11) as f64 / (1u64 << 53) as f64) - 1.0
        }
    }

    /// Triangles of many sizes near a point of a segment of size `scale`, the first lane empty, by random points of a size.
    fn around(
        segment: &impl Segment,
        s: f64,
        scale: f64,
        mut point: impl FnMut(f64) -> DVec3,
    ) -> TriangleBlock {
        let mut block = TriangleBlock::default();
        Triangle::set(&mut block, 0, Triangle::NOWHERE);
        for lane in 1..LANES {
            let size = scale * 10f64.powi(-(lane as i32) / 2);
            let near = segment.point(s) + point(0.5 * size);
            let [a, b, c] = [0; 3].map(|_| (near + point(size)).as_vec3());
            Triangle::set(&mut block, lane, Triangle { a, b, c });
        }
        block
    }

    /// Counts what is crossed, screened and passed by of `count` triangles of many sizes around segments of size
    /// `scale`.
    fn screened<S: Segment>(
        scale: f64,
        segment: impl Fn([DVec3; 3], f64) -> S,
        may_cross: impl Fn(&S, &TriangleBlock) -> u32,
        crosses: impl Fn(&S, &Triangle) -> f64,
    ) -> [usize; 3] {
        let mut random = random();
        let mut counts = [0; 3];
        for i in 0..20_000 {
            let mut point = |size: f64| size * DVec3::new(random(), random(), random());
            let [p0, p1, p2] = [point(scale), point(scale), point(scale)];
            let segment = segment([p0, p1, p2], f64::from(i % 7) * 0.1);
            let block = around(&segment, f64::from(i) / 20_000.0, scale, point);
            let may = may_cross(&segment, &block);
            for lane in 0..LANES {
                let is_kept = may >> lane & 1 == 1;
                let is_crossed = crosses(&segment, &Triangle::get(&block, lane)) < f64::INFINITY;
                assert!(is_kept || !is_crossed, "{:?} at scale {scale}", Triangle::get(&block, lane));
                assert!(lane > 0 || !is_kept);
                counts[if is_crossed {
                    0
                } else if is_kept {
                    1
                } else {
                    2
                }] += 1;
            }
        }
        counts
    }

    #[test]
    fn what_is_crossed_is_never_screened_out_and_little_else_is_kept() {
        for scale in [1e-18, 1e-6, 1.0, 1e6, 1e14, 1e20] {
            let lines = screened(
                scale,
                |[p0, _, p2], _| Line { p0, p2 },
                |line, block| with_simd8(Screening(line, block, 1.0)).may,
                |line, triangle| triangle::cross_line(line, triangle, false),
            );
            let arcs = screened(
                scale,
                |[p0, p1, p2], bend| {
                    let across = bend * (p1 - p0).reject_from(p2 - p0);
                    Arc { p0, p1: p0.lerp(p2, 0.3) + across, p2, w: 0.9 }
                },
                |arc, block| with_simd8(ArcScreening(arc, block)),
                |arc, triangle| triangle::cross_arc(arc, triangle, false),
            );
            let is_usual = (1e-6..1e7).contains(&scale);
            for ([crossed, kept, out], most_kept) in [(lines, 0.2), (arcs, 4.0)] {
                assert!(crossed > 1000, "{crossed} crossed at scale {scale}");
                let is_small = (kept as f64) < most_kept * crossed as f64;
                assert!(!is_usual || is_small, "{crossed} crossed, {kept} kept, {out} out at scale {scale}");
            }
        }
    }

    /// Screens a block for a line as far as a part of it.
    struct Screening<'a>(&'a Line, &'a TriangleBlock, f32);

    impl Simd8Work for Screening<'_> {
        type Output = MayCross;

        fn run<V: Simd8>(self, simd: V) -> MayCross {
            let Self(line, block, until) = self;
            Cull::new(&line.chord()).may_cross_line(simd, block, until)
        }
    }

    /// Screens a block for an arc.
    struct ArcScreening<'a>(&'a Arc, &'a TriangleBlock);

    impl Simd8Work for ArcScreening<'_> {
        type Output = u32;

        fn run<V: Simd8>(self, simd: V) -> u32 {
            Cull::new(&self.0.chord()).may_cross(simd, self.1, 1.0)
        }
    }

    #[test]
    fn what_a_line_surely_crosses_is_crossed_before_the_part_told_and_no_crossing_is_screened_out() {
        for scale in [1e-18, 1e-12, 1e-6, 1.0, 1e6, 1e14, 1e20] {
            let mut random = random();
            let [mut crossed, mut kept, mut sure] = [0; 3];
            for i in 0..20_000 {
                let mut point = |size: f64| size * DVec3::new(random(), random(), random());
                let line = Line { p0: point(scale), p2: point(scale) };
                let block = around(&line, f64::from(i) / 20_000.0, scale, point);
                let until = (i % 5) as f32 / 4.0;
                let screening = || Screening(&line, &block, until);
                for met in [with_simd8(screening()), screening().run(LaneByLane)] {
                    assert_eq!(met.may & 1, 0, "no triangle is there");
                    for lane in 1..LANES {
                        let triangle = Triangle::get(&block, lane);
                        let s = triangle::cross_line(&line, &triangle, false);
                        let (may, surely) = (met.may >> lane & 1 == 1, met.surely >> lane & 1 == 1);
                        assert!(may || s > until.into(), "{triangle:?} at scale {scale}");
                        assert!(!(may && surely) || s <= met.before[lane].into(), "{triangle:?} at {scale}");
                        crossed += u32::from(s <= until.into());
                        kept += u32::from(may);
                        sure += u32::from(may && surely);
                    }
                }
            }
            let is_usual = (1e-6..1e7).contains(&scale);
            assert!(!is_usual || kept < crossed + crossed / 5, "{kept} kept of {crossed} at scale {scale}");
            assert!(!is_usual || sure > crossed - crossed / 20, "{sure} sure of {crossed} at scale {scale}");
        }
    }
}
