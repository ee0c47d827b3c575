//! Conservative test for the triangles of a block that a segment may cross, in f32, lane beside lane: few are left to
//! be tested exactly.
//!
//! A segment, which turns by less than half a circle, is its chord, moved by a part of its bow. So where it crosses a
//! triangle some of these lines pass inside the triangle's edges, and they do not all stay on one side of its plane.
//! Signed volumes tell (Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection"): they change in
//! proportion with the part of the bow, and their rounding widens the triangle by some ulps of the coordinates.

use glam::Vec3;

use super::Chord;
use super::triangle::{Triangle, TriangleBlock};
use crate::math::columns::{LANES, Row};

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
    /// Part of the chord that matters.
    until: f32,
}

/// Rounding of a volume beside the product of the largest components of its factors: a dozen roundings of half an
/// epsilon of six products; thrice that.
pub(super) const ROUNDING: f32 = 64.0 * f32::EPSILON;
/// Beyond this the product of three lengths leaves the range of f32.
pub(super) const LARGEST: f32 = 1e12;

impl Cull {
    /// Room for a chord.
    #[inline(always)]
    pub fn new(chord: &Chord) -> Self {
        let (start, along) = (chord.start.as_vec3(), (chord.end - chord.start).as_vec3());
        let (bow, reach) = (chord.bow.as_vec3(), largest(along));
        let room = ROUNDING * (largest(start) + reach + largest(bow));
        Self { start, along, bow, sweep: bow.cross(along), reach, room, until: 1.0 }
    }

    /// Ends the search at this part of the chord.
    #[inline(always)]
    pub fn end_at(&mut self, part: f64) {
        self.until = self.until.min(part as f32 * (1.0 + 4.0 * f32::EPSILON));
    }

    /// One byte a lane: 1 if the segment may cross the triangle of that lane, 0 if it does not. The bow is 0 unless it
    /// `BENDS`.
    #[inline(always)]
    pub fn may_cross<const BENDS: bool>(&self, triangles: &TriangleBlock) -> u64 {
        let Cull { start, along, bow, sweep, reach, room, until } = *self;
        let mut may = [0u8; LANES];
        for (lane, may) in may.iter_mut().enumerate() {
            let Triangle { a, b, c } = Triangle::get(triangles, lane);
            let (e1, e2, from) = (b - a, c - a, start - a);
            let (p, q) = (along.cross(e2), from.cross(e1));
            let (whole, u, v) = (e1.dot(p), from.dot(p), along.dot(q));
            let w = whole - u - v;
            let (first, last) = (e2.dot(q), e2.dot(q) - until * whole);
            // How much the whole bow adds to them.
            let (mut more_u, mut more_v, mut more_height) = (0.0, 0.0, 0.0);
            if BENDS {
                (more_u, more_v) = (sweep.dot(e2), -sweep.dot(e1));
                more_height = e2.dot(bow.cross(e1));
            }
            let more_w = -(more_u + more_v);
            // `from` is a difference of places that are rounded themselves.
            let edge = max(largest(e1), largest(e2));
            let room = edge * (room + ROUNDING * largest(from));
            // Not a number, where there is no triangle.
            let is_there = a.x.is_finite();
            let is_huge = max(largest(from), max(edge, reach)) > LARGEST;
            let inside = room * reach;
            let most = min(min(u + max(more_u, 0.0), v + max(more_v, 0.0)), w + max(more_w, 0.0));
            let least = max(max(u + min(more_u, 0.0), v + min(more_v, 0.0)), w + min(more_w, 0.0));
            let beside = room * edge;
            let lowest = min(first, last) + min(more_height, 0.0);
            let highest = max(first, last) + max(more_height, 0.0);
            let is_inside = (most >= -inside) | (least <= inside);
            let is_met = is_inside & (lowest <= beside) & (highest >= -beside);
            *may = u8::from(is_there & (is_met | is_huge));
        }
        u64::from_le_bytes(may)
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

    use super::super::{Line, Segment, triangle};
    use super::*;
    use crate::geodesic::Arc;

    fn random() -> impl FnMut() -> f64 {
        let mut state = 11u64;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            2.0 * ((state >> 11) as f64 / (1u64 << 53) as f64) - 1.0
        }
    }

    /// Counts what is crossed, screened and passed by of `count` triangles of many sizes around segments of size
    /// `scale`.
    fn screened<S: Segment, const BENDS: bool>(
        scale: f64,
        segment: impl Fn([DVec3; 3], f64) -> S,
        crosses: impl Fn(&S, &Triangle) -> f64,
    ) -> [usize; 3] {
        let mut random = random();
        let mut counts = [0; 3];
        for i in 0..20_000 {
            let mut point = |size: f64| size * DVec3::new(random(), random(), random());
            let [p0, p1, p2] = [point(scale), point(scale), point(scale)];
            let segment = segment([p0, p1, p2], f64::from(i % 7) * 0.1);
            let mut block = TriangleBlock::default();
            // One lane stays empty.
            Triangle::set(&mut block, 0, Triangle::NOWHERE);
            for lane in 1..LANES {
                let size = scale * 10f64.powi(-(lane as i32) / 2);
                let near = segment.point(f64::from(i) / 20_000.0) + point(0.5 * size);
                let [a, b, c] = [0; 3].map(|_| (near + point(size)).as_vec3());
                Triangle::set(&mut block, lane, Triangle { a, b, c });
            }
            let may = Cull::new(&segment.chord()).may_cross::<BENDS>(&block);
            for lane in 0..LANES {
                let is_kept = may >> (8 * lane) & 1 == 1;
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
            let lines = screened::<_, false>(
                scale,
                |[p0, _, p2], _| Line { p0, p2 },
                |line, triangle| triangle::cross_line(line, triangle, false),
            );
            let arcs = screened::<_, true>(
                scale,
                |[p0, p1, p2], bend| {
                    let across = bend * (p1 - p0).reject_from(p2 - p0);
                    Arc { p0, p1: p0.lerp(p2, 0.3) + across, p2, w: 0.9 }
                },
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
}
