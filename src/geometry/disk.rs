//! Annulus against line and arc.

use glam::DVec3;

use super::line::Line;
use super::primitives::Disk;
use super::triangle::cross_plane;
use crate::geodesic::Arc;
use crate::math::bernstein::positive;

impl Disk {
    #[inline(always)]
    fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p - self.center)
    }

    /// True if a point of the disk's plane lies between its radii.
    #[inline(always)]
    pub(super) fn holds(&self, p: DVec3) -> bool {
        let radius2 = (p - self.center).length_squared();
        (radius2 >= self.inner * self.inner) & (radius2 <= self.outer * self.outer)
    }
}

/// First crossing of `disk` by `line`; infinite if there is none.
#[inline(always)]
pub fn cross_line(line: &Line, disk: &Disk, starts_on: bool) -> f64 {
    let (start, end) = (disk.height(line.p0), disk.height(line.p2));
    let crosses = !starts_on & (positive(start) != positive(end));
    let s = start / (start - end);
    if crosses & disk.holds(line.p0 + s * (line.p2 - line.p0)) { s } else { f64::INFINITY }
}

/// First crossing of `disk` by `arc`; infinite if there is none.
#[inline(always)]
pub fn cross_arc(arc: &Arc, disk: &Disk, starts_on: bool) -> f64 {
    let start = if starts_on { 0.0 } else { disk.height(arc.p0) };
    let roots = cross_plane(start, arc.w * disk.height(arc.p1), disk.height(arc.p2), starts_on);
    let is_on = |&s: &f64| s < f64::INFINITY && disk.holds(arc.point(s));
    roots.into_iter().find(is_on).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_hits_between_the_radii_only() {
        let disk = Disk { center: DVec3::ZERO, normal: DVec3::Y, inner: 1.0, outer: 2.0 };
        let through = |x: f64| {
            cross_line(&Line { p0: DVec3::new(x, 1.0, 0.0), p2: DVec3::new(x, -1.0, 0.0) }, &disk, false)
        };
        assert_eq!((through(0.5), through(1.5), through(2.5)), (f64::INFINITY, 0.5, f64::INFINITY));
    }
}
