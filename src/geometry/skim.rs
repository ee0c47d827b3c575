//! Short ways along surfaces.

use glam::{DAffine3, DVec3};

use super::line::LineBlock;
use super::primitives::{Disk, Sphere};
use super::small_scene::{Crossings, Culled};
use super::triangle::Triangle;
use super::{Chord, Geometry, Line, Segment, SideBySide};
use crate::math::columns::{LANES, Row};

/// A line between two points of a surface: it starts on that and never meets it.
///
/// Rounding would decide where a line that stays within rounding of a sphere crosses it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Skim(pub Line);

impl Row for Skim {
    type Block = <Line as Row>::Block;

    #[inline(always)]
    fn get(block: &Self::Block, lane: usize) -> Self {
        Self(Line::get(block, lane))
    }

    #[inline(always)]
    fn set(block: &mut Self::Block, lane: usize, Self(line): Self) {
        Line::set(block, lane, line);
    }
}

impl Segment for Skim {
    const BENDS: bool = Line::BENDS;

    #[inline(always)]
    fn chord(&self) -> Chord {
        self.0.chord()
    }

    #[inline(always)]
    fn point(&self, s: f64) -> DVec3 {
        self.0.point(s)
    }

    fn heading(&self) -> DVec3 {
        self.0.heading()
    }

    #[inline]
    fn parameter_beside(&self, point: DVec3) -> f64 {
        self.0.parameter_beside(point)
    }

    #[inline(always)]
    fn part_beside(&self, s: f64) -> f64 {
        self.0.part_beside(s)
    }

    #[inline(always)]
    fn shifted(&self, by: DVec3) -> Self {
        Self(self.0.shifted(by))
    }

    #[inline]
    fn transformed(&self, map: &DAffine3) -> Self {
        Self(self.0.transformed(map))
    }

    #[inline(always)]
    fn cross_sphere(&self, sphere: &Sphere, starts_on: bool) -> f64 {
        if starts_on { f64::INFINITY } else { self.0.cross_sphere(sphere, false) }
    }

    #[inline(always)]
    fn cross_triangle(&self, triangle: &Triangle, starts_on: bool) -> f64 {
        self.0.cross_triangle(triangle, starts_on)
    }

    #[inline(always)]
    fn cross_disk(&self, disk: &Disk, starts_on: bool) -> f64 {
        self.0.cross_disk(disk, starts_on)
    }
}

/// Rounding of the power of a point, relative to the squares that it is the difference of.
const ROUNDING: f64 = 1e-14;

impl SideBySide for Skim {
    const FEW: usize = Line::FEW;
    // A short way passes most boxes by.
    const TRIANGLES: usize = 1;
    type Prepared = Skim;

    #[inline(always)]
    fn prepared(&self) -> Skim {
        *self
    }

    #[inline(always)]
    fn consider_sphere(
        geometry: &Geometry,
        (skims, own): (&<Line as Row>::Block, &[u64; LANES]),
        (sphere, slot): (Sphere, u32),
        first: &mut Crossings,
        _: &mut Culled,
    ) {
        // Most start farther from the sphere than they reach: no roots for blocks of those.
        let (radius, radius2) = (sphere.radius, sphere.radius * sphere.radius);
        let mut may = [false; LANES];
        for lane in 0..LANES {
            let Line { p0, p2 } = Line::get(skims, lane);
            let (way, from2) = ((p2 - p0).abs(), (p0 - sphere.center).length_squared());
            let reach = 1.01 * (way.x + way.y + way.z);
            // From the start to the sphere it is ||from| − r|; (|from| − r)(|from| + r) is the power of the start.
            let farthest = reach * (2.0 * radius + reach) + ROUNDING * (from2 + radius2);
            may[lane] = ((from2 - radius2).abs() <= farthest) & (own[lane] != u64::from(slot));
        }
        if may != [false; LANES] {
            let mut s = [f64::INFINITY; LANES];
            for lane in 0..LANES {
                s[lane] = Skim::get(skims, lane).cross_sphere(&sphere, own[lane] == u64::from(slot));
            }
            first.consider_all(geometry, slot, &s);
        }
    }

    #[inline(always)]
    fn lines(skims: &LineBlock) -> Option<&LineBlock> {
        Some(skims)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Need, PrimitiveId, Primitives, Query, Search, Surface};

    #[test]
    fn a_skim_meets_what_stands_on_its_surface_but_not_the_surface() {
        let surface = Surface { material: 0, entity: 0 };
        let sphere = |y: f64, radius: f64| (Sphere { center: DVec3::new(0.0, y, 0.0), radius }, surface);
        let spheres = vec![sphere(-1e5, 1e5), sphere(0.9, 1.0)];
        let geometry = Geometry::build(Primitives { spheres, ..Primitives::default() });
        let below = |x: f64| {
            let line = Line { p0: DVec3::new(x, 5.0, 0.0), p2: DVec3::new(x, -1.0, 0.0) };
            geometry.intersect(&line, PrimitiveId::NONE).map(|hit| hit.primitive)
        };
        let (Some(ball), Some(floor)) = (below(0.0), below(3.0)) else { panic!("nothing below") };
        let on_floor = |x: f64| DVec3::new(x, (1e10 - x * x).sqrt() - 1e5, 0.0);
        // The ball leaves the floor at x = ±0.436.
        let ways = [
            ((2.0, 1.0), None),
            ((0.5, 0.4), Some(ball)),
            ((-0.5, -0.2), Some(ball)),
            ((0.437, 0.436), None),
            ((0.437, 0.435), Some(ball)),
            ((30.0, 30.001), None),
        ];
        let query = |i: usize| {
            let (from, to) = ways[i].0;
            let segment = Skim(Line { p0: on_floor(from), p2: on_floor(to) });
            Query { segment, origin_prim: floor, need: Need::Whole }
        };
        let mut search = Search::default();
        search.queries.gather(ways.len(), query);
        geometry.search_all(&mut search, ways.len());
        for (i, (way, met)) in ways.into_iter().enumerate() {
            assert_eq!(search.found.get(i).map(|found| found.primitive), met, "{way:?}");
            let alone = geometry.intersect(&query(i).segment, floor);
            assert_eq!(alone.map(|hit| hit.primitive), met, "{way:?}");
        }
    }
}
