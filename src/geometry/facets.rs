//! Triangles of small scenes against lines, side by side: in f32 the one is found that a line may meet first, and only
//! that is tested exactly, unless another may come before.
//!
//! By the signed volumes of Möller and Trumbore, as in [`cull`](super::cull). Divided by the volume of the whole they
//! are barycentric coordinates and the place along the line, known but for their rounding.

use glam::Vec3;

use super::Triangle;
use super::cull::{LARGEST, ROUNDING, largest, max, min};
use super::line::Line;
use crate::math::columns::{LANES, PAIRED, columns};

/// A triangle in f32.
#[derive(Clone, Copy, Debug)]
struct Facet {
    slot: u32,
    corner: Vec3,
    e1: Vec3,
    e2: Vec3,
    normal: Vec3,
    /// Largest component of the edges.
    edge: f32,
    /// Room that the rounding of its place asks for.
    room: f32,
}

/// The triangles of a small scene.
#[derive(Clone, Debug, Default)]
pub struct Facets {
    all: Vec<Facet>,
}

columns! {
    /// A line in f32.
    pub struct NarrowLine => NarrowLineBlock {
        /// Start.
        start: Vec3,
        /// Way to the end.
        along: Vec3,
        /// Largest component of it.
        reach: f32,
        /// Room that the rounding of its place asks for.
        room: f32,
    }
}

/// Candidates for the first crossings of a block of lines.
#[derive(Clone, Copy, Debug)]
pub struct Foremost<const N: usize = LANES> {
    /// Slot of the triangle that comes first, or [`Foremost::NONE`].
    pub slot: [u32; N],
    /// Parameters before which no other triangle is met; infinite if there are none, and if there is none that comes
    /// first of no meaning.
    pub next: [f32; N],
}

impl Foremost {
    /// No triangle.
    pub const NONE: u32 = u32::MAX;
}

impl Facet {
    fn new(slot: u32, triangle: &Triangle) -> Self {
        let Triangle { a, b, c } = *triangle;
        let (e1, e2) = (b - a, c - a);
        let edge = max(largest(e1), largest(e2));
        Self { slot, corner: a, e1, e2, normal: e1.cross(e2), edge, room: room(max(largest(a), edge)) }
    }
}

/// Room that the rounding of coordinates of a size asks for.
#[inline(always)]
fn room(size: f32) -> f32 {
    if size > LARGEST { f32::INFINITY } else { ROUNDING * size }
}

impl NarrowLine {
    #[inline(always)]
    fn new(line: &Line) -> Self {
        let (start, along) = (line.p0.as_vec3(), (line.p2 - line.p0).as_vec3());
        let reach = largest(along);
        Self { start, along, reach, room: room(2.0 * largest(start) + reach) }
    }
}

impl Facets {
    /// Of triangles and their slots.
    pub fn new(triangles: impl Iterator<Item = (u32, Triangle)>) -> Self {
        Self { all: triangles.map(|(slot, triangle)| Facet::new(slot, &triangle)).collect() }
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Slots of all triangles.
    pub fn slots(&self) -> impl Iterator<Item = u32> {
        self.all.iter().map(|facet| facet.slot)
    }

    /// Triangles that lines may meet first, without those that the lines start on: `line` gives them, with the slots of
    /// these, by block and lane.
    #[inline(always)]
    pub fn all_foremost(
        &self,
        blocks: usize,
        line: impl Fn(usize, usize) -> (Line, u32),
        found: &mut Vec<Foremost>,
    ) {
        found.clear();
        // Two blocks at once: one of f32 fills no more than half of the widest vectors.
        for first in (0..blocks).step_by(2) {
            let (mut lines, mut own) = (NarrowLineBlock::default(), [Foremost::NONE; PAIRED]);
            let lanes = LANES * (blocks - first);
            for (lane, own) in own.iter_mut().enumerate().take(lanes) {
                let (line, slot) = line(first + lane / LANES, lane % LANES);
                lines.put(lane, NarrowLine::new(&line));
                *own = slot;
            }
            let Foremost { slot, next } = self.foremost::<PAIRED>(&lines, &own);
            let halves = slot.as_chunks().0.iter().zip(next.as_chunks().0);
            found.extend(halves.map(|(&slot, &next)| Foremost { slot, next }));
        }
    }

    /// Triangles that a block of lines may meet first, without those that the lines start on.
    #[inline(always)]
    fn foremost<const N: usize>(&self, lines: &NarrowLineBlock<N>, own: &[u32; N]) -> Foremost<N> {
        // Lines that are not numbers meet nothing: nothing comes before this.
        let (mut first, mut next) = ([f32::NEG_INFINITY; N], [f32::INFINITY; N]);
        let mut slot = [Foremost::NONE; N];
        for (lane, first) in first.iter_mut().enumerate() {
            *first = if lines.row(lane).reach.is_finite() { f32::INFINITY } else { *first };
        }
        for facet in &self.all {
            let Facet { corner, e1, e2, normal, edge, .. } = *facet;
            for lane in 0..N {
                let NarrowLine { start, along, reach, room } = lines.row(lane);
                let from = start - corner;
                let moment = from.cross(along);
                let inverse = -1.0 / normal.dot(along);
                let (u, v) = (inverse * moment.dot(e2), inverse * -moment.dot(e1));
                let s = inverse * normal.dot(from);
                // Thrice the rounding of the volumes holds if even the sign of the whole is not known.
                let room = 6.0 * (edge * (room + facet.room)) * inverse.abs();
                let outside = min(min(u, v), 1.0 - u - v) + room * reach < 0.0;
                let (least, most) = (s - room * edge, s + room * edge);
                let misses = outside | (most < 0.0) | (least > 1.0) | (own[lane] == facet.slot);
                // What is not a number is not known.
                let least = if least > 0.0 { least } else { 0.0 };
                let least = if misses { f32::INFINITY } else { least };
                next[lane] = min(next[lane], max(first[lane], least));
                slot[lane] = if least < first[lane] { facet.slot } else { slot[lane] };
                first[lane] = min(first[lane], least);
            }
        }
        Foremost { slot, next }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::{Segment, triangle};
    use super::*;

    fn random() -> impl FnMut() -> f64 {
        let mut state = 7u64;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            2.0 * ((state >> 11) as f64 / (1u64 << 53) as f64) - 1.0
        }
    }

    #[test]
    fn no_triangle_is_met_before_the_foremost_and_the_bound_on_all_others() {
        const TRIANGLES: usize = 24;
        for scale in [1e-18, 1e-6, 1.0, 1e6, 1e14, 1e20] {
            let mut random = random();
            let (mut met, mut open) = (0, 0);
            for round in 0..2000 {
                let mut point = |size: f64| size * DVec3::new(random(), random(), random());
                let lines = [0; LANES].map(|_| Line { p0: point(scale), p2: point(scale) });
                let triangles: Vec<Triangle> = (0..TRIANGLES)
                    .map(|number| {
                        let size = scale * 10f64.powi(-(number as i32) / 6);
                        let near = lines[number % LANES].point(0.5) + point(0.5 * size);
                        let [a, b, c] = [0; 3].map(|_| (near + point(size)).as_vec3());
                        Triangle { a, b, c }
                    })
                    .collect();
                let own = [0; LANES].map(|_| round % (2 * TRIANGLES as u32));
                let facets = Facets::new((0..).zip(triangles.iter().copied()));
                let mut found = Vec::new();
                facets.all_foremost(3, |_, lane| (lines[lane], own[lane]), &mut found);
                let Foremost { slot, next } = found[round as usize % 3];
                for lane in 0..LANES {
                    let line = lines[lane];
                    let mut first = f64::INFINITY;
                    for (number, triangle) in (0..).zip(&triangles) {
                        let s = triangle::cross_line(&line, triangle, number == own[lane]);
                        let is_known = number == slot[lane] || s >= f64::from(next[lane]);
                        assert!(is_known, "{line:?} meets {triangle:?} at {s}, before {}", next[lane]);
                        first = first.min(s);
                    }
                    met += usize::from(first < f64::INFINITY);
                    open += usize::from(next[lane] < f32::INFINITY && first >= f64::from(next[lane]));
                }
            }
            assert!(met > 4000, "{met} met at scale {scale}");
            let is_usual = (1e-6..1e7).contains(&scale);
            assert!(!is_usual || open < met / 10, "{open} of {met} open at scale {scale}");
        }
    }

    #[test]
    fn what_is_not_a_number_meets_nothing() {
        let triangle = Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y };
        let facets = Facets::new([(0, triangle)].into_iter());
        let through = Line { p0: DVec3::new(0.2, 0.2, 1.0), p2: DVec3::new(0.2, 0.2, -1.0) };
        let nowhere = Line { p0: DVec3::NAN, p2: DVec3::NAN };
        let line = |lane: usize| if lane == 3 { through } else { nowhere };
        let mut found = Vec::new();
        facets.all_foremost(1, |_, lane| (line(lane), Foremost::NONE), &mut found);
        let Foremost { slot, next } = found[0];
        assert_eq!((slot[3], next[3]), (0, f32::INFINITY));
        for lane in [0, 5] {
            assert_eq!(slot[lane], Foremost::NONE);
        }
    }
}
