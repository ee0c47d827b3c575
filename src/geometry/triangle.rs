//! Triangle against line and arc.

use glam::DVec3;

use super::Line;
use crate::geodesic::Arc;
use crate::math::bernstein::positive;

/// A triangle by its corners, as stored; computed with in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Corners, counter-clockwise seen from the front.
    pub corners: [[f32; 3]; 3],
}

/// A triangle's corner, edges from it, and their cross product.
struct Frame {
    corner: DVec3,
    e1: DVec3,
    e2: DVec3,
    normal: DVec3,
}

impl Triangle {
    /// Corner `i`.
    #[inline(always)]
    pub fn corner(&self, i: usize) -> DVec3 {
        let [x, y, z] = self.corners[i];
        DVec3::new(x.into(), y.into(), z.into())
    }

    /// Smallest box around the triangle.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let [a, b, c] = [self.corner(0), self.corner(1), self.corner(2)];
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Whether a point of the triangle's plane lies in it, edges included.
    pub fn holds(&self, point: DVec3) -> bool {
        self.frame().holds(point)
    }

    /// Normal by the right-hand rule, length twice the area.
    pub fn normal(&self) -> DVec3 {
        self.frame().normal
    }

    /// Barycentric coordinates (of corners 1 and 2) of the point of the plane nearest to `point`.
    pub fn barycentrics(&self, point: DVec3) -> (f64, f64) {
        let Frame { corner, e1, e2, normal } = self.frame();
        let to = point - corner;
        let area2 = normal.length_squared();
        (to.cross(e2).dot(normal) / area2, e1.cross(to).dot(normal) / area2)
    }

    #[inline(always)]
    fn frame(&self) -> Frame {
        let corner = self.corner(0);
        let (e1, e2) = (self.corner(1) - corner, self.corner(2) - corner);
        Frame { corner, e1, e2, normal: e1.cross(e2) }
    }
}

impl Frame {
    /// Whether the point `p` of the plane lies in the triangle, edges included.
    ///
    /// Edges are widened by the rounding of `p` and of the products, so that no ray slips between two triangles.
    #[inline(always)]
    fn holds(&self, p: DVec3) -> bool {
        let to = p - self.corner;
        let u = to.cross(self.e2).dot(self.normal);
        let v = self.e1.cross(to).dot(self.normal);
        let area2 = self.normal.length_squared();
        let extent = self.e1.abs().max(self.e2.abs()).max_element();
        let reach = p.abs().max(self.corner.abs()).max_element();
        let slack = 2e-15 * reach * extent * area2.sqrt();
        u >= -slack && v >= -slack && u + v <= area2 + slack
    }
}

/// First crossing of `triangle` by `line`; infinite if there is none.
#[inline(always)]
pub fn cross_line(line: &Line, triangle: &Triangle, leaves: bool) -> f64 {
    let frame = triangle.frame();
    let start = frame.normal.dot(line.p0 - frame.corner);
    let end = frame.normal.dot(line.p2 - frame.corner);
    let crosses = !leaves & (positive(start) != positive(end));
    let s = start / (start - end);
    if crosses && frame.holds(line.p0 + s * (line.p2 - line.p0)) { s } else { f64::INFINITY }
}

/// First crossing of `triangle` by `arc`; infinite if there is none.
#[inline(always)]
pub fn cross_arc(arc: &Arc, triangle: &Triangle, leaves: bool) -> f64 {
    let frame = triangle.frame();
    let height = |p: DVec3| frame.normal.dot(p - frame.corner);
    let start = if leaves { 0.0 } else { height(arc.p0) };
    let accepts = |s: f64| frame.holds(arc.point(s));
    cross_plane(start, arc.w * height(arc.p1), height(arc.p2), leaves, accepts)
}

/// First sign change of the quadratic with Bernstein coefficients `start`, `middle`, `end` that is `accepted`; infinite
/// if there is none.
///
/// `leaves`: the root at 0 (where `start` vanishes) does not count.
#[inline(always)]
pub fn cross_plane(start: f64, middle: f64, end: f64, leaves: bool, accepted: impl Fn(f64) -> bool) -> f64 {
    if leaves {
        // Divided by s: (1−s) 2 middle + s end.
        let crosses = positive(middle) != positive(end);
        let s = 2.0 * middle / (2.0 * middle - end);
        return if crosses && accepted(s) { s } else { f64::INFINITY };
    }
    let crosses = positive(start) != positive(end);
    if !crosses && positive(start) == positive(middle) {
        return f64::INFINITY;
    }
    // With τ = s/(1−s): end τ² + 2 middle τ + start = 0; s = numerator/(numerator + denominator) never overflows.
    let discriminant = middle * middle - start * end;
    if !crosses && discriminant <= 0.0 {
        return f64::INFINITY;
    }
    let q = -(middle + discriminant.max(0.0).sqrt().copysign(middle));
    let (one, other) = (q / (q + end), start / (start + q));
    if crosses {
        // Roots of opposite sign in τ: the positive one is in the interval.
        let s = if positive(q) == positive(end) { one } else { other };
        let s = if s.is_nan() { 1.0 } else { s.clamp(0.0, 1.0) };
        return if accepted(s) { s } else { f64::INFINITY };
    }
    let (first, second) = if one <= other { (one, other) } else { (other, one) };
    let inside = |s: &f64| (0.0..=1.0).contains(s) && accepted(*s);
    [first, second].into_iter().find(inside).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Triangle = Triangle { corners: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };

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
