//! Segments that a ray is made of when the scene is searched for hits: lines in flat space, arcs in curved.

use glam::{DAffine3, DVec3};

use super::line::Line;
use super::primitives::{Disk, Sphere};
use super::triangle::Triangle;
use super::{disk, sphere, triangle};
use crate::geodesic::Arc;

/// The straight line between a segment's ends, and how far the segment strays from it.
#[derive(Clone, Copy, Debug)]
pub struct Chord {
    /// Start.
    pub start: DVec3,
    /// End.
    pub end: DVec3,
    /// The way from the chord to the segment where they are farthest apart, square to the chord: elsewhere the segment
    /// is a part of that way off.
    pub bow: DVec3,
}

/// A piece of a ray over a parameter s in [0, 1], half-open: a crossing at the shared end of two segments belongs to
/// exactly one of them.
///
/// The intersections give the smallest s at which the segment crosses the shape, infinite if there is none. `starts_on`
/// says that the segment starts on that very shape: the crossing at s = 0 is then divided out exactly, and later ones
/// count.
pub trait Segment: Copy {
    /// True if it may leave its chord, and so come back to a plane that it starts on.
    const BENDS: bool;
    /// Chord and bow.
    fn chord(&self) -> Chord;
    /// Point at `s`.
    fn point(&self, s: f64) -> DVec3;
    /// Unit direction in which it ends.
    fn heading(&self) -> DVec3;
    /// Parameter of the point that lies as far along the chord as `point`, in [0, 1].
    fn parameter_beside(&self, point: DVec3) -> f64;
    /// Part of the chord beside the point at `s`.
    #[inline(always)]
    fn part_beside(&self, s: f64) -> f64 {
        let Chord { start, end, .. } = self.chord();
        let along = end - start;
        (self.point(s) - start).dot(along) / along.length_squared()
    }
    /// The segment, moved.
    fn shifted(&self, by: DVec3) -> Self;
    /// The segment under an affine map; the parameter keeps its meaning.
    fn transformed(&self, map: &DAffine3) -> Self;
    /// First crossing of a sphere.
    fn cross_sphere(&self, sphere: &Sphere, starts_on: bool) -> f64;
    /// First crossing of a triangle.
    fn cross_triangle(&self, triangle: &Triangle, starts_on: bool) -> f64;
    /// First crossing of an annulus.
    fn cross_disk(&self, disk: &Disk, starts_on: bool) -> f64;
}

impl Segment for Line {
    const BENDS: bool = false;

    #[inline(always)]
    fn chord(&self) -> Chord {
        Chord { start: self.p0, end: self.p2, bow: DVec3::ZERO }
    }

    #[inline(always)]
    fn point(&self, s: f64) -> DVec3 {
        self.p0 + s * (self.p2 - self.p0)
    }

    fn heading(&self) -> DVec3 {
        (self.p2 - self.p0).normalize_or_zero()
    }

    #[inline]
    fn parameter_beside(&self, point: DVec3) -> f64 {
        let along = self.p2 - self.p0;
        let s = along.dot(point - self.p0) / along.length_squared();
        if s.is_finite() { s.clamp(0.0, 1.0) } else { 0.0 }
    }

    #[inline(always)]
    fn part_beside(&self, s: f64) -> f64 {
        s
    }

    #[inline(always)]
    fn shifted(&self, by: DVec3) -> Self {
        Line { p0: self.p0 + by, p2: self.p2 + by }
    }

    #[inline]
    fn transformed(&self, map: &DAffine3) -> Self {
        Line { p0: map.transform_point3(self.p0), p2: map.transform_point3(self.p2) }
    }

    #[inline(always)]
    fn cross_sphere(&self, sphere: &Sphere, starts_on: bool) -> f64 {
        sphere::cross_line(self, sphere, starts_on)
    }

    #[inline(always)]
    fn cross_triangle(&self, triangle: &Triangle, starts_on: bool) -> f64 {
        triangle::cross_line(self, triangle, starts_on)
    }

    #[inline(always)]
    fn cross_disk(&self, disk: &Disk, starts_on: bool) -> f64 {
        disk::cross_line(self, disk, starts_on)
    }
}

impl Segment for Arc {
    const BENDS: bool = true;

    #[inline(always)]
    fn chord(&self) -> Chord {
        Chord { start: self.p0, end: self.p2, bow: self.bow() }
    }

    #[inline(always)]
    fn point(&self, s: f64) -> DVec3 {
        Arc::point(self, s)
    }

    fn heading(&self) -> DVec3 {
        (self.p2 - self.p1).normalize_or_zero()
    }

    #[inline]
    fn parameter_beside(&self, point: DVec3) -> f64 {
        Arc::parameter_beside(self, point)
    }

    #[inline(always)]
    fn shifted(&self, by: DVec3) -> Self {
        Arc { p0: self.p0 + by, p1: self.p1 + by, p2: self.p2 + by, w: self.w }
    }

    #[inline]
    fn transformed(&self, map: &DAffine3) -> Self {
        Arc {
            p0: map.transform_point3(self.p0),
            p1: map.transform_point3(self.p1),
            p2: map.transform_point3(self.p2),
            w: self.w,
        }
    }

    #[inline(always)]
    fn cross_sphere(&self, sphere: &Sphere, starts_on: bool) -> f64 {
        sphere::cross_arc(self, sphere, starts_on)
    }

    #[inline(always)]
    fn cross_triangle(&self, triangle: &Triangle, starts_on: bool) -> f64 {
        triangle::cross_arc(self, triangle, starts_on)
    }

    #[inline(always)]
    fn cross_disk(&self, disk: &Disk, starts_on: bool) -> f64 {
        disk::cross_arc(self, disk, starts_on)
    }
}
