//! Triangle against line and arc.

use glam::{DVec3, Vec3};

use super::line::Line;
use crate::geodesic::Arc;
use crate::math::bernstein::positive;
use crate::math::columns::{LANES, columns};
use crate::math::simd8::Simd8;

columns! {
    /// A triangle by its corners, counter-clockwise seen from the front. Stored in f32, computed with in f64.
    #[derive(PartialEq)]
    pub struct Triangle => TriangleBlock {
        /// Corner 0.
        a: Vec3,
        /// Corner 1.
        b: Vec3,
        /// Corner 2.
        c: Vec3,
    }
}

impl TriangleBlock {
    /// Corners, by component.
    #[inline(always)]
    pub fn corners<V: Simd8>(&self, simd: V) -> [[V::F; 3]; 3] {
        let load = |[x, y, z]: &[[f32; LANES]; 3]| [simd.load(x), simd.load(y), simd.load(z)];
        [load(&self.a), load(&self.b), load(&self.c)]
    }
}

/// A triangle's corner, edges from it, and their cross product.
struct TriangleEdges {
    corner: DVec3,
    e1: DVec3,
    e2: DVec3,
    normal: DVec3,
}

impl Triangle {
    /// One that is met by nothing, for lanes to spare.
    pub const NOWHERE: Triangle = Triangle { a: Vec3::NAN, b: Vec3::NAN, c: Vec3::NAN };

    /// Corners in f64.
    #[inline(always)]
    pub fn corners(&self) -> [DVec3; 3] {
        [self.a.as_dvec3(), self.b.as_dvec3(), self.c.as_dvec3()]
    }

    /// Smallest box around the triangle.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let [a, b, c] = self.corners();
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// True if a point of the triangle's plane lies in it, edges included.
    pub fn holds(&self, point: DVec3) -> bool {
        self.frame().holds(point)
    }

    /// Normal by the right-hand rule, length twice the area.
    pub fn normal(&self) -> DVec3 {
        self.frame().normal
    }

    /// Barycentric coordinates (of corners 1 and 2) of the point of the plane nearest to `point`.
    pub fn barycentrics(&self, point: DVec3) -> (f64, f64) {
        let TriangleEdges { corner, e1, e2, normal } = self.frame();
        let to = point - corner;
        let area2 = normal.length_squared();
        (to.cross(e2).dot(normal) / area2, e1.cross(to).dot(normal) / area2)
    }

    #[inline(always)]
    fn frame(&self) -> TriangleEdges {
        let [corner, b, c] = self.corners();
        let (e1, e2) = (b - corner, c - corner);
        TriangleEdges { corner, e1, e2, normal: e1.cross(e2) }
    }
}

impl TriangleEdges {
    /// True if the point `p` of the plane lies in the triangle, edges included.
    ///
    /// Edges are widened by the rounding of `p` and of the products, so that no ray slips between two triangles.
    #[inline(always)]
    fn holds(&self, p: DVec3) -> bool {
        let to = p - self.corner;
        let u = to.cross(self.e2).dot(self.normal);
        let v = self.e1.cross(to).dot(self.normal);
        let area2 = self.normal.length_squared();
        let reach = largest(p).max(largest(self.corner));
        let slack = 4e-15 * reach * largest(self.e1).max(largest(self.e2)) * largest(self.normal);
        (u >= -slack) & (v >= -slack) & (u + v <= area2 + slack)
    }
}

/// First crossing of `triangle` by `line`; infinite if there is none.
///
/// By the signed volumes of Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection": nothing is
/// divided before it is known to be a hit.
#[inline(always)]
pub fn cross_line(line: &Line, triangle: &Triangle, starts_on: bool) -> f64 {
    let [corner, b, c] = triangle.corners();
    let (along, e1, e2, from) = (line.p2 - line.p0, b - corner, c - corner, line.p0 - corner);
    let (p, q) = (along.cross(e2), from.cross(e1));
    let (whole, u, v, start) = (e1.dot(p), from.dot(p), along.dot(q), e2.dot(q));
    let crosses = !starts_on & (positive(start) != positive(start - whole));
    let front = if positive(whole) { 1.0 } else { -1.0 };
    let (u, v, whole_area) = (front * u, front * v, front * whole);
    // Edges are widened by the rounding of the volumes, so that no ray slips between two triangles.
    let reach = largest(from).max(largest(line.p0));
    let slack = 4e-15 * reach * largest(along) * largest(e1).max(largest(e2));
    let inside = (u >= -slack) & (v >= -slack) & (u + v <= whole_area + slack);
    if crosses & inside { start / whole } else { f64::INFINITY }
}

/// Largest component by size.
#[inline(always)]
fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// First crossing of `triangle` by `arc`; infinite if there is none.
#[inline(always)]
pub fn cross_arc(arc: &Arc, triangle: &Triangle, starts_on: bool) -> f64 {
    let frame = triangle.frame();
    let height = |p: DVec3| frame.normal.dot(p - frame.corner);
    let start = if starts_on { 0.0 } else { height(arc.p0) };
    let [first, second] = cross_plane(start, arc.w * height(arc.p1), height(arc.p2), starts_on);
    if first < f64::INFINITY && frame.holds(arc.point(first)) {
        first
    } else if second < f64::INFINITY && frame.holds(arc.point(second)) {
        second
    } else {
        f64::INFINITY
    }
}

/// The places where the quadratic with Bernstein coefficients `start`, `middle`, `end` is 0, in order; infinite for
/// those that there are not.
///
/// `leaves`: the root at 0 (where `start` vanishes) does not count.
#[inline(always)]
pub fn cross_plane(start: f64, middle: f64, end: f64, starts_on: bool) -> [f64; 2] {
    const NONE: f64 = f64::INFINITY;
    if starts_on {
        // Divided by s: (1−s) 2 middle + s end.
        let crosses = positive(middle) != positive(end);
        return [if crosses { 2.0 * middle / (2.0 * middle - end) } else { NONE }, NONE];
    }
    let crosses = positive(start) != positive(end);
    if !crosses && positive(start) == positive(middle) {
        return [NONE; 2];
    }
    // With τ = s/(1−s): end τ² + 2 middle τ + start = 0; s = numerator/(numerator + denominator) never overflows.
    let discriminant = middle * middle - start * end;
    if !crosses && discriminant <= 0.0 {
        return [NONE; 2];
    }
    let q = -(middle + discriminant.max(0.0).sqrt().copysign(middle));
    if crosses {
        // Roots of opposite sign in τ: the positive one is in the interval.
        let s = if positive(q) == positive(end) { q / (q + end) } else { start / (start + q) };
        return [if s.is_nan() { 1.0 } else { s.clamp(0.0, 1.0) }, NONE];
    }
    let [one, other] =
        [q / (q + end), start / (start + q)].map(|s| if (0.0..=1.0).contains(&s) { s } else { NONE });
    [one.min(other), one.max(other)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Triangle = Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y };

    #[test]
    fn a_line_hits_inside_and_on_the_edges_and_misses_outside() {
        let through = |x: f64, y: f64| {
            cross_line(&Line { p0: DVec3::new(x, y, 1.0), p2: DVec3::new(x, y, -3.0) }, &UNIT, false)
        };
        for (x, y) in [(0.25, 0.25), (0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.0, 0.3)] {
            assert_eq!(through(x, y), 0.25, "({x}, {y})");
        }
        for (x, y) in [(-1e-9, 0.5), (0.5, -1e-9), (0.5, 0.5 + 1e-9), (2.0, 2.0)] {
            assert_eq!(through(x, y), f64::INFINITY, "({x}, {y})");
        }
    }

    #[test]
    fn an_arc_that_dips_through_twice_hits_at_its_first_crossing_inside() {
        // A parabola from z = 1 down to −1 and up again, over x from −0.5 to 0.9: only the second crossing is inside.
        let arc = |x0: f64, x1: f64| Arc {
            p0: DVec3::new(x0, 0.1, 1.0),
            p1: DVec3::new(0.5 * (x0 + x1), 0.1, -3.0),
            p2: DVec3::new(x1, 0.1, 1.0),
            w: 1.0,
        };
        let s = cross_arc(&arc(-0.5, 0.9), &UNIT, false);
        let z = arc(-0.5, 0.9).point(s).z;
        assert!(s.is_finite() && s > 0.5 && z.abs() < 1e-15, "s = {s}, z = {z}");
        let s = cross_arc(&arc(0.1, 0.8), &UNIT, false);
        assert!(s < 0.5);
        assert_eq!(cross_arc(&arc(2.0, 3.0), &UNIT, false), f64::INFINITY);
    }

    #[test]
    fn a_ray_that_bends_back_hits_the_triangle_it_left_and_not_its_start() {
        let rise = Arc {
            p0: DVec3::new(0.1, 0.1, 0.0),
            p1: DVec3::new(0.2, 0.2, 0.5),
            p2: DVec3::new(0.3, 0.3, -0.2),
            w: 0.9,
        };
        let s = cross_arc(&rise, &UNIT, true);
        assert!(s.is_finite() && s > 0.1 && rise.point(s).z.abs() < 1e-15);
        let away = Arc { p2: DVec3::new(0.3, 0.3, 1.0), ..rise };
        assert_eq!(cross_arc(&away, &UNIT, true), f64::INFINITY);
    }

    #[test]
    fn a_straight_arc_crosses_where_its_line_does() {
        for i in 0..1000 {
            let a = i as f64 * 0.37;
            let (p0, p2) = (DVec3::new(a.sin(), a.cos(), 0.7), DVec3::new(0.3, (0.5 * a).sin(), -0.4));
            let line = cross_line(&Line { p0, p2 }, &UNIT, false);
            let arc = cross_arc(&Arc { p0, p1: 0.5 * (p0 + p2), p2, w: 1.0 }, &UNIT, false);
            assert_eq!(line.is_finite(), arc.is_finite());
            if line.is_finite() {
                assert!((line - arc).abs() < 1e-14, "{line} {arc}");
            }
        }
    }
}
